"""Linear model predictive control, without offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import LinearStepLaw
from clepsydra.controllers.predictive.law import FAMILY, predictive_law
from clepsydra.controllers.predictive.prediction import MOST_MOVES, Prediction, TabledObserver
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import number, whole_number
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import Studied, design
from clepsydra.designs.kalman import kalman_gain
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.predictive.disturbances import Disturbed, with_disturbances
from clepsydra.designs.predictive.horizon import (
    blocks_of,
    prediction_of,
    rounded_table,
    usual_horizon,
)
from clepsydra.designs.predictive.linear_law import unbounded_law
from clepsydra.designs.sampled.noise_of_inputs import noise_of_inputs
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, SlowedDown, slow_down
from clepsydra.designs.states.bryson_rule import DEVIATIONS, Deviations, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import check_independent
from clepsydra.designs.states.measured_states import with_outputs, without_idle_states
from clepsydra.designs.states.observed_process import ObservedProcess, observed_process
from clepsydra.designs.states.state_controllers import note_on_sensors
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

NAME = "MPC"
#: κ², by which moves count beside errors; see docs/decisions/0073.
MOVE_WEIGHT = 5.0
#: Of each input.
USUAL_MOVES = 5
#: The horizon has at least so many samples, and at most so many.
FEWEST_SAMPLES, MOST_SAMPLES = 20, 2000
#: The noise of the sensors may move an input by this share of its range (standard deviation).
INPUT_NOISE = 0.045
#: Levels are kept this share of their range below their rims.
BELOW_RIM = 0.02


@design(
    "mpc",
    "model predictive control with a linear model",
    Studied(258, NAME),
    keys=(
        MEASUREMENTS,
        *DEVIATIONS,
        number("horizon", "a time", "how far it looks ahead", unit="s", example='"60 s"'),
        whole_number("moves", "moves of each input that it plans", MOST_MOVES),
    ),
)
def design_mpc(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    horizon: float | None = None,
    moves: int | None = None,
) -> Controller:
    """Design model predictive control with a linear model.

    In every sample it plans the moves of all inputs over the horizon, within their limits and the
    rates of pumps and valves and below the rims of the tanks, and applies the first
    (`controllers.predictive.law`). A Kalman filter estimates the states and as many integrating
    disturbances as there are measurements, so that no offset stays. It is slowed down until the
    sensitivity peak of the loop is at most 2 and the noise of the sensors moves no input by more
    than 4.5 % of its range (standard deviation); setpoints, which have no noise, are followed as
    fast as before.

    Parameters
    ----------
    measurements : sequence of str, optional
        What the filter reads, with the controlled outputs among them; default all sensors that
        show a state which acts on the controlled outputs.
    maximum_errors : mapping, optional
        Output name to its largest acceptable error [measurement unit]; default a tenth of the
        range.
    maximum_moves : mapping, optional
        Input name to its largest acceptable deviation from the operating point [input unit];
        default the distance to the nearer limit.
    horizon : float, optional
        [s]; default that of Bryson's rule (`designs.lqi.design_lqi`), at least 20 samples and
        four times 1/z of the slowest zero z in the right half-plane.
    moves : int, optional
        Of each input, held over blocks of growing length; default 5, or as many as make 40 of all
        inputs.

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, there are more than 40 inputs, the measurements do
        not show what has to be known, or no filter makes the loop robust.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, the
        horizon is shorter than the moves, or there are more than 40 moves of all inputs.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_mpc(cl.load("eight-tanks").linear)
    >>> controller.measurements, controller.values["feed.largest_move"] > 0
    (('level_8',), True)
    """
    process = operating_point_of(model).process
    check_ranges(process, model.outputs, model.inputs)
    check_independent(model)
    moves = _moves(moves, len(model.inputs))
    observed = observed_process(model, measurements or _shown(model))
    seen = observed.model
    deviations = acceptable_deviations(seen, maximum_errors, maximum_moves)
    usual = usual_horizon(seen, deviations.horizon)
    samples = _samples(observed, usual, horizon, moves)
    disturbed = with_disturbances(observed, samples * observed.period)
    whole = disturbed.observed
    prediction = prediction_of(whole, blocks_of(samples, moves), _rims(whole))
    parts = _Parts(model, disturbed, prediction, deviations)
    loops = SampledLoops(
        parts.controller(parts.observer(1.0)), with_outputs(model, whole.measurements)
    )
    found = slow_down(parts.observer, lambda observer: parts.trouble(observer, loops))
    controller = parts.controller(found.design)
    peak = loops.around(parts.law(found.design)).maximum_sensitivity
    names = ", ".join(signal.name for signal in whole.estimated)
    return controller.described(
        f"MPC over {time_text(samples * observed.period)} with {moves} moves of each input; "
        f"{deviations.in_words(process)}; Kalman filter for {names}; sensitivity peak {peak:.2f}.",
        _note(found),
    )


class _Parts(NamedTuple):
    """What a predictive controller is made of, but for how far its filter trusts the sensors."""

    model: LinearModel
    disturbed: Disturbed
    prediction: Prediction
    deviations: Deviations

    def observer(self, factor: float) -> TabledObserver:
        """Return the filter that takes the noise for so many times as large."""
        observed, noise = self.disturbed
        larger = noise._replace(measurement=noise.measurement * factor**2)
        gain = kalman_gain(observed.held, observed.shown, larger).gain
        tables = observed.held, observed.moved, observed.shown, gain
        return TabledObserver(observed.estimated, *map(rounded_table, tables))

    def law(self, observer: TabledObserver) -> LinearStepLaw:
        """Return the linear model of the law."""
        errors, moves = self.deviations.sizes()
        weights = MOVE_WEIGHT / (self.prediction.samples * moves) ** 2
        return unbounded_law(observer, self.prediction, errors**-2.0, weights)

    def trouble(self, observer: TabledObserver, loops: SampledLoops) -> float:
        """Return the sensitivity peak, or more where the noise moves an input too far."""
        law, signal = self.law(observer), operating_point_of(self.model).process.signal
        noise = noise_of_inputs(loops, law, self.disturbed.noise.measurement)
        spans = np.array([signal(name).span for name in self.model.inputs])
        loudest = float(np.max(noise / spans)) / INPUT_NOISE * SENSITIVITY_LIMIT
        return max(loops.around(law).maximum_sensitivity, loudest)

    def controller(self, observer: TabledObserver) -> Controller:
        """Return the controller with a filter."""
        point, observed = operating_point_of(self.model), self.disturbed.observed
        read, moved = (
            tuple(point.process.signal(name) for name in names)
            for names in (observed.measurements, self.model.inputs)
        )
        rates = _rates(self.model)
        law = predictive_law(
            read,
            moved,
            self.model.outputs,
            observer,
            self.prediction,
            rate_limited=rates is not None,
        )
        errors, moves = self.deviations.sizes()
        levels = [observed.estimated[place] for place in self.prediction.bounded]
        values = numbers_at(
            point,
            law.parameters,
            largest_error=errors,
            largest_move=moves,
            move_weight=MOVE_WEIGHT,
            rate_limit=0.0 if rates is None else rates,
            high_bound=[level.high - BELOW_RIM * level.span for level in levels],
        )
        notes = (
            note_on_sensors(observed.measurements),
            "Its model and its plan hold for a sampling period of "
            f"{observed.period:g} s and no other.",
        )
        state = numbers_at(point, law.state)
        return controller_at(point, NAME, FAMILY, law, values, state, notes=notes)


def _moves(given: int | None, inputs: int) -> int:
    """Return the moves of each input."""
    most = MOST_MOVES // inputs
    if most < 1:
        raise NotApplicable(f"it plans at most {MOST_MOVES} moves, and there are {inputs} inputs")
    usual = min(most, USUAL_MOVES)
    if given is not None and given > most:
        raise InputError(
            "moves",
            given,
            f"at most {most} moves of each of {inputs} inputs, {MOST_MOVES} in all",
            f"give {usual}",
        )
    return usual if given is None else given


def _rims(observed: ObservedProcess) -> tuple[int, ...]:
    """Return the levels that have a rim, as places among what is estimated."""
    return tuple(
        place
        for place, signal in enumerate(observed.estimated)
        if signal.part == "level" and signal.has_range
    )


def _rates(model: LinearModel) -> list[float] | None:
    """Return the largest rate of each input, None where no final element limits one."""
    process, period = operating_point_of(model).process, check_sampling_period(model)
    known = {
        name: rate for element in process.elements for name, rate in element.largest_rates().items()
    }
    if not any(name in known for name in model.inputs):
        return None
    # One without a limit takes its whole range in a sample.
    return [known.get(name, process.signal(name).span / period) for name in model.inputs]


def _shown(model: LinearModel) -> list[str]:
    """Return the controlled outputs, and the sensors that show further states which act on them."""
    states = without_idle_states(model).states
    shown = operating_point_of(model).process.measured_state
    of_outputs = {shown.get(name) for name in model.outputs}
    others = {at: name for name, at in shown.items() if at in states and at not in of_outputs}
    return [*model.outputs, *others.values()]


def _samples(observed: ObservedProcess, usual: float, horizon: float | None, moves: int) -> int:
    """Return the samples of the horizon."""
    period = observed.period
    if horizon is None:
        return min(max(ceil(usual / period), FEWEST_SAMPLES, moves), MOST_SAMPLES)
    samples = round(horizon / period)
    if not moves <= samples <= MOST_SAMPLES:
        raise InputError(
            "horizon",
            Finding(f"{horizon:g} s"),
            f"{moves * period:g} to {MOST_SAMPLES * period:g} s, {moves} to {MOST_SAMPLES} samples "
            f"of {period:g} s",
            "give a time within these, or leave it out",
        )
    return samples


def _note(found: SlowedDown[TabledObserver]) -> tuple[str, ...]:
    if found.factor == 1.0:
        return ()
    return (
        f"Its filter takes the noise of the sensors for {found.factor:.3g} times as large as it "
        "is, so that the loop is robust and the inputs are quiet.",
    )
