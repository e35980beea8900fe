"""FMUs written and imported by FMPy: one object an instance, whatever the version."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import fmi2, fmi3

from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.write import write_fmu

VERSIONS = ("3.0", "2.0")


def cases(names) -> list:
    """Every name with a version in turn."""
    turns = [(name, VERSIONS[place % len(VERSIONS)]) for place, name in enumerate(names)]
    return [
        pytest.param(name, version, id=f"{name.splitlines()[0]}, {version}")
        for name, version in turns
    ]


def written(model: FmuModel, folder: Path, version: str) -> Path:
    """Write an FMU into a folder."""
    path = folder / f"{model.name}_{version[0]}.fmu"
    write_fmu(path, model, find_compiler("tests"), version=version)
    return path


class Imported:
    """One instance of an FMU; `said` is what it told the importer."""

    def __init__(self, path: Path, folder: Path, name: str = "one", token: str = "") -> None:
        self.description = fmpy.read_model_description(str(path))
        unpacked = folder / f"unpacked_{path.stem}"
        if not unpacked.exists():
            fmpy.extract(str(path), str(unpacked))
        self.third = self.description.fmiVersion == "3.0"
        self.exchange = self.description.modelExchange is not None
        interface = self.description.modelExchange or self.description.coSimulation
        kinds = {
            (True, True): fmi3.FMU3Model, (True, False): fmi3.FMU3Slave,
            (False, True): fmi2.FMU2Model, (False, False): fmi2.FMU2Slave,
        }  # fmt: skip
        self.fmu = kinds[self.third, self.exchange](
            guid=token or self.description.guid,
            unzipDirectory=str(unpacked),
            modelIdentifier=interface.modelIdentifier,
            instanceName=name,
        )
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.said: list[str] = []
        if self.third:
            self.fmu.instantiate(logMessage=self._listen_3)
        else:
            self._logger = fmi2.fmi2CallbackLoggerTYPE(self._listen_2)
            callbacks = fmi2.fmi2CallbackFunctions()
            callbacks.logger = self._logger
            callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
            callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
            self.fmu.instantiate(callbacks=callbacks)

    def _listen_3(self, environment, status, category, message):
        self.said.append(message.decode())

    def _listen_2(self, environment, name, status, category, message):
        self.said.append(message.decode())

    def initialise(self, start: float = 0.0) -> "Imported":
        self.enter(start)
        self.fmu.exitInitializationMode()
        return self

    def enter(self, start: float = 0.0) -> None:
        if self.third:
            self.fmu.enterInitializationMode(startTime=start)
        else:
            self.fmu.setupExperiment(startTime=start)
            self.fmu.enterInitializationMode()

    def _function(self, verb: str, name: str):
        kind = self.variables[name].type
        return getattr(self.fmu, f"{verb}{kind}"), self.variables[name].valueReference

    def set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            function, reference = self._function("set", name)
            kind = self.variables[name].type
            converted = (
                bool(value)
                if kind == "Boolean"
                else int(value)
                if kind in ("Int32", "Integer")
                else float(value)
            )
            function([reference], [converted])

    def get(self, name: str) -> float:
        function, reference = self._function("get", name)
        return float(function([reference])[0])

    def get_all(self, names) -> list[float]:
        return [self.get(name) for name in names]

    def step(self, time: float, length: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def state(self):
        return self.fmu.getFMUState() if self.third else self.fmu.getFMUstate()

    def set_state(self, state) -> None:
        (self.fmu.setFMUState if self.third else self.fmu.setFMUstate)(state)

    def free_state(self, state) -> None:
        (self.fmu.freeFMUState if self.third else self.fmu.freeFMUstate)(state)

    def serialised(self, state) -> bytes:
        third = self.third
        return (self.fmu.serializeFMUState if third else self.fmu.serializeFMUstate)(state)

    def deserialised(self, content: bytes):
        if self.third:
            return self.fmu.deserializeFMUState(content)
        return self.fmu.deSerializeFMUstate(content)

    def close(self) -> None:
        self.fmu.freeInstance()

    # Model exchange.

    def vector(self, what: str, size: int) -> np.ndarray:
        values = np.empty(size)
        third = {"Derivatives": "ContinuousStateDerivatives"} if self.third else {}
        name = f"fmi{3 if self.third else 2}Get{third.get(what, what)}"
        getattr(self.fmu, name)(self.fmu.component, _pointer(values), size)
        return values

    def set_states(self, values) -> None:
        values = np.ascontiguousarray(values, float)
        name = f"fmi{3 if self.third else 2}SetContinuousStates"
        getattr(self.fmu, name)(self.fmu.component, _pointer(values), len(values))

    def settle(self) -> int:
        """Carry out events until there is none; return how often that was asked for."""
        for turn in range(1, 20):
            found = self.fmu.updateDiscreteStates() if self.third else self.fmu.newDiscreteStates()
            if not found[0]:
                return turn
        raise AssertionError("events without end")


def _pointer(values: np.ndarray):
    import ctypes

    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def all_bits(values) -> np.ndarray:
    """The bits of numbers; every not-a-number counts as the same one."""
    values = np.ascontiguousarray(values, dtype=float)
    return np.where(np.isnan(values), -1, values.view(np.int64))
