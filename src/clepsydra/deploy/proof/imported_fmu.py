"""FMUs imported by FMPy: one communication step a scan, or derivatives at many states."""

from __future__ import annotations

import ctypes
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from clepsydra.base.errors import ClepsydraError, Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.process_program import HELD
from clepsydra.deploy.proof.instance import Array, Scans, given_parameters
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import state_names
from clepsydra.program.program import Program

#: Type of a variable to the suffix of the function that reads or sets it and to its C type.
_FUNCTIONS: dict[str, dict[str, tuple[str, Any]]] = {
    "3.0": {
        "real": ("Float64", ctypes.c_double),
        "integer": ("Int32", ctypes.c_int32),
        "boolean": ("Boolean", ctypes.c_bool),
    },
    "2.0": {
        "real": ("Real", ctypes.c_double),
        "integer": ("Integer", ctypes.c_int),
        "boolean": ("Boolean", ctypes.c_int),
    },
}
_CONVERSIONS = {"real": float, "integer": int, "boolean": bool}


class FmuError(ClepsydraError):
    """An FMU cannot be imported or does not run."""


@contextmanager
def _imported(path: Path, folder: Path) -> Iterator[tuple[Any, Any, bool]]:
    """Give description and instance of an FMU, initialised, and whether it is of version 3.0.

    It is unpacked into a folder that is taken away again.
    """
    try:
        import fmpy
        from fmpy.fmi2 import FMU2Model, FMU2Slave
        from fmpy.fmi3 import FMU3Model, FMU3Slave
    except ImportError as error:
        raise InputError(
            "proof of FMUs", Finding(f"no package {error.name}"), "the importer FMPy",
            "pip install 'clepsydra[verify]'",
        ) from None  # fmt: skip
    try:
        description = fmpy.read_model_description(str(path))
        fmpy.extract(str(path), str(folder))
        third, exchange = description.fmiVersion == "3.0", description.modelExchange
        if third:
            kind = FMU3Model if exchange else FMU3Slave
        else:
            kind = FMU2Model if exchange else FMU2Slave
        fmu = kind(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=(exchange or description.coSimulation).modelIdentifier,
            instanceName=description.modelName,
        )
        fmu.instantiate(**({"logMessage": _silent} if third else {}))
        try:
            if not third:
                fmu.setupExperiment(startTime=0.0)
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
            yield description, fmu, third
            # After an error nothing but to be freed is left to an instance.
            fmu.terminate()
        finally:
            fmu.freeInstance()
    except FmuError:
        raise
    except Exception as error:
        raise FmuError(f"{path.name}: {error}") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _silent(environment: Any, status: Any, category: Any, message: Any) -> None:
    """Keep what an FMU says of a call away from the terminal; its status is an error already."""


def run_fmu(
    program: Program, path: Path, folder: Path, sampling_period: float, inputs: Scans
) -> tuple[tuple[Signal, ...], Array]:
    """Run an FMU for co-simulation, a communication step of a sampling period a scan.

    Parameters
    ----------
    program : Program
        What it was written from.
    path, folder : Path
        Of the FMU, and where it is unpacked.
    sampling_period : float
        [s]
    inputs : mapping

    Returns
    -------
    tuple
        The outputs and states of the program that it shows, all but delay rings, and their values
        [scans, shown].

    Raises
    ------
    FmuError
        The FMU cannot be imported, or refuses a step.
    """
    # A ring is no variable of the model description.
    states = [signal_of(entry) for entry in program.state if not is_ring(entry)]
    shown = (*program.outputs, *states)
    tuned = given_parameters(program, inputs)
    given, rows = (*program.inputs, *tuned), []
    with _imported(path, folder) as (description, fmu, third):
        references = _references(program, description)
        needed = (*program.inputs, *program.parameters, *shown)
        missing = [signal.name for signal in needed if signal.name not in references]
        if missing:
            raise FmuError(f"{path.name}: it has no variable {', '.join(missing)}")
        setting, parameters, showing = (
            _Access(fmu, "3.0" if third else "2.0", signals, references)
            for signals in (given, tuned, shown)
        )
        printed = dict(zip((signal.name for signal in tuned), parameters.read(), strict=True))
        columns = [_filled(inputs[signal.name], printed.get(signal.name)) for signal in given]
        for scan, row in enumerate(np.column_stack(columns).tolist() if columns else ()):
            try:
                setting.write(row)
                fmu.doStep(scan * sampling_period, sampling_period)
                rows.append(showing.read())
            except Exception as error:
                raise FmuError(f"{path.name}, scan {scan}: {error}") from None
    return shown, np.array(rows, dtype=float)


def rates_of_fmu(
    path: Path, folder: Path, contents: Array, outside: Array, names: Sequence[str]
) -> Array:
    """Return the derivatives that an FMU for model exchange gives [count, states].

    Parameters
    ----------
    path, folder : Path
        Of the FMU, and where it is unpacked.
    contents, outside : array
        Continuous states, and inputs and disturbances [count, signals].
    names : sequence of str
        Of inputs and disturbances.
    """
    found = np.zeros_like(contents)
    size = contents.shape[1]
    states, rates = (ctypes.c_double * size)(), (ctypes.c_double * size)()
    with _imported(path, folder) as (description, fmu, third):
        # The memories stay as they start: only what is asked for in event mode would change them.
        fmu.enterContinuousTimeMode()
        references = {v.name: v.valueReference for v in description.modelVariables}
        known = [references[name] for name in names]
        set_inputs = fmu.setFloat64 if third else fmu.setReal
        derivatives = fmu.getContinuousStateDerivatives if third else fmu.getDerivatives
        for k, (row, held) in enumerate(zip(contents.tolist(), outside.tolist(), strict=True)):
            states[:] = row
            set_inputs(known, held)
            fmu.setContinuousStates(states, size)
            derivatives(rates, size)
            found[k] = rates
    return found


def _references(program: Program, description: Any) -> dict[str, int]:
    """Return the value reference of each variable by the names of the program."""
    # The place of an element, in brackets there, is a word of a path, and a word may begin with a
    # digit.
    found = {
        re.sub(r"\._(?=\d)", ".", variable.name.replace("[", ".").replace("]", "")): (
            variable.valueReference
        )
        for variable in description.modelVariables
    }
    # What a process holds has the name of the process in an FMU, where nothing else has it.
    found = {f"{HELD}.{name}": number for name, number in found.items()} | found
    # A state in an instance of a block has the name of that instance before its own.
    shown = state_names(program).items()
    return found | {name: found[inside] for name, inside in shown if inside in found}


def _filled(column: Array, printed: float | None) -> Array:
    """Return an input, or a parameter with the printed value where it is not a number."""
    return column if printed is None else np.where(np.isnan(column), printed, column)


class _Access:
    """Variables that are read or set together, by one call for all of a type."""

    def __init__(
        self, fmu: Any, version: str, signals: Sequence[Signal], references: Mapping[str, int]
    ) -> None:
        self._size = len(signals)
        self._groups = []
        for kind, (suffix, type_) in _FUNCTIONS[version].items():
            places = [place for place, signal in enumerate(signals) if signal.kind == kind]
            if places:
                count = len(places)
                numbers = [references[signals[place].name] for place in places]
                values = (type_ * count)()
                given = [fmu.component, (ctypes.c_uint * count)(*numbers), count, values]
                given += [count] if version == "3.0" else []
                getting, setting = (
                    partial(getattr(fmu, f"fmi{version[0]}{verb}{suffix}"), *given)
                    for verb in ("Get", "Set")
                )
                self._groups.append((places, values, _CONVERSIONS[kind], getting, setting))

    def write(self, row: Sequence[float]) -> None:
        for places, values, conversion, _, setting in self._groups:
            values[:] = [conversion(row[place]) for place in places]
            setting()

    def read(self) -> list[float]:
        row = [0.0] * self._size
        for places, values, _, getting, _ in self._groups:
            getting()
            for place, value in zip(places, values, strict=True):
                row[place] = float(value)
        return row
