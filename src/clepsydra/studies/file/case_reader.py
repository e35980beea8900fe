"""Other operating points and variants at which the controllers of a study file are tried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from clepsydra.base.errors import Finding, InputError
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.equilibrium import NoEquilibrium
from clepsydra.linear.equilibrium_request import Asked
from clepsydra.loop.same_steps import same_steps
from clepsydra.loop.scenario import Scenario
from clepsydra.process import told
from clepsydra.process.declared import choice, keys_of, part, read_fields
from clepsydra.process.drawn import drawn
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.case_checks import (
    check_case_name,
    check_held,
    check_same_loops,
    errors_in_case,
)
from clepsydra.studies.file.controller_reader import read_controllers
from clepsydra.studies.file.request import CaseRequest, Settings, StudyRequest
from clepsydra.studies.file.scenario_reader import read_scenario

_SAYS = 'write as in operating_point = { level = "20 %" }'


def _operating_point(table: TableReader, key: str, known: Mapping[str, Any]) -> TableReader | None:
    expected = "a table of measurements, inputs or disturbances with their values"
    return table.table(key, expected, _SAYS) if table.has(key) else None


def _variant(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...] | None:
    if not table.has(key):
        return None
    expected, remedy = "the name of a variant, or a list of names", 'write as in variant = "winter"'
    if isinstance(table.raw(key), str):
        return (table.text(key, expected, remedy),)
    return table.names(key, expected, remedy)


@dataclass(frozen=True)
class CaseTable:
    """What a study file says of a case."""

    operating_point: TableReader | None = part(
        _operating_point,
        **told.by_name(
            "table of what fixes its operating point: measurements, inputs or disturbances with "
            "their values there"
        ),
    )
    variant: tuple[str, ...] | None = part(
        _variant,
        description="a variant of the process file, or a list of several, in the place of those "
        "that `process` names",
        type=["string", "array"],
        items={"type": "string"},
    )
    settings: Settings = choice(
        get_args(Settings),
        words="which settings the controllers have: those of the study, or designed and tuned for "
        "the case",
    )


@dataclass(frozen=True)
class CaseReader:
    """Reads the cases of a study file.

    Parameters
    ----------
    study : StudyRequest
        What the file asks for beside them.
    general : TableReader
        The whole file.
    scenario : TableReader or None
        Its scenario, where it has one.
    folder : Path
        Of the file.
    """

    study: StudyRequest
    general: TableReader
    scenario: TableReader | None
    folder: Path

    def read(self, rows: TableReader) -> tuple[CaseRequest, ...]:
        """Return the cases of a table.

        Raises
        ------
        InputError
            A case is none, its process does not rest as asked, is controlled otherwise, or cannot
            take the steps of the scenario.
        """
        for name in rows.present:
            check_case_name(name, rows.place(name))
        return tuple(self._case(rows, name) for name in rows.present)

    def _case(self, rows: TableReader, name: str) -> CaseRequest:
        table = rows.table(name, "a table", _SAYS, keys_of(CaseTable))
        read = CaseTable(**read_fields(CaseTable, table))
        if read.operating_point is None and read.variant is None:
            raise InputError(
                table.place(), Finding("neither operating_point nor variant"),
                "what differs from the study", _SAYS,
            )  # fmt: skip
        own = self.study
        process = own.process if read.variant is None else self._variant(table, read)
        asked = _asked(process, read.operating_point)
        analysis = self._analysis(table, read, process, asked)
        with errors_in_case(name):
            scenario = self._scenario(analysis)
            controllers = own.controllers
            if read.variant is not None and read.settings == "designed_anew":
                controllers = read_controllers(self.general, process, self.folder)
        check_held(analysis, scenario, table.place())
        study = replace(
            own, process=process, analysis=analysis, scenario=scenario, controllers=controllers
        )
        return CaseRequest(name, read.settings, study, asked)

    def _variant(self, table: TableReader, read: CaseTable) -> Process:
        """Return another variant of the process, which is controlled as that of the study."""
        own = self.study.process
        try:
            process = drawn(load_process(own.path or own.name, read.variant), own.drawn)
        except InputError as error:
            place = table.place("variant")
            place += "" if error.place == "variant" else f", {error.place}"
            raise InputError(place, error.value, error.expected, error.remedy) from None
        check_same_loops(own, process, read.settings, table.place("variant"))
        return process

    def _analysis(
        self,
        table: TableReader,
        read: CaseTable,
        process: Process,
        asked: Asked,
    ) -> Analysis:
        at = "variant" if read.operating_point is None else "operating_point"
        try:
            return analyse(process, **asked)
        except NoEquilibrium as error:
            expected = f"a case in which {process.name} rests: {'; '.join(error.reasons)}"
            raise table.wrong(at, expected, "ask for other values") from None
        except InputError as error:
            raise InputError(table.place(at), error.value, error.expected, error.remedy) from None

    def _scenario(self, analysis: Analysis) -> Scenario:
        own = self.study
        if self.scenario is not None:
            return read_scenario(self.scenario, analysis, own.seed, self.folder)
        return same_steps(own.scenario, own.analysis.operating_point, analysis.operating_point)


def _asked(process: Process, table: TableReader | None) -> dict[str, dict[str, float] | None]:
    """Return inputs, outputs and disturbances that fix an operating point [SI].

    What a process file gives of the outputs holds for those that are not named.
    """
    kinds = {
        "inputs": process.inputs,
        "outputs": process.measurements,
        "disturbances": process.disturbances,
    }
    asked: dict[str, dict[str, float] | None] = dict.fromkeys(kinds)
    if table is None:
        return asked
    signals = {signal.name: signal for group in kinds.values() for signal in group}
    words = f"a measurement, an input or a disturbance of {process.name}"
    for name in table.present:
        known_name(table, name, name, signals, words)
    for kind, group in kinds.items():
        found = {
            signal.name: read_in_range(table, signal.name, signal, "a value", "stay inside it")
            for signal in group
            if table.has(signal.name)
        }
        asked[kind] = found or None
    if asked["outputs"] and asked["inputs"] is None:
        asked["outputs"] = {**process.nominal_outputs, **asked["outputs"]}
    return asked
