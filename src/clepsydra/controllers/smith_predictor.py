"""The digital Smith predictor: control of what a model without its delay predicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.polynomial_controller import (
    IncrementalLoop,
    PolynomialShape,
    law_of_loops,
    products,
    row,
    shifted,
)
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import StepLaw

FAMILY = "Smith predictor"


@dataclass(frozen=True)
class PredictorShape:
    """The model of one loop, and its primary controller.

    `controller`: the primary controller, which acts on the prediction; `order`: degree of A;
    `tail`: degree of B: how many predictions of the past make the delayed output; `delay`: d
    [samples]; `error_feedback`: whether the predicted error also moves the model, which an
    integrating model needs.
    """

    controller: PolynomialShape
    order: int
    tail: int
    delay: int
    error_feedback: bool = False


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
    in manual and at a limit too. κ is zero and left out for a stable process. An integrating one
    would drift away from its model with every load; κ e estimates that load, moves the model by
    it, and leaves no offset.

    `measured`, `manipulated`: the process signals of each loop: they lend their names, units and
    ranges; `shapes`: one for each loop.

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
    loops = [
        _PredictedLoop(shape.controller, y, u, "prediction", model=shape)
        for shape, (y, u) in zip(shapes, signals.paired(measured, manipulated), strict=True)
    ]
    delays = ", ".join(f"{loop.model.delay} of {loop.measured.name}" for loop in loops)
    words = [
        "Model without delay: x⁺ = −Σ a_j x(k−j+1) + B(1) (u − u°); with it ŷ = Σ β_j x(k−d−j+1); "
        "prediction ŷp = y + x − ŷ. B(1) is model_gain, a_j model_feedback, β_j model_share, u° "
        "bias.",
        "u = u(k−1) + r0 (w − ŷp) − Σ g_j ∇ŷp(k−j+1) + Σ s_j ∇w(k−j+1) − Σ p_j ∇u(k−j) within the "
        "limits, ∇ being the difference between two samples: r0 is reference_gain, g_j "
        "measurement_gain, s_j setpoint_gain, p_j increment_gain.",
        f"Delay d in samples: {delays}.",
    ]
    if any(shape.error_feedback for shape in shapes):
        words.append(
            "Where a model integrates, κ e joins its input, e = y − y° − ŷ: κ is error_feedback."
        )
    return law_of_loops("smith_predictor", loops, *words)


@dataclass(frozen=True)
class _PredictedLoop(IncrementalLoop):
    model: PredictorShape = field(kw_only=True)

    def _past(self, part: str, when: str) -> Signal:
        words = f"model of {self.measured.name} without delay, {when}"
        return Signal(path(self.measured, part), self.measured.unit, description=words)

    def step(self, sample: Sample) -> None:
        """Predict, let the primary controller act, and move the model on."""
        y, u, s, model = self.measured, self.moved, sample.symbols, self.model
        coefficient, words = signals.coefficient, f"of the model of {y.name}"
        reading = Reading.of(sample, [y.name], [y.name])
        older = row(self._past("model", "{0} samples ago"), model.order)[1:]
        values = sample.memory(self._past("model.1", "now"), *older)
        measurement, now = reading.measurements[y.name], values[0]
        ring = self._past("delayed_model", f"{model.delay} samples ago")
        (delayed,) = sample.memory(DelayRing(ring, model.delay)) if model.delay else (now,)
        before = row(self._past("past_model", "{1} samples ago"), model.tail - 1, model.delay + 1)
        share = coefficient(path(y, "model_share"), "1", f"b{{1}} / B(1) {words}")
        sample.parameters(*row(share, model.tail))
        output = sum(products(s, share.name, [delayed, *sample.memory(*before)]), ca.SX(0))
        prediction = measurement + (now - output)
        sample.name(y, {"model_output": output, "prediction": prediction})
        known = ca.logic_and(reading.known, is_number(prediction))
        self.act(sample, replace(reading, measurements={y.name: prediction}, known=known))
        (bias,) = sample.parameters(signals.at_rest(u, "bias"))
        moved = sample.outputs[path(u, "out")] - bias
        if model.error_feedback:
            adds = f"what the predicted error of {y.name} adds to the model's input"
            gain, reference = sample.parameters(
                signals.gain(path(y, "error_feedback"), signals.per(u, y), 0.0, adds),
                signals.at_rest(y, "reference"),
            )
            last = f"last error of the model of {y.name}"
            (error,) = sample.memory(Signal(path(y, "model_error"), y.unit, description=last))
            surprise = measurement - reference - output
            error = ca.if_else(ca.logic_and(reading.known, is_number(surprise)), surprise, error)
            sample.next_state[path(y, "model_error")] = error
            moved = moved + gain * error
        feedback = coefficient(path(y, "model_feedback"), "1", f"a{{1}} {words}")
        sample.parameters(*row(feedback, model.order))
        per, adds = signals.per(y, u), f"what {u.name} adds in a sample"
        (model_gain,) = sample.parameters(coefficient(path(y, "model_gain"), per, adds))
        following = model_gain * moved - sum(products(s, feedback.name, values))
        # In step with the ring, which goes on in every scan.
        goes_on = is_number(following)
        sample.next_state |= shifted(s, path(y, "model"), model.order, following, goes_on)
        sample.next_state |= shifted(s, path(y, "past_model"), model.tail - 1, delayed, goes_on)
        if model.delay:
            sample.next_state[ring.name] = now
