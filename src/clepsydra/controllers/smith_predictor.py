"""The digital Smith predictor: control of what a model without its delay predicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import as_parts, called, parts_of, truth
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.polynomial_controller import (
    IncrementalLoop,
    PolynomialShape,
    Read,
    check_shapes,
    joined,
    law_inputs,
    read,
)
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "Smith predictor"


@dataclass(frozen=True)
class PredictorShape:
    """The model of one loop, and its primary controller.

    Parameters
    ----------
    controller : PolynomialShape
        The primary controller, which acts on the prediction.
    order : int
        Degree of A.
    tail : int
        Degree of B: how many predictions of the past make the delayed output.
    delay : int
        d [samples]
    error_feedback : bool
        Whether the predicted error also moves the model, which an integrating model needs.

    Raises
    ------
    InputError
        The model has no pole, no numerator, or a negative delay.

    Examples
    --------
    >>> PredictorShape(PolynomialShape(2), order=2, tail=2, delay=5).delay
    5
    """

    controller: PolynomialShape
    order: int
    tail: int
    delay: int
    error_feedback: bool = False

    def __post_init__(self) -> None:
        for name, value, least in (
            ("order", self.order, 1),
            ("tail", self.tail, 1),
            ("delay", self.delay, 0),
        ):
            if value < least:
                raise InputError(
                    f"Smith predictor, {name}", value, f"at least {least}", "correct the model"
                )


def smith_predictor_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    shapes: Sequence[PredictorShape],
) -> StepLaw:
    """Write the step law of digital Smith predictors, one from each measurement to an output.

    The model without delay has the gain B(1) z^-1 in the place of B, so that the primary
    controller need not invert the zeros of B; what B and the delay do is added behind it::

        x(k+1) = −a1 x(k) − a2 x(k−1) − … + B(1) (u(k) − u° + κ e(k))
        ŷ(k)   = β1 x(k−d) + β2 x(k−d−1) + …,      β = b / B(1)
        e(k)   = y(k) − y° − ŷ(k)
        prediction = y(k) + x(k) − ŷ(k)

    The primary controller acts on the prediction as a polynomial controller acts on its
    measurement (`polynomial_controller.polynomial_law`). The model gets what was really applied,
    by hand and at a limit too. κ is zero and left out for a stable process. An integrating one
    would drift away from its model with every load; κ e estimates that load, moves the model by
    it, and leaves no offset.

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The process signals of each loop: they lend their names, units and ranges.
    shapes : sequence of PredictorShape
        One for each loop.

    Returns
    -------
    StepLaw
        As of a polynomial controller, with the parameters model_gain = B(1), model_feedback.J =
        a_j and model_share.J = β_j of each measurement and bias = u° of each output, with error
        feedback also error_feedback = κ and reference = y° of the measurement.

    Raises
    ------
    InputError
        There is no loop, or the signals or shapes are not one for each loop.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, section 4; J. E. Normey-Rico, E. F. Camacho, Control of Dead-time Processes,
    Springer 2007; for κ M. R. Mataušek, A. D. Micić, IEEE Transactions on Automatic Control
    41(8), 1996, 1199-1203.

    Examples
    --------
    A model at rest, one sample at an error of 1 with r0 = 0.5:

    >>> shape = PredictorShape(PolynomialShape(0), order=1, tail=1, delay=3)
    >>> law = smith_predictor_law(["level"], ["pump"], [shape])
    >>> given = dict(sp=6, pv=5, good=1, mode=1, time_step=1)
    >>> values = {"level.reference_gain": 0.5, "level.model_gain": 0.1,
    ...           "level.model_feedback.1": -0.9, "level.model_share.1": 1, "pump.bias": 3,
    ...           "pump.low_limit": 0, "pump.high_limit": 10}
    >>> before = {"pump.last_output": 3}
    >>> state, outputs, _ = law.function(
    ...     [before.get(entry.name, 0) for entry in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), dict(zip([x.name for x in law.state], map(float, state.elements())))
    (3.5, {'level.model.1': 0.05, 'level.delayed_model': 0.0, 'pump.last_output': 3.5})
    """
    pairs = signals.paired(measured, manipulated, "Smith predictor")
    check_shapes(shapes, pairs, "Smith predictor")
    loops = [_PredictedLoop(shape, *pair) for shape, pair in zip(shapes, pairs, strict=True)]
    return step_law(
        "smith_predictor",
        inputs=law_inputs(pairs),
        parameters=[p for loop in loops for p in loop.parameters()],
        state=[s for loop in loops for s in loop.states()],
        outputs=[o for loop in loops for o in loop.controller.outputs()],
        equations=lambda symbols: joined([loop.step(symbols) for loop in loops]),
        description=_words(loops),
    )


def _words(loops: Sequence[_PredictedLoop]) -> tuple[str, ...]:
    found = [
        "Model without delay: x⁺ = −Σ a_j x(k−j+1) + B(1) (u − u°); with it ŷ = Σ β_j x(k−d−j+1); "
        "prediction ŷp = y + x − ŷ. B(1) is model_gain, a_j model_feedback, β_j model_share, u° "
        "bias.",
        "u = u(k−1) + r0 (w − ŷp) − Σ g_j ∇ŷp(k−j+1) + Σ s_j ∇w(k−j+1) − Σ p_j ∇u(k−j) within the "
        "limits, ∇ being the difference between two samples: r0 is reference_gain, g_j "
        "measurement_gain, s_j setpoint_gain, p_j increment_gain.",
    ]
    delays = ", ".join(f"{loop.shape.delay} of {loop.measured.name}" for loop in loops)
    found.append(f"Delay d in samples: {delays}.")
    if any(loop.shape.error_feedback for loop in loops):
        found.append(
            "Where a model integrates, κ e joins its input, e = y − y° − ŷ: κ is error_feedback."
        )
    return tuple(found)


@dataclass(frozen=True)
class _PredictedLoop:
    shape: PredictorShape
    measured: Signal
    moved: Signal

    @property
    def controller(self) -> IncrementalLoop:
        return IncrementalLoop(self.shape.controller, self.measured, self.moved, "prediction")

    def parameters(self) -> list[Signal]:
        y, u, shape = self.measured, self.moved, self.shape
        gain, coefficient, per = signals.gain, signals.coefficient, signals.per
        found = [
            coefficient(path(y, "model_gain"), per(y, u), f"what {u.name} adds in a sample"),
            *(
                coefficient(name, "1", f"a{j} of the model of {y.name}")
                for j, name in enumerate(elements(path(y, "model_feedback"), shape.order), start=1)
            ),
            *(
                coefficient(name, "1", f"b{j} / B(1) of the model of {y.name}")
                for j, name in enumerate(elements(path(y, "model_share"), shape.tail), start=1)
            ),
            gain(path(u, "bias"), u, 0.0, f"{u.name} at the operating point"),
        ]
        if shape.error_feedback:
            words = f"what the predicted error of {y.name} adds to the model's input"
            found += [
                gain(path(y, "error_feedback"), per(u, y), 0.0, words),
                gain(path(y, "reference"), y, 0.0, f"{y.name} at the operating point"),
            ]
        return self.controller.parameters() + found

    def states(self) -> list[Signal | DelayRing]:
        y, shape = self.measured, self.shape

        def of_model(name: str, when: str) -> Signal:
            return Signal(name, y.unit, description=f"model of {y.name} without delay, {when}")

        found: list[Signal | DelayRing] = [
            of_model(name, f"{ago} samples ago" if ago else "now")
            for ago, name in enumerate(elements(path(y, "model"), shape.order))
        ]
        if shape.delay:
            ring = of_model(path(y, "delayed_model"), f"{shape.delay} samples ago")
            found.append(DelayRing(ring, shape.delay))
        found += [
            of_model(name, f"{shape.delay + j} samples ago")
            for j, name in enumerate(elements(path(y, "past_model"), shape.tail - 1), start=1)
        ]
        if shape.error_feedback:
            words = f"last error of the model of {y.name}"
            found.append(Signal(path(y, "model_error"), y.unit, description=words))
        return [*found, *self.controller.states()]

    def step(self, symbols: Symbols) -> Equations:
        """Predict, let the primary controller act, and move the model on."""
        y, u, shape = self.measured, self.moved, self.shape
        predictor, model = _prediction(shape), _model(shape)
        plain = read(symbols, self.controller)
        ports = (*predictor.inputs, *model.inputs, *model.state)
        now, delayed = symbols[path(y, "model.1")], path(y, "delayed_model")
        given = {
            **parts_of(y, symbols, ports),
            **parts_of(u, symbols, ports),
            "delayed": symbols[delayed] if shape.delay else now,
            "measurement": plain.measurement,
            "known": plain.measurement_known,
        }
        first = called(predictor, path(y, "prediction"), given).outputs
        prediction = first["prediction"]
        predicted = Read(
            prediction,
            plain.setpoint,
            ca.logic_and(plain.measurement_known, is_number(prediction)),
            plain.numbers,
            plain.sensor,
            {**plain.named, **as_parts(y, first)},
        )
        following = self.controller.step(symbols, predicted)
        given |= {**first, "manipulated": following.outputs[path(u, "out")]}
        state = as_parts(y, called(model, path(y, "model"), given).next_state)
        if shape.delay:
            state[delayed] = now
        return Equations(
            {**following.next_state, **state}, following.outputs, following.intermediates
        )


def _row(name: str, count: int) -> list[Signal]:
    return [Signal(each) for each in elements(name, count)]


def _weighted_sum(s: Symbols, weights: str, values: Sequence[ca.SX]) -> ca.SX:
    names = elements(weights, len(values))
    first, *others = (s[name] * value for name, value in zip(names, values, strict=True))
    return sum(others, start=first)


@cache
def _prediction(shape: PredictorShape) -> Block:
    """Return the block of what the model shows: with the delay, and without it."""
    tail = shape.tail
    return Block(
        f"smith_prediction_{tail}",
        (
            Signal("measurement"),
            Signal("model.1", description="the model without delay"),
            Signal("delayed", description="the same, a delay ago"),
            *_row("past_model", tail - 1),
            *_row("model_share", tail),
        ),
        (),
        (Signal("model_output"), Signal("prediction")),
        lambda s: _predicted(s, tail),
        ("The measurement, and what the model does without its delay.",),
    )


def _predicted(s: Symbols, tail: int) -> Equations:
    past = [s[name] for name in elements("past_model", tail - 1)]
    output = _weighted_sum(s, "model_share", [s["delayed"], *past])
    prediction = s["measurement"] + (s["model.1"] - output)
    return Equations({}, {"model_output": output, "prediction": prediction})


@cache
def _model(shape: PredictorShape) -> Block:
    """Return the block of the model without delay, moved by what was applied."""
    corrects = shape.error_feedback
    errors = ("model_output", "measurement", "error_feedback", "reference")
    return Block(
        f"smith_model_{shape.order}_{shape.tail}{'_with_error' if corrects else ''}",
        (
            Signal("manipulated", description="what stands at the actuator"),
            Signal("bias"),
            Signal("delayed", description="the model, a delay ago"),
            Signal("model_gain"),
            *_row("model_feedback", shape.order),
            *(map(Signal, errors) if corrects else ()),
            *([truth("known", "the measurement is a number from a sound sensor")] * corrects),
        ),
        (
            *_row("model", shape.order),
            *_row("past_model", shape.tail - 1),
            *([Signal("model_error")] * corrects),
        ),
        (),
        lambda s: _model_moved(s, shape),
        ("x(k+1) = B(1) (u - u0) - a1 x(k) - a2 x(k-1) - ..., and its error where it integrates.",),
    )


def _model_moved(s: Symbols, shape: PredictorShape) -> Equations:
    names, past_names = elements("model", shape.order), elements("past_model", shape.tail - 1)
    model, past = [s[name] for name in names], [s["delayed"], *(s[name] for name in past_names)]
    moved = s["manipulated"] - s["bias"]
    state = {}
    if shape.error_feedback:
        surprise = s["measurement"] - s["reference"] - s["model_output"]
        known = ca.logic_and(s["known"], is_number(surprise))
        state["model_error"] = ca.if_else(known, surprise, s["model_error"])
        moved = moved + s["error_feedback"] * state["model_error"]
    value = s["model_gain"] * moved - _weighted_sum(s, "model_feedback", model)
    # In step with the ring, which goes on in every scan.
    goes_on = is_number(value)
    memory = dict(zip(names, [value, *model], strict=False))
    memory |= dict(zip(past_names, past, strict=False))
    state |= {name: ca.if_else(goes_on, new, s[name]) for name, new in memory.items()}
    return Equations(state, {})
