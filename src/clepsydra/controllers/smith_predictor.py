"""The digital Smith predictor: control of what a model without its delay predicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import called, numbered, truth
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.polynomial_controller import (
    IncrementalLoop,
    PolynomialShape,
    Read,
    joined,
    law_inputs,
    read,
)
from clepsydra.controllers.state_reading import weighted_sum
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
    shapes: Sequence[PredictorShape],
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of digital Smith predictors, loop i by measurement_i and manipulated_i.

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
    shapes : sequence of PredictorShape
        One for each loop.
    measured, manipulated : sequence of Signal, optional
        The process signals of loop 1, 2, …: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs as of a polynomial controller; its parameters, and model_gain_i = B(1),
        model_feedback_i_j = a_j, model_share_i_j = β_j, bias_i = u°, with error feedback
        error_feedback_i = κ and reference_measurement_i = y°; outputs manipulated_i, status_i.

    Raises
    ------
    InputError
        There is no loop, or the signals are not one for each loop.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, section 4; J. E. Normey-Rico, E. F. Camacho, Control of Dead-time Processes,
    Springer 2007; for κ M. R. Mataušek, A. D. Micić, IEEE Transactions on Automatic Control
    41(8), 1996, 1199-1203.

    Examples
    --------
    A model at rest, one sample at an error of 1 with r0 = 0.5:

    >>> law = smith_predictor_law([PredictorShape(PolynomialShape(0), order=1, tail=1, delay=3)])
    >>> given = dict(setpoint_1=6, measurement_1=5, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(reference_gain_1=0.5, model_gain_1=0.1, model_feedback_1_1=-0.9,
    ...               model_share_1_1=1, bias_1=3, low_limit_1=0, high_limit_1=10)
    >>> before = dict(last_output_1=3)
    >>> state, outputs, _ = law.function(
    ...     [before.get(entry.name, 0) for entry in law.state],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), dict(zip([x.name for x in law.state], map(float, state.elements())))
    (3.5, {'model_1_1': 0.05, 'delayed_model_1': 0.0, 'last_output_1': 3.5})
    """
    count = len(shapes)
    measured = signals.wired_signals("measurement", count, measured, "Smith predictor, measured")
    manipulated = signals.wired_signals(
        "output", count, manipulated, "Smith predictor, manipulated"
    )
    loops = [
        _PredictedLoop(i, *parts)
        for i, parts in enumerate(zip(shapes, measured, manipulated, strict=True), start=1)
    ]
    return step_law(
        "smith_predictor",
        inputs=law_inputs(measured, manipulated),
        parameters=[p for loop in loops for p in loop.parameters()],
        state=[s for loop in loops for s in loop.states()],
        outputs=[o for loop in loops for o in loop.controller.outputs()],
        equations=lambda symbols: joined([loop.step(symbols) for loop in loops]),
        description=_words(shapes),
    )


def _words(shapes: Sequence[PredictorShape]) -> tuple[str, ...]:
    found = [
        "Model without delay: x⁺ = −Σ a_j x(k−j+1) + B(1) (u − u°); with it ŷ = Σ β_j x(k−d−j+1); "
        "prediction ŷp = y + x − ŷ. B(1) is model_gain, a_j model_feedback, β_j model_share, u° "
        "bias.",
        "u = u(k−1) + r0 (w − ŷp) − Σ g_j ∇ŷp(k−j+1) + Σ s_j ∇w(k−j+1) − Σ p_j ∇u(k−j) within the "
        "limits, ∇ being the difference between two samples: r0 is reference_gain, g_j "
        "measurement_gain, s_j setpoint_gain, p_j increment_gain.",
    ]
    delays = ", ".join(f"{shape.delay} of loop {i}" for i, shape in enumerate(shapes, start=1))
    found.append(f"Delay d in samples: {delays}.")
    if any(shape.error_feedback for shape in shapes):
        found.append(
            "Where a model integrates, κ e joins its input, e = y − y° − ŷ: κ is error_feedback."
        )
    return tuple(found)


@dataclass(frozen=True)
class _PredictedLoop:
    number: int
    shape: PredictorShape
    measured: Signal
    moved: Signal

    @property
    def controller(self) -> IncrementalLoop:
        return IncrementalLoop(
            self.number, self.shape.controller, self.measured, self.moved, "prediction"
        )

    def parameters(self) -> list[Signal]:
        i, y, u = self.number, self.measured, self.moved
        per_input = signals.ratio_of_units(y.unit, u.unit)
        found = [
            signals.coefficient(f"model_gain_{i}", per_input, f"what {u.name} adds in a sample"),
            *(
                signals.coefficient(
                    f"model_feedback_{i}_{j}", "1", f"a{j} of the model of {y.name}"
                )
                for j in range(1, self.shape.order + 1)
            ),
            *(
                signals.coefficient(
                    f"model_share_{i}_{j}", "1", f"b{j} / B(1) of the model of {y.name}"
                )
                for j in range(1, self.shape.tail + 1)
            ),
            signals.gain(f"bias_{i}", u.unit, 0.0, f"{u.name} at the operating point"),
        ]
        if self.shape.error_feedback:
            found += [
                signals.gain(
                    f"error_feedback_{i}",
                    signals.ratio_of_units(u.unit, y.unit),
                    0.0,
                    f"what the predicted error of {y.name} adds to the model's input",
                ),
                signals.gain(
                    f"reference_measurement_{i}", y.unit, 0.0, f"{y.name} at the operating point"
                ),
            ]
        return self.controller.parameters() + found

    def states(self) -> list[Signal | DelayRing]:
        i, y = self.number, self.measured

        def of_model(name: str, when: str) -> Signal:
            return Signal(name, y.unit, description=f"model of {y.name} without delay, {when}")

        found: list[Signal | DelayRing] = [
            of_model(f"model_{i}_{j}", f"{j - 1} samples ago" if j > 1 else "now")
            for j in range(1, self.shape.order + 1)
        ]
        if self.shape.delay:
            ring = of_model(f"delayed_model_{i}", f"{self.shape.delay} samples ago")
            found.append(DelayRing(ring, self.shape.delay))
        found += [
            of_model(f"past_model_{i}_{j}", f"{self.shape.delay + j} samples ago")
            for j in range(1, self.shape.tail)
        ]
        if self.shape.error_feedback:
            found.append(
                Signal(
                    f"model_error_{i}", y.unit, description=f"last error of the model of {y.name}"
                )
            )
        return [*found, *self.controller.states()]

    def step(self, symbols: Symbols) -> Equations:
        """Predict, let the primary controller act, and move the model on."""
        i, shape = self.number, self.shape
        predictor, model = _prediction(shape), _model(shape)
        plain = read(symbols, self.controller)
        names = {f"past_{j}": f"past_model_{i}_{j}" for j in range(1, shape.tail)}
        names |= {f"model_{j}": f"model_{i}_{j}" for j in range(1, shape.order + 1)}
        names |= {f"share_{j}": f"model_share_{i}_{j}" for j in range(1, shape.tail + 1)}
        names |= {f"feedback_{j}": f"model_feedback_{i}_{j}" for j in range(1, shape.order + 1)}
        # Names of two numbers last: model_2 of loop 1 is no other loop's first.
        given = dict(numbered(symbols, (*model.inputs, *model.state), i))
        given |= {local: symbols[name] for local, name in names.items()}
        given["delayed"] = symbols[f"delayed_model_{i}" if shape.delay else f"model_{i}_1"]
        given |= {"measurement": plain.measurement, "known": plain.measurement_known}
        first = called(predictor, f"{self.measured.identifier}_prediction", given).outputs
        prediction = first["prediction"]
        named = {
            **plain.named,
            f"model_output_{i}": first["model_output"],
            f"prediction_{i}": prediction,
        }
        predicted = Read(
            prediction,
            plain.setpoint,
            ca.logic_and(plain.measurement_known, is_number(prediction)),
            plain.numbers,
            plain.sensor,
            named,
        )
        following = self.controller.step(symbols, predicted)
        given |= {**first, "manipulated": following.outputs[f"manipulated_{i}"]}
        moved = called(model, f"{self.measured.identifier}_model", given).next_state
        state = {names.get(n, f"{n}_{i}"): value for n, value in moved.items()}
        if shape.delay:
            state[f"delayed_model_{i}"] = symbols[f"model_{i}_1"]
        return Equations(
            {**following.next_state, **state}, following.outputs, following.intermediates
        )


def _row(name: str, first: int, count: int) -> list[Signal]:
    return [Signal(f"{name}_{j}") for j in range(first, count + 1)]


@cache
def _prediction(shape: PredictorShape) -> Block:
    """Return the block of what the model shows: with the delay, and without it."""
    tail = shape.tail
    return Block(
        f"smith_prediction_{tail}",
        (
            Signal("measurement"),
            Signal("model_1", description="the model without delay"),
            Signal("delayed", description="the same, a delay ago"),
            *_row("past", 1, tail - 1),
            *_row("share", 1, tail),
        ),
        (),
        (Signal("model_output"), Signal("prediction")),
        lambda s: _predicted(s, tail),
        ("The measurement, and what the model does without its delay.",),
    )


def _predicted(s: Symbols, tail: int) -> Equations:
    past = [s[f"past_{j}"] for j in range(1, tail)]
    output = weighted_sum(s, "share", [s["delayed"], *past])
    prediction = s["measurement"] + (s["model_1"] - output)
    return Equations({}, {"model_output": output, "prediction": prediction})


@cache
def _model(shape: PredictorShape) -> Block:
    """Return the block of the model without delay, moved by what was applied."""
    corrects = shape.error_feedback
    errors = ("model_output", "measurement", "error_feedback", "reference_measurement")
    return Block(
        f"smith_model_{shape.order}_{shape.tail}{'_with_error' if corrects else ''}",
        (
            Signal("manipulated", description="what stands at the actuator"),
            Signal("bias"),
            Signal("delayed", description="the model, a delay ago"),
            Signal("model_gain"),
            *_row("feedback", 1, shape.order),
            *(map(Signal, errors) if corrects else ()),
            *([truth("known", "the measurement is a number from a sound sensor")] * corrects),
        ),
        (
            *_row("model", 1, shape.order),
            *_row("past", 1, shape.tail - 1),
            *([Signal("model_error")] * corrects),
        ),
        (),
        lambda s: _model_moved(s, shape),
        ("x(k+1) = B(1) (u - u0) - a1 x(k) - a2 x(k-1) - ..., and its error where it integrates.",),
    )


def _model_moved(s: Symbols, shape: PredictorShape) -> Equations:
    model = [s[f"model_{j}"] for j in range(1, shape.order + 1)]
    past = [s["delayed"], *(s[f"past_{j}"] for j in range(1, shape.tail))]
    moved = s["manipulated"] - s["bias"]
    state = {}
    if shape.error_feedback:
        surprise = s["measurement"] - s["reference_measurement"] - s["model_output"]
        known = ca.logic_and(s["known"], is_number(surprise))
        state["model_error"] = ca.if_else(known, surprise, s["model_error"])
        moved = moved + s["error_feedback"] * state["model_error"]
    value = s["model_gain"] * moved - weighted_sum(s, "feedback", model)
    # In step with the ring, which goes on in every scan.
    goes_on = is_number(value)
    memory = {f"model_{j}": new for j, new in enumerate([value, *model[:-1]], start=1)}
    memory |= {f"past_{j}": past[j - 1] for j in range(1, shape.tail)}
    state |= {name: ca.if_else(goes_on, new, s[name]) for name, new in memory.items()}
    return Equations(state, {})
