"""An FMU imported by FMPy: one communication step a scan."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.structures import state_names
from clepsydra.deploy.process_program import HELD
from clepsydra.deploy.proof.instance import Instance, given_parameters
from clepsydra.program.entries import is_ring, signal_of
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
    """An FMU cannot be imported or does not run.

    Examples
    --------
    >>> raise FmuError("law.fmu: fmi3DoStep ended with status 3")
    Traceback (most recent call last):
        ...
    clepsydra.deploy.proof.imported_fmu.FmuError: law.fmu: fmi3DoStep ended with status 3
    """


def importer() -> Any:
    """Return the package FMPy.

    Raises
    ------
    InputError
        It is not installed.

    Examples
    --------
    >>> importer().__name__
    'fmpy'
    """
    try:
        import fmpy
    except ImportError as error:
        raise InputError(
            "proof of FMUs", f"no package {error.name}", "the importer FMPy",
            "pip install 'clepsydra[verify]'",
        ) from None  # fmt: skip
    return fmpy


class ImportedFmu(Instance):
    """An FMU for co-simulation, one communication step of a sampling period a scan.

    Parameters
    ----------
    program : Program
        What it was written from.
    path : Path
        Of the FMU.
    folder : Path
        Where it is unpacked; taken away when the instance is closed.
    sampling_period : float
        [s]

    Raises
    ------
    InputError
        FMPy is not installed.
    FmuError
        The FMU cannot be imported.

    Examples
    --------
    See `clepsydra.deploy.proof.fmu_runs`.
    """

    def __init__(self, program: Program, path: Path, folder: Path, sampling_period: float) -> None:
        super().__init__(program)
        self._name, self._folder, self._period = path.name, folder, sampling_period
        self._scan = 0
        fmpy = importer()
        try:
            self.description = fmpy.read_model_description(str(path))
            fmpy.extract(str(path), str(folder))
            self._fmu = self._started(fmpy)
        except Exception as error:
            raise FmuError(f"{path.name}: {error}") from None
        version = _FUNCTIONS[self.description.fmiVersion]
        self._is_third = self.description.fmiVersion == "3.0"
        # The place of an element, in brackets there, is a word of a path.
        references = {
            v.name.replace("[", ".").replace("]", ""): v.valueReference
            for v in self.description.modelVariables
        }
        # What a process holds has the name of the process in an FMU, where nothing else has it.
        references = {f"{HELD}.{name}": number for name, number in references.items()} | references
        # A state in an instance of a block has the name of that instance before its own.
        references |= {
            name: references[shown]
            for name, shown in state_names(program).items()
            if shown in references
        }
        states = [signal_of(e) for e in program.state if not is_ring(e)]
        # A ring is no variable of the model description.
        self.shown = (*program.outputs, *states)
        needed = (*program.inputs, *program.parameters, *self.shown)
        missing = [signal.name for signal in needed if signal.name not in references]
        if missing:
            raise FmuError(f"{path.name}: it has no variable {', '.join(missing)}")
        self._setters: list[_Access] | None = None
        self._printed: dict[str, float] = {}
        self._references, self._version = references, version
        self._getters = _accesses(self.shown, references, version)
        read = [name for access in self._getters for name in access.names]
        self._places = [read.index(signal.name) for signal in self.shown]

    def _started(self, fmpy: Any) -> Any:
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        description = self.description
        given = {
            "guid": description.guid,
            "unzipDirectory": str(self._folder),
            "modelIdentifier": description.coSimulation.modelIdentifier,
            "instanceName": self.program.name,
        }
        if description.fmiVersion == "3.0":
            fmu = FMU3Slave(**given)
            fmu.instantiate(logMessage=_silent)
            fmu.enterInitializationMode(startTime=0.0)
        else:
            fmu = FMU2Slave(**given)
            fmu.instantiate()
            fmu.setupExperiment(startTime=0.0)
            fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in order."""
        fmu = self._fmu
        if self._setters is None:
            tuned = given_parameters(self.program, inputs)
            self._setters = _accesses(
                (*self.program.inputs, *tuned), self._references, self._version
            )
            printed = _accesses(tuned, self._references, self._version)
            for access in printed:
                self._call("Get", access)
                self._printed |= access.read()
        try:
            for access in self._setters:
                access.fill(inputs, self._printed)
                self._call("Set", access)
            fmu.doStep(self._scan * self._period, self._period)
            for access in self._getters:
                self._call("Get", access)
        except Exception as error:
            raise FmuError(f"{self._name}, scan {self._scan}: {error}") from None
        self._scan += 1
        found: list[float] = []
        for access in self._getters:
            found += access.values[:]
        outputs = len(self.program.outputs)
        self._state = [float(found[place]) for place in self._places[outputs:]]
        return [float(found[place]) for place in self._places[:outputs]]

    def _call(self, verb: str, access: _Access) -> None:
        fmu, count = self._fmu, len(access.names)
        if self._is_third:
            function = getattr(fmu, f"fmi3{verb}{access.suffix}")
            function(fmu.component, access.references, count, access.values, count)
        else:
            function = getattr(fmu, f"fmi2{verb}{access.suffix}")
            function(fmu.component, access.references, count, access.values)

    def state(self) -> list[float]:
        """Return the state in order, without delay rings, which the FMU does not show."""
        return self._state

    def __enter__(self) -> ImportedFmu:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._fmu.terminate()
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)


class _Access:
    """Variables of one type that are read or set together."""

    def __init__(
        self, kind: str, signals: Sequence[Signal], references: Mapping[str, int],
        version: Mapping[str, tuple[str, Any]],
    ) -> None:  # fmt: skip
        self.suffix, type_ = version[kind]
        self.names = [signal.name for signal in signals]
        self._conversion = _CONVERSIONS[kind]
        count = len(signals)
        self.references = (ctypes.c_uint * count)(*(references[name] for name in self.names))
        self.values = (type_ * count)()

    def fill(self, inputs: Mapping[str, float], printed: Mapping[str, float]) -> None:
        given = [inputs[name] for name in self.names]
        if printed:
            given = [
                printed.get(name, value) if value != value else value
                for name, value in zip(self.names, given, strict=True)
            ]
        self.values[:] = list(map(self._conversion, given))

    def read(self) -> dict[str, float]:
        return dict(zip(self.names, map(float, self.values), strict=True))


def _accesses(
    signals: Sequence[Signal], references: Mapping[str, int],
    version: Mapping[str, tuple[str, Any]],
) -> list[_Access]:  # fmt: skip
    found = []
    for kind in _CONVERSIONS:
        chosen = [signal for signal in signals if signal.kind == kind]
        if chosen:
            found.append(_Access(kind, chosen, references, version))
    return found


def _silent(environment: Any, status: Any, category: Any, message: Any) -> None:
    """Keep what an FMU says of a call away from the terminal; its status is an error already."""
