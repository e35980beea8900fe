"""SIMC and phase margin on tanks, against closed forms and direct frequency responses."""

import math

import numpy as np
import pytest

from clepsydra.base.errors import InputError
from clepsydra.design.applicability import NotApplicable
from clepsydra.design.detuning import detune, slowed_down
from clepsydra.design.element import Element
from clepsydra.design.loop_transfer import PiSettings, loop_transfer
from clepsydra.design.phase_margin import (
    default_crossover,
    design_phase_margin,
    margin_of,
    pi_for_margin,
)
from clepsydra.design.simc import design_simc
from clepsydra.linear.response import evaluate_transfer, frequency_response

DIRECT = [("level_1", "pump_1"), ("level_2", "pump_2")]
CROSS = [("level_1", "pump_2"), ("level_2", "pump_1")]
OMEGAS = np.logspace(-4, 0.4, 4000)


def settings_of(controller):
    return [
        (controller.values[f"proportional_gain_{i}"], controller.values[f"integral_time_{i}"])
        for i in range(1, len(controller.manipulated) + 1)
    ]


def loop_responses(model, pairing, controller, period=1.0):
    """L(jω) with the exact delay of half a period, straight from the definition."""
    selected = model.select([p[0] for p in pairing], [p[1] for p in pairing])
    responses = frequency_response(selected, OMEGAS)
    gains = np.array(
        [[k * (1 + 1 / (1j * w * t)) for k, t in settings_of(controller)] for w in OMEGAS]
    )
    return responses * gains[:, None, :] * np.exp(-0.5j * period * OMEGAS)[:, None, None]


def sensitivity_peak(loop):
    return max(np.linalg.norm(np.linalg.inv(np.eye(len(one)) + one), 2) for one in loop)


def test_loop_transfer_is_the_product_of_its_parts(minimum_phase):
    settings = [PiSettings(3.0, 30.0), PiSettings(-2.0, 8.0)]
    model = minimum_phase.model.select(["level_2", "level_1"], ["pump_1", "pump_2"])
    loop = loop_transfer(model, settings, 1.0, [10.0, 2.0])
    s = 1j * np.array([1e-3, 0.02, 0.3, 1.0])
    product = evaluate_transfer(model.A, model.B, model.C, model.D, s)
    product = (
        product * np.array([[3 * (1 + 1 / (30 * x)), -2 * (1 + 1 / (8 * x))] for x in s])[:, None]
    )
    product = product * np.exp(-0.5 * s)[:, None, None]
    product = product * np.array([10.0, 2.0]) / np.array([10.0, 2.0])[:, None]
    # The approximation of the delay is off by (ω T/2)⁵/720, that is 4e-5 at 1 rad/s.
    assert evaluate_transfer(*loop, s) == pytest.approx(product, rel=5e-5)


def test_simc_on_minimum_phase_tanks_is_the_closed_form(minimum_phase):
    tank = minimum_phase
    controller = design_simc(tank.process, tank.model, DIRECT)
    for i, (gain, integral_time) in enumerate(settings_of(controller)):
        # 3 V of room for a step of a tenth of 10 V; each element is of first order.
        assert gain == pytest.approx(3.0, rel=1e-9)
        slope = tank.direct_gains[i] / tank.T[i]
        assert integral_time == pytest.approx(4.0 / (slope * 3.0), rel=1e-9)
        assert controller.values[f"tracking_time_{i + 1}"] == integral_time
        assert controller.values[f"low_limit_{i + 1}"] == 0.0
        assert controller.values[f"high_limit_{i + 1}"] == 10.0
    assert sensitivity_peak(loop_responses(tank.model, DIRECT, controller)) < 1.2
    assert "K = 3 V/V" in controller.design


@pytest.mark.parametrize("design", [design_simc, design_phase_margin])
def test_cross_paired_loops_are_slowed_to_a_sensitivity_of_two(nonminimum_phase, design):
    tank = nonminimum_phase
    controller = design(tank.process, tank.model, CROSS)
    assert controller.manipulated == ("pump_2", "pump_1")
    peak = sensitivity_peak(loop_responses(tank.model, CROSS, controller))
    assert peak == pytest.approx(2.0, abs=2e-3)
    # Neither faster than the zero in the right half-plane allows nor asleep.
    loop = loop_responses(tank.model, CROSS, controller)
    crossovers = [OMEGAS[np.argmax(np.abs(loop[:, i, i]) < 1)] for i in range(2)]
    assert all(0.002 < crossover < 0.03 for crossover in crossovers)
    assert any("slowed down" in note or "lengthened" in note for note in controller.notes)


def test_simc_cross_elements_are_reduced_by_the_half_rule(nonminimum_phase):
    tank, closed_loop = nonminimum_phase, 300.0
    controller = design_simc(tank.process, tank.model, CROSS, closed_loop_time_constant=closed_loop)
    for i, (gain, integral_time) in enumerate(settings_of(controller)):
        long, short = sorted(tank.T[[i, i + 2]], reverse=True)
        time_constant, delay = long + short / 2, short / 2 + 0.5
        assert gain == pytest.approx(
            time_constant / tank.cross_gains[i] / (closed_loop + delay), rel=1e-9
        )
        assert integral_time == pytest.approx(
            min(time_constant, 4 * (closed_loop + delay)), rel=1e-9
        )


@pytest.mark.parametrize("degrees", [45.0, 60.0, 75.0])
@pytest.mark.parametrize("crossover", [None, 0.04])
def test_each_loop_has_exactly_its_phase_margin(minimum_phase, degrees, crossover):
    tank = minimum_phase
    controller = design_phase_margin(
        tank.process, tank.model, DIRECT, phase_margin=math.radians(degrees), crossover=crossover
    )
    selected = tank.model.select([p[0] for p in DIRECT], [p[1] for p in DIRECT])
    for i, (gain, integral_time) in enumerate(settings_of(controller)):

        def loop(w, i=i, gain=gain, integral_time=integral_time):
            g = frequency_response(selected, w)[0, i, i]
            return g * gain * (1 + 1 / (1j * w * integral_time)) * np.exp(-0.5j * w)

        low, high = 1e-4, 3.0
        for _ in range(200):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if abs(loop(middle)) > 1 else (low, middle)
        margin = 180 + math.degrees(np.angle(loop(low)))
        assert margin == pytest.approx(degrees, abs=1e-6)
        if crossover:
            assert low == pytest.approx(crossover, rel=1e-9)
        else:
            # One of the two limits on the crossover is met exactly, the other kept.
            used = [gain / 3.0, low * integral_time / 3.0]
            assert max(used) == pytest.approx(1.0, abs=1e-6)


def test_default_crossover_stops_at_an_integral_time_of_three_over_it():
    element = Element(2.0, (-0.05, -0.2), (), 0)
    crossover = default_crossover(element, 0.5, math.radians(50), 1e9)
    setting = pi_for_margin(element, 0.5, math.radians(50), crossover)
    assert crossover * setting.integral_time == pytest.approx(3.0, rel=1e-9)
    assert margin_of(element, 0.5, setting) == pytest.approx((crossover, math.radians(50)))


@pytest.mark.parametrize(
    ("crossover", "words"), [(0.001, "lag by 1.*higher"), (2.0, "lead by.*lower")]
)
def test_a_crossover_that_no_pi_can_serve_is_refused(minimum_phase, crossover, words):
    tank = minimum_phase
    with pytest.raises(NotApplicable, match=words):
        design_phase_margin(tank.process, tank.model, DIRECT, crossover=crossover)


def test_detuning_takes_the_smallest_factor(nonminimum_phase):
    model = nonminimum_phase.model.select(["level_1", "level_2"], ["pump_2", "pump_1"])
    settings = [PiSettings(3.0, 60.0), PiSettings(3.0, 60.0)]
    found = detune(lambda f: slowed_down(settings, f), model, 1.0, [10.0, 10.0], "test")
    assert found.factor > 1.5
    assert found.settings == slowed_down(settings, found.factor)

    def peak(factor):
        loop = loop_transfer(model, slowed_down(settings, factor), 1.0)
        s = 1j * np.logspace(-4, 1, 5000)
        return sensitivity_peak(evaluate_transfer(*loop, s))

    assert peak(found.factor) <= 2.0 + 1e-6
    assert peak(found.factor * 0.99) > 2.0


def test_a_pairing_that_no_slowing_down_can_save_is_not_applicable(nonminimum_phase):
    tank = nonminimum_phase
    # The diagonal pairing has negative relative gains: unstable with integral action.
    for design in (design_simc, design_phase_margin):
        with pytest.raises(NotApplicable, match="another pairing"):
            design(tank.process, tank.model, DIRECT)
    with pytest.raises(NotApplicable, match="unstable"):
        design_simc(tank.process, tank.model, DIRECT, closed_loop_time_constant=500.0)


def test_initial_state_is_rest_at_the_operating_point(minimum_phase):
    tank = minimum_phase
    for design in (design_simc, design_phase_margin):
        for anti_windup in ("back_calculation", "clamping"):
            controller = design(tank.process, tank.model, DIRECT, anti_windup=anti_windup)
            law, at = controller.law, tank.model.point.as_dict()
            given = {"time_step": 1.0}
            for i in (1, 2):
                level = at[f"level_{i}"]
                given |= {f"setpoint_{i}": level, f"measurement_{i}": level}
                given |= {f"sensor_{i}": 1.0, f"mode_{i}": 1.0}
            state = [controller.initial_state[s.name] for s in law.state]
            after, outputs, _ = law.function(
                state,
                [given.get(s.name, 0.0) for s in law.inputs],
                [controller.values[s.name] for s in law.parameters],
            )
            assert np.array(after).ravel().tolist() == state == [3.0] * 4
            assert [float(outputs[0]), float(outputs[2])] == [3.0, 3.0]


def test_an_integrating_tank_is_controlled_by_both(single_tank):
    process, model = single_tank([[0.0]], [0.02], [1.0])
    gain, integral_time = settings_of(design_simc(process, model, [("level", "pump")]))[0]
    # 5 V of room for 1 V; Ti = 4 (τc + θ) = 4/(k' K).
    assert (gain, integral_time) == (pytest.approx(5.0), pytest.approx(4 / (0.02 * 5.0)))
    controller = design_phase_margin(process, model, [("level", "pump")])
    gain, integral_time = settings_of(controller)[0]
    _, margin = margin_of(Element(0.02, (), (), 1), 0.5, PiSettings(gain, integral_time))
    assert (gain, math.degrees(margin)) == (pytest.approx(5.0), pytest.approx(60.0, abs=1e-5))


@pytest.mark.parametrize(
    ("matrices", "reason"),
    [
        (([[0.1]], [1.0], [1.0]), "unstable"),
        (([[-0.1]], [0.0], [1.0]), "pump does not move level"),
        (([[-0.2, 0.0], [0.2, -0.1]], [1.0, -1.0], [0.0, 1.0]), "zero"),
    ],
)
def test_tanks_that_no_pi_can_control_are_not_applicable(single_tank, matrices, reason):
    process, model = single_tank(*matrices)
    for design in (design_simc, design_phase_margin):
        with pytest.raises(NotApplicable, match=reason):
            design(process, model, [("level", "pump")])


def test_signals_without_a_range_are_not_applicable(single_tank):
    process, model = single_tank([[-0.1]], [1.0], [1.0], span=math.inf)
    with pytest.raises(NotApplicable, match="level has no finite range"):
        design_simc(process, model, [("level", "pump")])


@pytest.mark.parametrize(
    ("design", "pairing", "options"),
    [
        (design_simc, [], {}),
        (design_simc, [("level_9", "pump_1")], {}),
        (design_simc, [("level_1", "pump_1"), ("level_2", "pump_1")], {}),
        (design_simc, DIRECT, {"closed_loop_time_constant": 0.0}),
        (design_simc, DIRECT, {"closed_loop_time_constant": math.nan}),
        (design_phase_margin, DIRECT, {"phase_margin": 60.0}),
        (design_phase_margin, DIRECT, {"crossover": -1.0}),
        (design_phase_margin, DIRECT, {"crossover": math.inf}),
    ],
)
def test_wrong_requests_are_refused(minimum_phase, design, pairing, options):
    with pytest.raises(InputError):
        design(minimum_phase.process, minimum_phase.model, pairing, **options)
