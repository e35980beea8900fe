"""The physical parameters of a process from a record: holes, gains, splits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.identification.estimate import Estimate
from clepsydra.identification.process_search import ProcessSearch
from clepsydra.identification.record import Record
from clepsydra.identification.residual_tests import ResidualTests, residual_tests
from clepsydra.identification.uncertainty import Uncertainty, uncertainty
from clepsydra.identification.validation import USEFUL, fits
from clepsydra.process.process import Process

#: Correlation of two estimates from which on it is said.
_TOGETHER = 0.95
#: Several outputs are weighed by their residuals so often.
_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class OutputFit:
    """How one measurement of a fitted process compares with the record [SI], fits in %."""

    signal: Signal
    measured: np.ndarray
    simulated: np.ndarray
    tests: ResidualTests
    fit: float  # to the first two thirds
    validated: float  # to the held-back third

    @property
    def is_still(self) -> bool:
        """Whether it stands still but for white noise."""
        noise = self.tests.white and self.tests.independent
        return math.isnan(self.validated) or (self.validated < USEFUL and noise)


@dataclass(frozen=True, eq=False)
class ProcessFit:
    """A process with the parameters that explain a record best."""

    process: Process  # with the fitted parameters
    record: Record
    estimates: tuple[Estimate, ...]
    start: tuple[Estimate, ...]  # the states at the first row
    before: tuple[float, ...]  # the parameters' values in the file
    outputs: tuple[OutputFit, ...]
    sure: Uncertainty  # of the scaled unknowns, the parameters first
    notes: tuple[str, ...]  # what was taken for granted

    @property
    def values(self) -> dict[str, float]:
        """The fitted parameters by name [SI]."""
        return {estimate.signal.name: estimate.value for estimate in self.estimates}

    @property
    def worst(self) -> OutputFit | None:
        """The measurement that is told worst; None where none moves in the held-back third.

        One that nothing explains because it is nothing but white noise does not count.
        """
        moving = [output for output in self.outputs if not output.is_still]
        return min(moving, key=lambda output: output.validated, default=None)

    @property
    def verdict(self) -> str:
        """How well the fitted process tells the held-back third, in words."""
        worst = self.worst
        if worst is None:
            return "Nothing is validated: no measurement moves in the held-back third."
        explains = f"{worst.validated:.1f} % of the held-back third of {worst.signal.name}"
        if worst.validated < USEFUL:
            return (
                f"Do not use this fit: on the held-back third of {worst.signal.name} the process "
                "is hardly better than a constant, so that something in it is not as in the file."
            )
        untold = [estimate.signal.name for estimate in self.estimates if not estimate.is_told]
        words = f"With these parameters {self.process.name} explains {explains}"
        words += ", the worst of its measurements" if len(self.outputs) > 1 else ""
        traced = [output.signal.name for output in self.outputs if not output.tests.independent]
        if traced:
            words += (
                f"; what is left of {' and '.join(traced)} still depends on the inputs, so that "
                "the plant does more than the file says"
            )
        if untold:
            words += f"; the record does not tell {' and '.join(untold)}"
        return f"{words}."

    @property
    def alike(self) -> tuple[str, ...]:
        """Pairs of parameters that err together by more than 0.95, in words."""
        names = [estimate.signal.name for estimate in self.estimates]
        found = self.sure.correlations
        return tuple(
            f"{one} and {other} err together (correlation {found[i, j]:.3f}): their ratio or "
            "product is better known than either"
            for i, one in enumerate(names)
            for j, other in enumerate(names)
            if i < j and abs(found[i, j]) > _TOGETHER
        )

    def as_dict(self) -> dict[str, Any]:
        """Return all of it, for JSON, in SI."""
        return {
            "record": self.record.place,
            "process": self.process.name,
            "samples": self.record.samples,
            "sampling_period": self.record.period,
            "held_back_from": float(self.record.time[self.record.held_back]),
            "verdict": self.verdict,
            "parameters": [
                {**estimate.as_dict(), "before": before}
                for estimate, before in zip(self.estimates, self.before, strict=True)
            ],
            "start": [estimate.as_dict() for estimate in self.start],
            "outputs": [
                {
                    "name": output.signal.name,
                    "fit": output.fit,
                    "validated_fit": output.validated,
                    "whiteness": output.tests.whiteness,
                    "independence": output.tests.independence,
                    "residuals": output.tests.words,
                }
                for output in self.outputs
            ],
            "widening": self.sure.widening,
            "notes": [*self.notes, *self.alike],
        }


def fit_process(process: Process, record: Record, parameters: Sequence[str]) -> ProcessFit:
    """Fit parameters of a process to the first two thirds of a record that was read for it.

    The process is simulated from the recorded inputs and compared with every measurement that
    the record has, each weighed by the size of its own residuals; the states at the first row
    are fitted as well. Parameters from 0 on are searched by their logarithm, so that they stay
    above zero. SciPy's trust-region reflective method, with the sensitivities by central
    differences, all in one batch of the engine. Inputs and disturbances that the record lacks stay
    nominal.

    Raises
    ------
    InputError
        There is no such parameter, one is plugged, the record has no input or no measurement, a
        parameter leaves no trace in it, or several are not told apart.

    References
    ----------
    L. Ljung, System Identification, 2nd ed., 1999, sections 4.2 and 7.4 (output error, maximum
    likelihood with independent outputs).

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.process.reader import load_process
    >>> tanks = load_process("quadruple-tank")
    >>> steps = [cl.step("pump_1", to=4.0, at=60.0), cl.step("pump_1", to=2.0, at=300.0)]
    >>> run = cl.simulate(cl.Plant(tanks), None, steps, duration="10 min")
    >>> record = Record("by hand", run.signals, run.values, tanks.sampling_period)
    >>> wrong = tanks.with_parameters({"outlet_1.area": 8e-6})
    >>> round(fit_process(wrong, record, ["outlet_1.area"]).values["outlet_1.area"] * 1e6, 6)
    7.1
    """
    search = ProcessSearch(process, record, parameters)
    search.keep_those_with_trace()
    found, sizes = search.guess, search.spans
    for _ in range(_ROUNDS if len(search.outputs) > 1 else 1):
        found = search.search(found, sizes)
        left = search.at(found)[0]
        sizes = np.maximum(np.sqrt(np.mean(left**2, axis=1)), search.smallest)
    return _result(search, found, sizes)


def _result(search: ProcessSearch, x: np.ndarray, sizes: np.ndarray) -> ProcessFit:
    left, slopes = search.at(x)
    if not np.all(np.isfinite(left)):
        raise InputError(
            search.record.place, "a simulation that breaks down", "a process that can be "
            "simulated over the record", "check inputs and units against the process file",
        )  # fmt: skip
    left, slopes = -left / sizes[:, None], slopes / sizes[:, None, None]
    search.check_apart(slopes.reshape(-1, len(x)))
    given = search.batch.given
    inputs = np.zeros((search.count, len(search.moving)))
    for place, signal in enumerate(search.moving):
        inputs[:, place] = given[signal.name][: search.count]
    # What no sensor resolves is left by rounding and tells nothing.
    tests = [
        residual_tests(e, J, inputs) if size > least else ResidualTests(1.0, 1.0, None)
        for e, J, size, least in zip(left, slopes, sizes, search.smallest, strict=True)
    ]
    sure = uncertainty(slopes, left, [test.noise for test in tests])
    simulated = search.simulated(np.tile(x[:, None], (1, 2)))[0]
    outputs = []
    for signal, test, measured, found in zip(
        search.outputs, tests, search.measured, simulated, strict=True
    ):
        of_both = fits(measured, found, search.count)
        outputs.append(OutputFit(signal, measured, found, test, *of_both))
    searched = zip(search.unknowns, x, sure.reach, strict=True)
    every = tuple(unknown.estimate(value, reach) for unknown, value, reach in searched)
    estimates, start = every[: len(search.parameters)], every[len(search.parameters) :]
    values = {e.signal.name: e.value for e in estimates}
    return ProcessFit(
        process=search.process.with_parameters(values),
        record=search.record,
        estimates=estimates,
        start=start,
        before=tuple(signal.initial for signal in search.parameters),
        outputs=tuple(outputs),
        sure=sure,
        notes=search.notes,
    )
