"""The step law of model predictive control with a linear model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import declare_output, final_element
from clepsydra.controllers.blocks.matrix import column
from clepsydra.controllers.blocks.ports import Asked
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import (
    LARGEST_COUNT,
    all_of,
    is_number,
    time_step_of,
)
from clepsydra.controllers.observers.state_source import StateSource
from clepsydra.controllers.predictive.prediction import Prediction, TabledObserver
from clepsydra.program.routines.current_observer import corrected, predicted
from clepsydra.program.routines.predictive_plan import Request, bounded_plan, linear_plan
from clepsydra.program.step_law import StepLaw

FAMILY = "model predictive control"
#: A plan counts where no more than this is left of the conditions of an optimum.
LARGEST_RESIDUAL = 1e-4
_DESCRIPTION = (
    "u is the last output and the first of the moves over the horizon that make least the squares "
    "of the errors over largest_error and, with move_weight, those of the moves over largest_move.",
    "A linear law finds them; where it would overstep a limit, a rate or a high_bound, a quadratic "
    "program does. The states and as many loads as there are measurements are estimated.",
)
HIGH_BOUND = Key("high_bound", "{x}", "what {x} should not rise above", like="x")
_AT_REST = Key("reference", "{x}", "{x} at the operating point", like="x")
_ESTIMATE = Key("estimate", "{x}", "expected deviation of {x} from the operating point")
_UNSOLVED = "unsolved"
_WEIGHT = signals.amount("move_weight", "1", "weight of moves beside errors", 1.0)


def predictive_law(
    measured: Sequence[Signal],
    manipulated: Sequence[Signal],
    controlled: Sequence[str],
    observer: TabledObserver,
    prediction: Prediction,
    *,
    rate_limited: bool = False,
) -> StepLaw:
    """Write the step law of linear model predictive control.

    In automatic, from the estimated deviations x̂ of states and disturbances, the setpoints and
    the inputs that stood in the last sample, it looks for the moves v that make least

        Σ_k Σ_j (e_j(k)/ē_j)² + ρ Σ_b Σ_i (Δv_i(b)/(T ū_i))²

    over the T samples of the horizon, with ē the largest acceptable errors and ū the largest
    acceptable moves, and applies the first. The disturbances integrate, as many as there are
    measurements, so that no offset stays.

    The linear law comes first. Only where its plan oversteps a limit of an input, its rate, or the
    bound of a level, a quadratic program is solved (`program.routines.predictive_plan`), so that
    at rest the margins are those of a linear law. The bounds of levels are soft: there always is
    a plan. Where none is found, the linear law within the limits stands in for it,
    and `unsolved` counts the sample.

    An input in manual or tracking stays, in the plan, where it is, so that the others make up for
    it. A fault of any sensor holds all outputs that are in automatic, and the observer goes on
    with what is held.

    `measured`, `manipulated`: the process signals; `controlled`: the measurements that have
    setpoints; `prediction`: over the horizon, with the levels that have a bound; `rate_limited`:
    whether inputs have a largest rate.

    References
    ----------
    J. B. Rawlings, D. Q. Mayne and M. M. Diehl, Model Predictive Control, 2nd ed., Nob Hill 2017,
    chapter 1. G. Pannocchia and J. B. Rawlings, Disturbance models for offset-free
    model-predictive control, AIChE Journal 49(2), 2003, 426-437, doi 10.1002/aic.690490213.
    """
    source = _Source(measured, manipulated, controlled, observer)
    bounded = [observer.estimated[place] for place in prediction.bounded]
    tables = prediction.tables(bounded)

    def applied(sample: Sample, reading: Reading, known: Sequence[ca.SX]) -> list[ca.SX]:
        for u in source.manipulated:
            declare_output(sample, u, rate_limited=rate_limited)
            sample.parameters(signals.at_rest(u, "bias"))
        asked = _request(sample, reading, source, prediction, bounded, known, rate_limited)
        line = linear_plan(tables, asked)
        over = ca.logic_and(reading.known, line.excess > 0)
        plan = bounded_plan(tables, asked, over)
        numbers = map(is_number, ca.vertsplit(plan.moves))
        found = all_of([plan.residual <= LARGEST_RESIDUAL, *numbers])
        _count(sample, ca.logic_and(over, ca.logic_not(found)))
        sample.named |= {"oversteps": over, "plan_found": found}
        moves = ca.if_else(ca.logic_and(over, found), plan.moves, line.moves)
        outputs = []
        for u, move in zip(source.manipulated, ca.vertsplit(moves), strict=False):
            value = sample[path(u, "last_output")] + move
            wish = Asked(value, reading.known, reading.numbers, reading.sensors)
            outputs.append(final_element(sample, u, wish, rate_limited=rate_limited).applied)
        return outputs

    law = source.law("predictive", applied, _DESCRIPTION)
    return replace(law, unsolved=_UNSOLVED)


class _Source(StateSource):
    """States and disturbances as an observer estimates them."""

    from_rest = True

    def __init__(
        self,
        measured: Sequence[Signal],
        manipulated: Sequence[Signal],
        controlled: Sequence[str],
        observer: TabledObserver,
    ) -> None:
        known = {signal.name: signal for signal in measured}
        controlled_signals = [known[name] for name in controlled]
        super().__init__(measured, controlled_signals, manipulated, observer.estimated)
        self.observer = observer

    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the estimated deviations from the operating point."""
        at_rest = sample.parameters(*(signals.at_rest(y, "reference") for y in self.measured))
        shown = ca.vertcat(*reading.measurements.values()) - ca.vertcat(*at_rest)
        expected = sample.memory(*(_ESTIMATE.of(x, x=x) for x in self.observer.estimated))
        tables = ca.DM(self.observer.observation), ca.DM(self.observer.correction)
        return ca.vertsplit(corrected(ca.vertcat(*expected), shown, reading.known, *tables))

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the next estimate, under the inputs that were applied."""
        moves = ca.vertcat(*applied) - column(sample.symbols, "bias", self.manipulated)
        tables = ca.DM(self.observer.transition), ca.DM(self.observer.input_effect)
        following = ca.vertsplit(predicted(ca.vertcat(*known), moves, *tables))
        for x, value in zip(self.observer.estimated, following, strict=True):
            before = sample[path(x, "estimate")]
            sample.next_state[path(x, "estimate")] = ca.if_else(is_number(value), value, before)


def _request(
    sample: Sample,
    reading: Reading,
    source: _Source,
    prediction: Prediction,
    bounded: Sequence[Signal],
    known: Sequence[ca.SX],
    rate_limited: bool,
) -> Request:
    """Return what is asked of the plan."""
    last, low, high, at_rest = (
        column(sample.symbols, part, source.manipulated)
        for part in ("last_output", "low_limit", "high_limit", "bias")
    )
    free = ca.vertcat(*(sample[path(u, "mode")] == Mode.AUTOMATIC for u in source.manipulated))
    wishes = [reading.setpoints[y.name] - sample[path(y, "reference")] for y in source.controlled]
    errors, moves = (
        ca.vertcat(
            *sample.parameters(
                *signals.growing(
                    (signals.size(path(x, part), x, f"{words} {x.name}") for x in of), power
                )
            )
        )
        for part, of, words, power in (
            ("largest_error", source.controlled, "largest acceptable error of", -1.0),
            ("largest_move", source.manipulated, "largest acceptable move of", 1.0),
        )
    )
    (weight,) = sample.parameters(_WEIGHT.of(""))
    rise = ca.SX(0, 1)
    if rate_limited:
        time, _ = time_step_of(sample.symbols)
        rise = time * column(sample.symbols, "rate_limit", source.manipulated)
    above = []
    for level in bounded:
        bound, rest = sample.parameters(HIGH_BOUND.of(level, level.high, x=level),
                                        _AT_REST.of(level, 0.0, x=level))  # fmt: skip
        above.append(bound - rest)
    # An input that does not move may stand beyond limits that were changed.
    up, down = (ca.if_else(free, room, ca.fmax(room, 0)) for room in (high - last, last - low))
    state = ca.vertcat(*known, *wishes, last - at_rest)
    scaled = weight / (prediction.samples * moves) ** 2
    return Request(
        1 / errors**2, scaled, free, state, up, down, rise, ca.vertcat(ca.SX(0, 1), *above)
    )


def _count(sample: Sample, failed: ca.SX) -> None:
    """Count the samples in which no plan was found."""
    words = "samples in which no plan was found, and the linear law within its limits stood in"
    (before,) = sample.memory(Signal(_UNSOLVED, low=0.0, high=LARGEST_COUNT, description=words))
    sample.next_state[_UNSOLVED] = ca.fmin(before + failed, LARGEST_COUNT)
