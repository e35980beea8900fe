"""The analysis as a whole: what it says, and that it is valid JSON."""

from __future__ import annotations

import json
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from clepsydra import NoEquilibrium
from clepsydra.linear.analysis import analyse


def strict(value):
    """Write and read as JSON without the extensions for infinity and not-a-number."""
    return json.loads(json.dumps(value, allow_nan=False))


def torricelli(level):
    return 0.1 * ca.sqrt(ca.fmax(level, 0))


@pytest.mark.thorough
def test_both_phases(johansson):
    found = strict(analyse(johansson.process).as_dict())
    levels = johansson.levels(johansson.voltage)
    assert found["operating_point"]["tank_3.level"] == pytest.approx(levels[2], rel=1e-9)
    assert found["operating_point"]["pump_1"] == johansson.voltage[0]
    A, B, C = johansson.matrices(levels)
    np.testing.assert_allclose(found["A"], A, rtol=1e-9)
    np.testing.assert_allclose(found["B"], B, rtol=1e-9)
    np.testing.assert_allclose(found["C"], C[:2], rtol=1e-9)
    for key, expected in (
        ("zeros", johansson.zeros(levels)),
        ("poles", -1 / np.sort(johansson.time_constants(levels))[::-1]),
    ):
        np.testing.assert_allclose([root["re"] for root in found[key]], expected, rtol=1e-9)
        assert all(root["im"] == 0.0 for root in found[key])
    assert found["rga"][0][0] == pytest.approx(johansson.relative_gain, rel=1e-9)
    assert found["units"]["tank_1.level"] == "m"
    assert found["units"]["level_1"] == "V"
    assert found["outputs"] == ["level_1", "level_2"]


def test_words_on_the_minimum_phase(minimum):
    analysis = analyse(minimum.process)
    text = " ".join(analysis.words)
    assert analysis.minimum_phase
    assert "the process is minimum phase" in text
    assert "Pair level_1 with pump_1 (relative gain 1.40)" in text
    assert analysis.niederlinski_index == pytest.approx(0.3 / 0.42, rel=1e-9)


def test_words_on_the_nonminimum_phase(nonminimum):
    analysis = analyse(nonminimum.process)
    text = " ".join(analysis.words)
    zero = nonminimum.zeros(nonminimum.levels(nonminimum.voltage))[0]
    assert not analysis.minimum_phase
    assert f"The zero at +{zero:.3g} rad/s in the right half-plane" in text
    assert f"bandwidth of about {zero / 2:.2g} rad/s" in text
    assert "feedback linearisation" in text
    assert analysis.pairing == (("level_1", "pump_2"), ("level_2", "pump_1"))


def test_the_operating_point_follows_the_request(minimum):
    levels = minimum.levels((2.5, 3.2))
    analysis = analyse(
        minimum.process, outputs={"level_1": 50 * levels[0], "level_2": 50 * levels[1]}
    )
    np.testing.assert_allclose(analysis.operating_point.inputs, (2.5, 3.2), rtol=1e-12)
    with pytest.raises(NoEquilibrium, match=r"tank_1\.level would stand at"):
        analyse(minimum.process, inputs={"pump_1": 9.0})


def test_an_integrating_tank(make_process):
    process = make_process(lambda x, u, d: [0.01 * (u[0] - 5)], levels=1, pumps=1)
    analysis = analyse(process)
    found = strict(analysis.as_dict())
    assert found["time_constants"] == [None]
    assert found["static_gain"] == [["inf"]]
    assert found["rga"] == [[pytest.approx(1.0)]]
    assert found["niederlinski_index"] is None
    assert found["pairing"] == [["level_1", "pump_1"]]
    assert found["minimum_phase"] is True
    text = " ".join(analysis.words)
    assert "The process integrates (1 pole at the origin)" in text
    assert "level_1 integrates pump_1" in text


def test_an_undamped_oscillation_is_no_integrator(make_process):
    # ẍ = -4 x + u about x = 0.5: poles at ±2j.
    process = make_process(
        lambda x, u, d: [2 * (x[1] - 0.5), -2 * (x[0] - 0.5) + 0.1 * (u[0] - 5)], levels=2, pumps=1
    )
    analysis = analyse(process)
    np.testing.assert_allclose(analysis.poles, [2j, -2j], atol=1e-12)
    text = " ".join(analysis.words)
    assert "oscillates without damping at 2 rad/s (a period of 3.14 s)" in text
    assert "integrates" not in text
    assert "every level settles" not in text


@pytest.mark.thorough
def test_outputs_that_cannot_be_set_independently(minimum):
    # γ1 + γ2 = 1: the static gain is singular, and a zero stands at the origin.
    plant = replace(minimum, gamma=(0.5, 0.5), gain=(3.3e-6, 3.3e-6))
    analysis = analyse(plant.process)
    found = strict(analysis.as_dict())
    assert found["rga"] is None
    assert found["pairing"] == []
    assert found["minimum_phase"] is False
    assert found["zeros"][0]["re"] == pytest.approx(0.0, abs=1e-15)
    text = " ".join(analysis.words)
    assert "level_1, level_2 cannot be set independently by pump_1, pump_2" in text
    assert "A zero stands at the origin" in text


@pytest.mark.thorough
def test_an_unstable_process(make_process):
    process = make_process(lambda x, u, d: [0.5 * x[0] - 0.1 * u[0]], levels=1, pumps=1)
    analysis = analyse(process, inputs={"pump_1": 2.0})
    assert analysis.operating_point.state[0] == pytest.approx(0.4)
    assert analysis.words[0].startswith("The process is unstable: the pole at +0.500 rad/s")
    assert strict(analysis.as_dict())["time_constants"] == [-2.0]


def test_two_pumps_into_one_tank_with_two_sensors(make_process):
    process = make_process(
        lambda x, u, d: [0.01 * (u[0] + u[1]) - torricelli(x[0])],
        levels=1,
        pumps=2,
        measure=lambda x: [x[0], 2 * x[0]],
    )
    analysis = analyse(process, inputs={"pump_1": 2.0, "pump_2": 2.0})
    assert not analysis.minimum_phase
    assert "some combination of the outputs answers to no input" in " ".join(analysis.words)


def test_a_pair_of_zeros_on_the_imaginary_axis_is_named(make_process):
    # ẏ + … = (s² + 4)/(s + 1)³ as a chain; its states are pushed off their floors by a constant.
    process = make_process(
        lambda x, u, d: [
            0.1 * u[0] - 3 * x[0] - 3 * x[1] - x[2] + 1.0,
            x[0] - 0.1,
            x[1] - 0.1,
        ],
        levels=3,
        pumps=1,
        measure=lambda x: [x[0] + 4 * x[2]],
    )
    analysis = analyse(process, inputs={"pump_1": 1.0})
    np.testing.assert_allclose(np.sort(analysis.zeros.imag), [-2, 2], rtol=1e-9)
    assert "The zeros at ±2.00j rad/s stand on the imaginary axis" in " ".join(analysis.words)
