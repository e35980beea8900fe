"""The law in increments: its equation, its limits, its changes of mode, its faults."""

import math

import numpy as np
import pytest
from sampled_rig import Rig, placed
from scipy.signal import lfilter

from clepsydra.controllers.polynomial_controller import PolynomialShape, polynomial_law
from clepsydra.designs.polynomial.sampled_model import SampledModel

PLANT = SampledModel((0.05, 0.04), (-1.5, 0.55), 3, 1.0)


FOUND = placed(PLANT, (0.5, 0.4))


def rig(**options):
    shape = PolynomialShape(len(FOUND.Q) - 1, 0, len(FOUND.P) - 1)
    law = polynomial_law(["level"], ["pump"], [shape])
    values = FOUND.values | options.pop("limits", {})
    return Rig(law, values, options.pop("model", PLANT), **options)


def test_the_loop_is_that_of_the_polynomials():
    """y = z^-d B r0 / D w: the Diophantine equation makes D the only denominator."""
    loop = rig()
    y = loop.run(80, sp=6.0)
    w = np.ones(80)
    B = np.concatenate([np.zeros(3), PLANT.B])
    expected = 5.0 + FOUND.feedforward * lfilter(B, FOUND.D, w)
    assert y == pytest.approx(expected, abs=1e-9)


def test_a_load_leaves_no_offset():
    assert rig(load=0.7).run(150)[-1] == pytest.approx(5.0, abs=1e-9)


def test_the_polynomial_form_of_the_law():
    """u from (25) as a difference equation: P (1 − z^-1) u = r0 w − Q y, on any record."""
    random = np.random.default_rng(1)
    y, w = 5.0 + random.normal(size=60), np.repeat(random.uniform(4, 6, 6), 10)
    loop = rig(model=None)
    u = np.array([loop.scan(pv=a, sp=b) for a, b in zip(y, w, strict=True)])
    P = np.convolve(FOUND.P, [1.0, -1.0])
    # All were at rest before: deviations from there, the absolute parts cancel as Q(1) = r0.
    right = FOUND.feedforward * (w - 5.0) - lfilter(FOUND.Q, [1.0], y - 5.0)
    assert u - 3.0 == pytest.approx(lfilter([1.0], P, right), abs=1e-8)


def test_the_output_leaves_its_limit_at_once():
    loop = rig(limits={"pump.high_limit": 3.2, "pump.low_limit": 2.0}, load=-2.0)
    loop.run(200, sp=6.0)  # out of reach
    assert loop.u[-1] == 3.2 and loop.status & 8
    assert loop.y[-1] < 5.5
    loop.run(2, sp=1.0)
    assert loop.u[-1] < 3.2


@pytest.mark.parametrize("mode", [0.0, 2.0])
def test_automatic_goes_on_from_manual_and_tracking(mode):
    """Where the level rests there is no move but that of the error in the first sample."""
    loop = rig(model=None)
    loop.scan(sp=6.0, pv=5.5)
    for k in range(12):
        value = 7.0 - 0.3 * min(k, 5)
        assert loop.scan(mode=mode, manual=value, tracking=value, pv=5.2) == value
    last = loop.u[-1]
    first = loop.scan(mode=1.0)
    # What was moved by hand in the last samples counts, as it is still on its way.
    assert first - last == pytest.approx(FOUND.values["level.reference_gain"] * 0.8, abs=1e-12)


@pytest.mark.parametrize(
    "fault", [{"pv": math.nan}, {"pv": 1e301}, {"good": 0.0},
              {"sp": math.inf}, {"time_step": 0.0}, {"time_step": math.nan},
              {"mode": 3.0}],
)  # fmt: skip
def test_a_fault_holds_and_leaves_no_trace(fault):
    loop, twin = rig(model=None), rig(model=None)
    good = {"good": 1.0, "time_step": 1.0, "mode": 1.0}
    random = np.random.default_rng(5)
    for k, (y, w) in enumerate(random.uniform(4.5, 5.5, (30, 2))):
        values = good | {"pv": y, "sp": w}
        assert loop.scan(**values) == twin.scan(**values)
        if k % 7 == 3:
            held = loop.u[-1]
            for _ in range(3):
                assert loop.scan(**values | fault) == held
            expected = 64 if "time_step" in fault else 16 if "good" in fault else 32
            assert loop.status & expected


def test_a_gain_that_is_no_number_holds_the_output():
    loop = rig(model=None)
    loop.scan(sp=6.0)
    held = loop.u[-1]
    loop.values["level.reference_gain"] = math.nan
    assert loop.scan() == held and loop.scan(pv=4.0) == held


def test_gains_change_without_a_bump():
    """New gains act on what moves from now on: the error, never the level itself."""
    loop = rig(model=None)
    for _ in range(10):
        loop.scan(sp=5.0, pv=5.0)
    loop.values |= {name: 10.0 * v for name, v in loop.values.items() if "_gain" in name}
    assert loop.scan() == loop.u[-2]


def test_a_pi_controller_is_one_of_them():
    """K (b ∇w − ∇y) + K T/Ti (w − y), the velocity form."""
    K, Ti, b = 1.3, 8.0, 0.4
    law = polynomial_law(["level"], ["pump"], [PolynomialShape(1, 1)])
    gains = {"reference_gain": K / Ti, "measurement_gain.1": K, "setpoint_gain.1": K * b}
    loop = Rig(law, {f"level.{name}": gain for name, gain in gains.items()})
    random = np.random.default_rng(7)
    u, last = 3.0, (5.0, 5.0)
    for y, w in random.uniform(4.0, 6.0, (40, 2)):
        u += K * (b * (w - last[1]) - (y - last[0])) + K / Ti * (w - y)
        last = y, w
        assert loop.scan(pv=y, sp=w) == pytest.approx(u, abs=1e-12)
