"""The plan of an open-loop run: where the process starts, what its inputs do, how long."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from clepsydra.base.arguments import check_choice, require_signal
from clepsydra.base.errors import InputError
from clepsydra.base.units import to_si
from clepsydra.base.words import listed, time_text
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.poles import time_constants
from clepsydra.loop.open_loop import Simulation, simulate, simulations, state_from
from clepsydra.loop.profile import (
    Change,
    check_range,
    pretty_duration,
    profiles_of,
    read_duration,
    samples_before,
)
from clepsydra.loop.residence_times import residence_times
from clepsydra.loop.run_cost import weigh_run
from clepsydra.loop.step_size import TOLERANCE as TOLERANCE
from clepsydra.loop.step_size import Solver, check_solver, refined, substeps_for
from clepsydra.process.process import Process

Start = Literal["rest", "empty"]

#: Length of a run that nobody gave one for, in times of the slowest time constant.
_SLOWEST_TIMES = 6.0
#: And in mean residence times: any number of equal tanks in series is within 2 % of its end then.
_RESIDENCE_TIMES = 3.0
_MOST_SAMPLES = 1_000_000
#: Samples of the length of time that is proposed where nothing settles.
_PROPOSED = 500


@dataclass(frozen=True, eq=False)
class Plan:
    """What an open-loop run is to do.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts, and where signals without a change stay.
    state : mapping
        States that do not start at the point [SI].
    changes : tuple of Change
        In order of time.
    samples : int
    begins : str
        Where it starts, in words: "at rest", "empty".
    substeps : int
        Integration steps in a sampling period to begin with.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("quadruple-tank"))
    >>> plan.duration, plan.begins
    (600.0, 'at rest')
    """

    point: OperatingPoint
    state: Mapping[str, float]
    changes: tuple[Change, ...]
    samples: int
    begins: str
    substeps: int

    @property
    def process(self) -> Process:
        """The process."""
        return self.point.process

    @property
    def duration(self) -> float:
        """Length of the run [s]."""
        return self.samples * self.process.sampling_period

    @property
    def first(self) -> OperatingPoint:
        """Every signal at the start of the run; nothing says that it is at rest there."""
        state = state_from(self.point, self.state)
        return OperatingPoint.at(self.process, state, self.point.inputs, self.point.disturbances)

    def run(self, solver: Solver = "kernel") -> Simulation:
        """Simulate as planned.

        The kernel's error is estimated by halving the step, and the step is halved until the
        estimate is below 1e-6 of each state's range or 64 times as many steps have been tried.
        The reference solver keeps its own tolerance, 1e-10, and no estimate is made.

        Raises
        ------
        InputError
            The solver is unknown, or changes of a signal are out of order or beyond the end.
        """
        period = self.process.sampling_period
        at = self.point.as_dict()
        outside = (*self.process.inputs, *self.process.disturbances)
        before = {signal.name: at[signal.name] for signal in outside}
        profiles = profiles_of(self.changes, before, period, self.samples)

        check_solver(solver)
        checked = solver == "kernel"
        weigh_run(self.process, self.samples, self.substeps, checked=checked, solver=solver)
        if solver == "reference":
            return simulate(
                self.point, profiles, substeps=self.substeps, state=self.state, solver=solver
            ).until_end()
        simulated = simulations(self.point, profiles, self.state)
        run, estimate = refined(self.process, simulated, self.substeps, TOLERANCE)
        return replace(run, error_estimate=estimate).until_end()


def read_state(name: str, value: object, process: Process, place: str) -> float:
    """Read the value at which a state starts [SI].

    Raises
    ------
    InputError
        There is no such state, or the value has another unit or is out of its range.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> read_state("tank_1.level", "5 cm", load_process("quadruple-tank"), "--state")
    0.05
    """
    signal = require_signal(place, name, process.state, f"a state of {process.name}")
    where = f"{place}, {name}"
    number = to_si(value, signal.unit, where)
    check_range(signal, number, where)
    return number


def plan_simulation(
    process: Process,
    changes: Iterable[Change] = (),
    *,
    duration: str | None = None,
    start: Start = "rest",
    state: Mapping[str, float] | None = None,
    rest: OperatingPoint | None = None,
) -> Plan:
    """Choose where an open-loop run starts, how long it lasts and with which step it begins.

    Parameters
    ----------
    process : Process
    changes : iterable of Change
        Those of one signal in order of time.
    duration : str, optional
        If left out, after the last change all dead times and six times the slowest finite time
        constant, or three times the mean residence time where that is more, as a pretty number.
    start : {"rest", "empty"}
        At the equilibrium of the process, or with empty tanks and everything else as there.
    state : mapping, optional
        States that start elsewhere [SI].
    rest : OperatingPoint, optional
        Where it rests, if not at the operating point of the process.

    Raises
    ------
    InputError
        The start is unknown, the run would take more than a million samples, or it has no
        duration and the process no finite time constant.
    NoEquilibrium
        It starts at rest and the process does not rest anywhere.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("quadruple-tank"), start="empty")
    >>> plan.first.as_dict()["tank_1.level"]
    0.0
    """
    check_choice("start", start, get_args(Start), "choose one")
    state = dict(state or {})
    changes = tuple(changes)
    complete = all(signal.name in state for signal in process.state)
    try:
        rest = find_equilibrium(process) if rest is None else rest
    except NoEquilibrium as error:
        if start == "rest" and not complete:
            raise NoEquilibrium(
                process, [*error.reasons, "so that a simulation has to start empty"], error.place
            ) from None
        rest = _middle(process)
    model = _model_near(rest)
    point = emptied(rest) if start == "empty" else rest
    begins = "empty" if start == "empty" else "at rest"
    if complete:
        begins = "at the given state"
    elif state:
        begins += f", but for {' and '.join(state)}"
    period = process.sampling_period
    length = (
        read_duration(duration, "duration")
        if duration is not None
        else _default_duration(model, changes)
    )
    samples = max(1, samples_before(length, period))
    if samples > _MOST_SAMPLES:
        raise InputError(
            "duration",
            time_text(length, 4),
            f"at most {time_text(_MOST_SAMPLES * period, 4)}, a million samples of {period:g} s",
            "shorten it, or lengthen the sampling period of the process",
        )
    return Plan(point, state, changes, samples, begins, substeps_for(model))


def _middle(process: Process) -> OperatingPoint:
    """Return the point where searches begin: levels half-way up, inputs at their nominal values."""
    state, inputs, disturbances = (
        np.array([signal.initial for signal in group])
        for group in (process.state, process.inputs, process.disturbances)
    )
    return OperatingPoint.at(process, state, inputs, disturbances)


def emptied(rest: OperatingPoint) -> OperatingPoint:
    """Return a point with empty tanks; valves and sensors stand as they do at rest.

    Examples
    --------
    >>> import clepsydra as cl
    >>> float(emptied(cl.load("quadruple-tank").point).measurements[0])
    0.0
    """
    process = rest.process
    inside = {s.name for e in process.elements if e.holds_liquid for s in e.states()}
    state = np.array(
        [
            signal.low if signal.name in inside else value
            for signal, value in zip(process.state, rest.state, strict=True)
        ]
    )
    return OperatingPoint.at(process, state, rest.inputs, rest.disturbances)


def _model_near(rest: OperatingPoint) -> LinearModel:
    """Return the linear model at rest, or with half-full tanks where one is empty at rest."""
    try:
        return linearise(rest)
    except InputError:
        return linearise(_middle(rest.process))


def _default_duration(model: LinearModel, changes: tuple[Change, ...]) -> float:
    late = float(model.times.sum())
    resting = at_rest(model)
    constants = np.abs(time_constants(resting))
    finite = constants[np.isfinite(constants)]
    if not finite.size:
        drifting = [
            name for name, row in zip(resting.states, resting.A, strict=True) if not any(row)
        ]
        period = operating_point_of(model).process.sampling_period
        raise InputError(
            "duration",
            "no length of time",
            f"one, since {listed(drifting) or 'the process'} goes on rising or falling for as long "
            "as flows differ",
            f'give one, as in duration="{time_text(pretty_duration(_PROPOSED * period))}"',
        )
    slowest = _SLOWEST_TIMES * float(finite.max())
    if finite.size == constants.size:
        # No channel has more lags than there are; an output that hardly moves may seem to.
        residence = min(residence_times(resting).max(initial=0.0), finite.sum())
        slowest = max(slowest, _RESIDENCE_TIMES * float(residence))
    last = max((change.end for change in changes), default=0.0)
    return pretty_duration(last + late + slowest)
