"""A study file → `StudyRequest`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.input_file import check_path
from clepsydra.base.standing import Standing, standing_at
from clepsydra.base.suggestion import suggestion
from clepsydra.linear.analysis import analyse
from clepsydra.process import told
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.declared import OWN, choice, keys_of, part, read_fields, table_schema
from clepsydra.process.document import kind_of, parse
from clepsydra.process.drawn import drawn, split_number
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.table_reader import TableReader
from clepsydra.process.variants import split_variants
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.file.case_reader import CaseReader, CaseTable
from clepsydra.studies.file.controller_reader import controller_schema, read_controllers
from clepsydra.studies.file.fields import table_below
from clepsydra.studies.file.kind import study_text
from clepsydra.studies.file.request import ControllerRequest, Designs, StudyRequest
from clepsydra.studies.file.scenario_reader import ScenarioTable, read_scenario

_PATH = "check the path, which starts in the folder of this file"


def process_beside(table: TableReader, key: str, known: Mapping[str, Any]) -> Process:
    """Return a process of the catalogue, or of a file whose path starts in the folder `known`."""
    expected = "a process of the catalogue, or the path of a process file"
    written = table.text(key, expected, 'write as in process = "quadruple-tank"')
    name, variants = split_variants(written)
    names, folder = catalogue_names(), known["folder"]
    if name in names:
        return load_process(name, variants)
    wanted, path = f"{expected} ({', '.join(names)})", folder / name
    if standing_at(path, table.place(key), wanted, _PATH, written[:60]) is not Standing.FILE:
        remedy = suggestion(name, names, check_path(path, _PATH))
        raise table.refused(key, written[:60], wanted, remedy)
    return load_process(path, variants)


def _seed(table: TableReader, key: str, known: Mapping[str, Any]) -> int:
    value = table.raw(key) if table.has(key) else 1
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise table.wrong(key, "a whole number from 0", "write as in seed = 1")
    return value


def _scores(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...]:
    process, remedy = known["process"], 'write as in scores = ["iae", "total_variation"]'
    names = table.names(key, "a list of scores", remedy)
    signals = _signals(process)
    for name in names:
        key_of, signal = score_key(name)
        if key_of not in SCORES:
            raise table.refused(
                key,
                name[:60],
                f"scores of {', '.join(SCORES)}, of all their signals or of one, as in "
                '"iae[level_1]"',
                suggestion(key_of, SCORES, "choose from these"),
            )
        if signal and signal not in signals:
            raise table.refused(
                key,
                name[:60],
                f"the score of a signal of {process.name} ({', '.join(signals)})",
                suggestion(signal, signals, "choose one of them"),
            )
    return names


def _signals(process: Process) -> list[str]:
    """Return everything that a score can be of."""
    found = [*process.controlled, *(signal.name for signal in process.inputs)]
    return list(dict.fromkeys([*found, *(element.name for element in process.elements)]))


@dataclass(frozen=True)
class Ranking:
    """What the controllers of a study are ranked by."""

    scores: tuple[str, ...] = part(
        _scores,
        required=(OWN,),
        **told.names('list of scores, each of all its signals or of one, `"iae[level]"`'),
    )


@dataclass(frozen=True)
class StudyTable:
    """The general keys of a study file."""

    process: Process = part(
        process_beside,
        required=(OWN,),
        **told.text(
            'a process of the catalogue, `"averaging-tank:inflow-constant"` with a variant, or the '
            "path of a process file, from the folder of the study file"
        ),
    )
    title: str = part(
        lambda table, key, known: table.text(
            key, "one line of text", "correct it", default=known["process"].title
        ),
        **told.text("one line for people"),
    )
    seed: int = part(
        _seed,
        description="whole number: of the measurement noise and of searches",
        type="integer",
        minimum=0,
    )
    scenario: TableReader | None = table_below(
        ScenarioTable, "table of what happens, see [Scenario](#scenario)", "write [scenario]"
    )
    ranking: TableReader | None = table_below(
        Ranking, "table of what counts, see [Ranking](#ranking)", "write [ranking]"
    )
    controllers: tuple[ControllerRequest, ...] = part(
        lambda table, key, known: read_controllers(table, known["process"], known["folder"]),
        **told.by_name("a table for each controller", {"type": "object"}),
    )
    cases: TableReader | None = part(
        lambda table, key, known: (
            table.table(key, "a table for each case", "write [cases.NAME]")
            if table.has(key)
            else None
        ),
        **told.by_name(
            "a table for each other operating point or variant at which they are tried too, see "
            "[Cases](cases.md)",
            table_schema(CaseTable),
        ),
    )
    designs: Designs = choice(
        get_args(Designs),
        words='which designs stand beside them: `"all"` that apply, with the usual tunings, or '
        '`"none"`',
    )


def study_schema() -> dict[str, Any]:
    """Return the JSON Schema of a study file, for editors."""
    schema = "http://json-schema.org/draft-07/schema#"
    found = {"$schema": schema, "title": "Clepsydra study file", **table_schema(StudyTable)}
    found["properties"]["controllers"]["additionalProperties"] = controller_schema()
    return found


def read_study(path: str | Path, *, seed: int | None = None) -> StudyRequest:
    """Read a study file: process, scenario, controllers and what they are ranked by.

    docs/study-files.md describes the file; the number behind its path in "FILE.toml#7" draws holes,
    splits and gains of its process. A seed stands in the place of the file's. The
    controllers are not made yet: `ControllerRequest.make` designs them.

    Raises
    ------
    InputError
        The file cannot be used: the message names line and key.
    NoEquilibrium
        The process has no operating point.
    """
    require_type(path, (str, Path), "study", "the path of a study file", "give it as text or Path")
    name, number = split_number(str(path))
    path = Path(name)
    document = parse(study_text(path), str(path), "study")
    if kind_of(document) == "lesson":
        raise InputError(
            str(path),
            "a lesson",
            "a study file, without tasks",
            "give it to clepsydra lab --lesson",
        )
    if kind_of(document) == "process":
        raise InputError(
            str(path),
            "a process file",
            'a study file, which names its process as in process = "quadruple-tank"',
            "write one with clepsydra new --study NAME --process FILE, or give the process itself "
            "to clepsydra study, which then tries every design",
        )
    general = TableReader(document, (), keys_of(StudyTable))
    read = StudyTable(**read_fields(StudyTable, general, folder=path.parent))
    process = drawn(read.process, number)
    scores: tuple[str, ...] = ()
    if read.ranking is not None:
        scores = Ranking(**read_fields(Ranking, read.ranking, process=process)).scores
    analysis = analyse(process)
    chosen = read.seed if seed is None else seed
    request = StudyRequest(
        path=path,
        title=read.title,
        process=process,
        analysis=analysis,
        scenario=read_scenario(read.scenario, analysis, chosen, path.parent),
        controllers=read.controllers,
        scores=scores,
        seed=chosen,
        designs=read.designs,
    )
    if read.cases is None:
        return request
    reader = CaseReader(request, general, read.scenario, path.parent)
    return replace(request, cases=reader.read(read.cases))
