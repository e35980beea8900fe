"""The predictor: its loop by polynomials, loads, integrating models, faults and modes."""

import math

import numpy as np
import pytest
from sampled_rig import Rig, placed
from scipy.signal import lfilter

from clepsydra.controllers.polynomial_controller import PolynomialShape
from clepsydra.controllers.smith_predictor import PredictorShape, smith_predictor_law
from clepsydra.designs.polynomial.sampled_model import SampledModel

STABLE = {
    "the document's": SampledModel((0.0309, 0.0286), (-1.777, 0.7964), 5, 1.0),
    "first order": SampledModel((0.2,), (-0.8,), 9, 1.0),
    "a part of a sample": SampledModel((0.05, 0.06, 0.01), (-1.4, 0.5), 2, 1.0),
    "no delay": SampledModel((0.05, 0.06), (-1.4, 0.5), 0, 1.0),
    "one sample": SampledModel((0.1, -0.02), (-0.9, 0.1), 1, 1.0),
}


def predictor(model, found, process=None, *, kappa=None, **options):
    shape = PredictorShape(
        PolynomialShape(len(found.Q) - 1, 0, len(found.P) - 1),
        model.order, len(model.numerator), model.delay, kappa is not None,
    )  # fmt: skip
    total = sum(model.numerator)
    values = found.values | {"level.model_gain": total, "pump.bias": 3.0}
    values |= {f"level.model_feedback.{j}": a for j, a in enumerate(model.denominator, 1)}
    values |= {f"level.model_share.{j}": b / total for j, b in enumerate(model.numerator, 1)}
    if kappa is not None:
        values |= {"level.error_feedback": kappa, "level.reference": 5.0}
    limits = options.pop("limits", {})
    process = options.pop("measured", True) and (process or model)
    law = smith_predictor_law(["level"], ["pump"], [shape])
    return Rig(law, values | limits, process or None, **options)


@pytest.mark.parametrize("name", STABLE)
def test_the_nominal_loop_has_the_poles_of_d(name):
    """With a perfect model y = z^-d B r0 / D w: the delay is out of the loop."""
    model = STABLE[name]
    found = placed(model, (0.5, 0.3), predicted=True)
    y = predictor(model, found).run(90, sp=6.0)
    B = np.concatenate([np.zeros(model.delay), model.B])
    assert y == pytest.approx(5.0 + found.feedforward * lfilter(B, found.D, np.ones(90)))


@pytest.mark.parametrize("name", STABLE)
def test_a_load_and_a_wrong_model_leave_no_offset(name):
    model = STABLE[name]
    process = SampledModel(
        tuple(1.1 * b for b in model.numerator), model.denominator, model.delay, 1.0
    )
    found = placed(model, (0.8,), predicted=True)
    y = predictor(model, found, process, load=0.4).run(400, sp=5.5)
    assert y[-1] == pytest.approx(5.5, abs=1e-6)


def test_the_law_is_the_block_diagram():
    """Fig. 5 by transfer functions, on a record of measurements that no model explains."""
    model = STABLE["the document's"]
    found = placed(model, (0.5,), predicted=True)
    rig = predictor(model, found, measured=False)
    random = np.random.default_rng(2)
    y = 5.0 + random.normal(size=60)
    u = np.array([rig.scan(pv=value, sp=5.5) for value in y])
    deviation = u - 3.0
    ahead = lfilter([0.0, sum(model.B)], model.A, deviation)
    late = np.concatenate([np.zeros(5), lfilter(model.B, model.A, deviation)])[:60]
    predicted = y - 5.0 + ahead - late
    right = found.feedforward * 0.5 - lfilter(found.Q, [1.0], predicted)
    assert deviation == pytest.approx(np.cumsum(right), abs=1e-9)


def integrating():
    return SampledModel((0.06, 0.05), (-1.6, 0.6), 6, 1.0)


def test_a_plain_predictor_keeps_an_offset_where_the_model_integrates():
    """In theory by load × B(1)/A'(1) × (d + mean age of B − 1), A' = A without integrator."""
    model = integrating()
    found = placed(model, (0.5,), predicted=True)
    load = 0.2
    y = predictor(model, found, load=load).run(600)
    # The level that is still to come from what was moved, for a move of −load.
    late = np.concatenate([np.zeros(6), model.B])
    ahead = np.array([0.0, sum(model.B)])
    gap = np.polyval(np.polyder(ahead[::-1]), 1.0) - np.polyval(np.polyder(late[::-1]), 1.0)
    rest = np.sum(np.polydiv(model.A, [1.0, -1.0])[0])
    offset = -load * gap / rest
    assert abs(offset) > 0.1
    assert y[-1] - 5.0 == pytest.approx(offset, rel=1e-6)


def test_error_feedback_takes_the_offset_away_and_changes_nothing_else():
    model = integrating()
    found = placed(model, (0.6,), predicted=True)
    kappa = 0.1
    nominal = predictor(model, found, kappa=kappa).run(90, sp=6.0)
    B = np.concatenate([np.zeros(6), model.B])
    assert nominal == pytest.approx(
        5.0 + found.feedforward * lfilter(B, found.D, np.ones(90)), abs=1e-9
    )
    loaded = predictor(model, found, kappa=kappa, load=0.2)
    y = loaded.run(800)
    assert y[-1] == pytest.approx(5.0, abs=1e-7)
    # κ e is the load, as it reached the process.
    assert kappa * loaded.state["level.model_error"] == pytest.approx(0.2, rel=1e-6)


@pytest.mark.parametrize("mode", [0.0, 2.0])
def test_the_model_follows_what_was_moved_by_hand(mode):
    """After a change by hand the prediction is right, so that automatic starts without a bump."""
    model = STABLE["the document's"]
    found = placed(model, (0.9,), predicted=True)
    rig = predictor(model, found)
    rig.run(20)
    rig.run(200, mode=mode, manual=3.3, tracking=3.3)
    level = rig.y[-1]
    assert level == pytest.approx(5.0 + 0.3 * model.static_gain, abs=1e-9)
    rig.scan(mode=1.0, sp=level)
    assert rig.u[-1] == pytest.approx(3.3, abs=1e-9)
    assert rig.run(60)[-1] == pytest.approx(level, abs=1e-9)


def test_at_a_limit_the_model_gets_what_was_applied():
    model = STABLE["the document's"]
    found = placed(model, (0.5,), predicted=True)
    rig = predictor(model, found, limits={"pump.low_limit": 2.9, "pump.high_limit": 3.1})
    rig.run(300, sp=9.0)
    assert rig.u[-1] == 3.1
    assert rig.y[-1] == pytest.approx(5.0 + 0.1 * model.static_gain, abs=1e-9)
    rig.run(6, sp=4.0)
    assert rig.u[-1] < 3.1


@pytest.mark.parametrize("fault", [{"pv": math.nan}, {"good": 0.0}])
@pytest.mark.parametrize("kappa", [None, 0.1])
def test_a_fault_holds_the_output_and_the_model_goes_on(fault, kappa):
    model = integrating() if kappa else STABLE["the document's"]
    found = placed(model, (0.9,), predicted=True)
    rig, twin = (predictor(model, found, kappa=kappa) for _ in range(2))
    rig.run(8, sp=5.4), twin.run(8, sp=5.4)
    held = rig.u[-1]
    process, rig.model = rig.model, None
    for _ in range(5):
        rig.model = process
        seen = 5.0 + rig.deviation()
        rig.model = None
        assert rig.scan(**{"pv": seen, **fault}) == held
        rig.y[-1] = seen
        assert rig.status & (16 if "good" in fault else 32)
    rig.model = process
    # The model was moved like the process: its error after the fault is none.
    rig.scan(good=1.0)
    assert all(math.isfinite(value) for value in rig.state.values())
    if kappa:
        assert abs(rig.state["level.model_error"]) < 1e-12
    assert rig.run(300)[-1] == pytest.approx(5.4, abs=1e-6)


def test_a_scan_that_is_no_sample_moves_model_and_ring_alike():
    """Both count scans, so that they stay in step with one another."""
    model = STABLE["first order"]
    found = placed(model, (0.8,), predicted=True)
    rig = predictor(model, found)
    rig.run(10, sp=5.5)
    for _ in range(4):
        rig.scan(time_step=0.0)
    assert rig.status & 64
    rig.scan(time_step=1.0)
    assert rig.run(200)[-1] == pytest.approx(5.5, abs=1e-9)


def test_model_parameters_that_run_over_leave_numbers():
    model = STABLE["first order"]
    found = placed(model, (0.5,), predicted=True)
    rig = predictor(model, found, limits={"pump.low_limit": 0.0, "pump.high_limit": 10.0})
    rig.values["level.model_feedback.1"] = -1e200
    rig.run(20, sp=6.0)
    assert all(math.isfinite(value) for value in rig.state.values())
    assert 0.0 <= rig.u[-1] <= 10.0
