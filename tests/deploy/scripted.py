"""Exported WebAssembly as its script runs it, in Node or in a page, beside the engine.

`called.mjs` goes through the scans; numbers go there and back as bytes, so that none is rounded.
"""

import base64
from functools import cache
from pathlib import Path

import numpy as np
from plants import plant

from clepsydra import Kernel
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.deploy.web_assembly.printer import WebModule, print_web_assembly
from clepsydra.program.program import Program
from clepsydra.studies.designs import DESIGNS

CALLED = Path(__file__).with_name("called.mjs")
EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
#: Design and process of controllers, and processes. Among them are exp and log, delays, tables,
#: loops, and a kernel so large that it asks for memory.
CONTROLLERS = {
    "PI, SIMC": "quadruple-tank",
    "PI, gain scheduling": "three-tanks",
    "PI, variable structure": "quadruple-tank",
    "LQI with extended Kalman filter": "quadruple-tank",
    "LQI, gain scheduling": "quadruple-tank",
    "LQI, recomputed": "blending-station.toml",
    "2DOF polynomial, LQ": "quadruple-tank",
    "Smith predictor, PI": "eight-tanks",
    "Feedback linearisation": "quadruple-tank",
    "Fuzzy PI": "quadruple-tank",
    "Start/stop levels": "wet-well:start-stop",
}
PROCESSES = (
    "quadruple-tank", "equalisation-tank", "eight-tanks", "wet-well", "three-tanks",
    "surge-vessel.toml", "blending-station.toml", "sample-line.toml",
)  # fmt: skip
NAMES = (*CONTROLLERS, *PROCESSES)


@cache
def program(name: str) -> tuple[Program, float]:
    """Return what is exported by a name of `NAMES`, and its sampling period [s]."""
    process = CONTROLLERS.get(name, name)
    its = plant(EXAMPLES / process if process.endswith(".toml") else process)
    period = its.process.sampling_period
    if name in CONTROLLERS:
        return exportable(DESIGNS[name](its.analysis), its.point).program, period
    return process_program(its.point), period


@cache
def module(name: str) -> WebModule:
    """Return what `--to wasm` writes of it."""
    return print_web_assembly(program(name)[0])


@cache
def _kernel(name: str) -> Kernel:
    return Kernel(program(name)[0], fuse=False)


class ScriptedRun:
    """Random scans of a program, with random parameters.

    Parameters
    ----------
    name : str
        Of `NAMES`.
    scans, breaks : int
        Before how many of the scans the run is left and taken up again.
    seed : int
    """

    def __init__(self, name: str, scans: int, breaks: int, seed: int) -> None:
        printed, period = program(name)
        random = np.random.default_rng(seed)
        drawn = random_scans(printed, scans, seed, period, broken=name in CONTROLLERS)
        self.name, self.scans = name, scans
        self.inputs = {signal.name: drawn[signal.name] for signal in printed.inputs}
        self.parameters = {
            each.name: each.initial * (random.uniform(0.99, 1.01) if each.kind == "real" else 1.0)
            for each in printed.parameters
        }
        self.broken = sorted(random.choice(scans, breaks, replace=False).tolist())

    @property
    def told(self) -> dict[str, object]:
        """What `called` of called.mjs takes."""
        return {
            "name": self.name,
            "scans": self.scans,
            "inputs": _bytes(np.column_stack(list(self.inputs.values()))),
            "parameters": _bytes(np.array(list(self.parameters.values()))),
            "broken": self.broken,
        }

    def is_found(self, answer: str) -> bool:
        """Whether what `called` returned is the engine's uninterrupted run, bit for bit."""
        run = _kernel(self.name).run(self.scans, inputs=self.inputs, parameters=self.parameters)
        expected = np.ascontiguousarray(run.record_of(0))
        found = np.frombuffer(base64.b64decode(answer)).reshape(expected.shape)
        return np.array_equal(_bits(found), _bits(expected))


def _bytes(numbers: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(numbers, float).tobytes()).decode()


def _bits(numbers: np.ndarray) -> np.ndarray:
    """Return the bits; WebAssembly leaves those of what is not a number open."""
    return np.where(np.isnan(numbers), -1, numbers.view(np.int64))
