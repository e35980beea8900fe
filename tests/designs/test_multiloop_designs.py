"""SIMC and phase margin on tanks, against closed forms and direct frequency responses."""

import dataclasses
import functools
import math
import re

import numpy as np
import pytest
from refusals import refused
from scipy.signal import cont2discrete

import clepsydra as cl
from clepsydra import InputError, NotApplicable, PidForm
from clepsydra.designs.amigo import design_amigo
from clepsydra.designs.fuzzy_control import design_fuzzy_pi
from clepsydra.designs.glover_mcfarlane import design_glover_mcfarlane
from clepsydra.designs.lambda_tuning import design_lambda
from clepsydra.designs.loops.margin_settings import margin_of, pi_for_margin, pid_for_margin
from clepsydra.designs.loops.multiloop import MultiloopPid
from clepsydra.designs.loops.pid_settings import PidSettings, slowed_down
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.phase_margin import default_crossover, design_phase_margin
from clepsydra.designs.polynomial_control import design_polynomial
from clepsydra.designs.simc import design_simc
from clepsydra.designs.slowing_down import OF_LOOPS, slow_down
from clepsydra.designs.tyreus_luyben import design_tyreus_luyben
from clepsydra.designs.variable_structure_pid import design_variable_structure_pid
from clepsydra.designs.ziegler_nichols import design_ziegler_nichols
from clepsydra.linear.response import evaluate_transfer, frequency_response

DIRECT = [("level_1", "pump_1"), ("level_2", "pump_2")]
CROSS = [("level_1", "pump_2"), ("level_2", "pump_1")]


@functools.cache
def analysed(name):
    return cl.load(name).analysis


def settings_of(controller):
    return [
        tuple(
            controller.values[f"{level}.{name}"] for name in ("proportional_gain", "integral_time")
        )
        for level in controller.setpoints
    ]


def sampled_peak(model, pairing, controller, period=1.0):
    """Return max |S| by brute force, straight from the definition of the sampled loops.

    G(z) is the process held over a period, by SciPy, and K(z) = K (1 + Δt/(Ti (z − 1))).
    """
    selected = model.select([p[0] for p in pairing], [p[1] for p in pairing])
    A, B, C, D, _ = cont2discrete((selected.A, selected.B, selected.C, selected.D), period)
    closed = np.block(
        [
            [A - B @ np.diag([k for k, _ in settings_of(controller)]) @ C, B],
            [-np.diag([k * period / t for k, t in settings_of(controller)]) @ C, np.eye(len(C))],
        ]
    )
    if np.abs(np.linalg.eigvals(closed)).max() >= 1.0:
        return math.inf
    z = np.exp(1j * np.concatenate([np.geomspace(1e-5, np.pi, 6000), [np.pi]]))
    process = evaluate_transfer(A, B, C, D, z)
    gains = np.stack([k * (1 + period / (t * (z - 1))) for k, t in settings_of(controller)], axis=1)
    loops = np.eye(len(C)) + process * gains[:, None, :]
    return 1.0 / np.linalg.svd(loops, compute_uv=False)[:, -1].min()


def test_simc_on_minimum_phase_tanks_is_the_closed_form(minimum_phase):
    tank = minimum_phase
    controller = design_simc(tank.model, DIRECT)
    for i, (gain, integral_time) in enumerate(settings_of(controller)):
        # 3 V of room for a step of a tenth of 10 V; each element is of first order.
        assert gain == pytest.approx(3.0, rel=1e-9)
        slope = tank.direct_gains[i] / tank.T[i]
        assert integral_time == pytest.approx(4.0 / (slope * 3.0), rel=1e-9)
        assert controller.values[f"level_{i + 1}.tracking_time"] == integral_time
        assert controller.values[f"pump_{i + 1}.low_limit"] == 0.0
        assert controller.values[f"pump_{i + 1}.high_limit"] == 10.0
    assert sampled_peak(tank.model, DIRECT, controller) < 1.2
    assert "K = 3 %/%" in controller.design


@pytest.mark.parametrize("period", [1.0, 10.0, 300.0, 1000.0])
@pytest.mark.parametrize("design", [design_simc, design_phase_margin])
def test_cross_paired_loops_are_slowed_to_a_sensitivity_of_two(
    nonminimum_phase, design, period, sampled_at
):
    model = sampled_at(nonminimum_phase.model, period)
    controller = design(model, CROSS)
    assert controller.manipulated == ("pump_2", "pump_1")
    # The search ends a share of 1e-5 below the limit, where rounding a gain moves the peak less.
    assert sampled_peak(model, CROSS, controller, period) == pytest.approx(2.0, abs=3e-5)
    assert "sensitivity peak of all loops together 2.00" in controller.design
    assert any("slowed down" in note or "lengthened" in note for note in controller.notes)


@pytest.mark.sampled
@pytest.mark.parametrize("period", [10.0, 30.0, 60.0, 100.0, 1000.0])
@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
@pytest.mark.parametrize("design", [design_simc, design_phase_margin])
def test_the_peak_that_a_design_names_is_that_of_the_sampled_loops(
    phase, design, period, sampled_at, request
):
    model = sampled_at(request.getfixturevalue(phase).model, period)
    pairing = DIRECT if phase == "minimum_phase" else CROSS
    controller = design(model, pairing)
    peak = sampled_peak(model, pairing, controller, period)
    assert peak <= 2.0
    said = re.search(r"sensitivity peak of all loops together ([\d.]+)\.$", controller.design)
    assert float(said[1]) == pytest.approx(peak, abs=0.00501)


def test_given_settings_are_judged_by_the_sampled_loops(minimum_phase, sampled_at):
    """What is mild at a period of 30 s does not bear one of 300 s."""
    model, given = sampled_at(minimum_phase.model, 30.0), {"closed_loop_time_constant": 100.0}
    peak = sampled_peak(model, DIRECT, design_simc(model, DIRECT, **given), 30.0)
    assert 1.1 < peak < 1.3
    assert f"together {peak:.2f}" in design_simc(model, DIRECT, **given).design
    with pytest.raises(NotApplicable, match="unstable at a closed-loop time constant of 100 s"):
        design_simc(sampled_at(minimum_phase.model, 300.0), DIRECT, **given)


def test_simc_cross_elements_are_reduced_by_the_half_rule(nonminimum_phase):
    tank, closed_loop = nonminimum_phase, 300.0
    controller = design_simc(tank.model, CROSS, closed_loop_time_constant=closed_loop)
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
        tank.model, DIRECT, phase_margin=math.radians(degrees), crossover=crossover
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
    element = TransferElement(2.0, (-0.05, -0.2), (), 0)
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
        design_phase_margin(tank.model, DIRECT, form=PidForm("PI"), crossover=crossover)


def found_margin(element, delay, setting, crossover):
    """Return |g C| and the phase margin at a crossover, C with its filter, from the definition."""
    s = 1j * crossover
    derivative = setting.derivative_time * s / (1 + 0.1 * setting.derivative_time * s)
    C = setting.gain * (1 + 1 / (setting.integral_time * s) + derivative)
    g = element.gain * np.exp(-s * (delay + element.dead_time)) / s**element.integrators
    for pole in element.poles:
        g /= 1 - s / pole
    return abs(g * C), math.pi + np.angle(g * C)


@pytest.mark.parametrize("degrees", [35.0, 60.0])
@pytest.mark.parametrize(
    ("element", "crossover"),
    [
        (TransferElement(2.0, (-0.1, -0.2), (), 0), 0.15),
        (TransferElement(-2.0, (-0.1, -0.2, -1.0), (), 0, 0.5), 0.3),
        (TransferElement(0.02, (-0.5,), (), 1, 1.0), 0.2),
    ],
)
def test_a_pid_gives_the_margin_asked_for(element, crossover, degrees):
    setting = pid_for_margin(element, 0.5, math.radians(degrees), crossover)
    size, margin = found_margin(element, 0.5, setting, crossover)
    assert size == pytest.approx(1.0, abs=1e-9)
    assert margin == pytest.approx(math.radians(degrees), abs=1e-9)
    assert setting.integral_time == pytest.approx(4.0 * setting.derivative_time, rel=1e-12)
    assert math.copysign(1.0, setting.gain) == element.sign


def test_a_pid_leads_no_further_than_its_filter_lets_it():
    with pytest.raises(NotApplicable, match=r"lead by 60°.* leads by 56° at most"):
        pid_for_margin(TransferElement(1.0, (), (), 2), 0.0, math.radians(60.0), 1.0)


def test_a_crossover_beyond_pi_gets_a_pid_where_no_form_is_asked_for(minimum_phase):
    tank = minimum_phase
    with pytest.raises(NotApplicable, match=r"lead by.*lower crossover or a PID"):
        design_phase_margin(tank.model, DIRECT, form=PidForm("PI"), crossover=1.2)
    controller = design_phase_margin(tank.model, DIRECT, crossover=1.2)
    assert controller.name == "PID, phase margin"
    for i in (0, 1):
        values = controller.values
        setting = PidSettings(
            values[f"level_{i + 1}.proportional_gain"],
            values[f"level_{i + 1}.integral_time"],
            values[f"level_{i + 1}.derivative_time"],
        )
        element = TransferElement(tank.direct_gains[i], (-1.0 / tank.T[i],), (), 0)
        size, margin = found_margin(element, 0.5, setting, 1.2)
        assert (size, math.degrees(margin)) == (pytest.approx(1.0), pytest.approx(60.0))


@pytest.mark.parametrize("design", [design_simc, design_phase_margin])
@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel"])
def test_every_algorithm_is_one_sampled_loop(nonminimum_phase, design, algorithm):
    """A PI in any form is the same law, so its settings and its peak are the same."""
    model = nonminimum_phase.model
    one = design(model, CROSS)
    other = design(model, CROSS, form=PidForm("PI", algorithm))
    assert other.design == one.design
    if algorithm == "parallel":
        ratio = other.values["level_1.proportional_gain"] / other.values["level_1.integral_gain"]
        assert ratio == pytest.approx(one.values["level_1.integral_time"], rel=1e-6)


def test_a_velocity_form_counts_the_error_of_this_sample_at_once(nonminimum_phase):
    """K Σ up to now is K Σ up to before and K T/Ti more in proportion: K (1 + T/Ti), Ti + T."""
    loops = {
        algorithm: MultiloopPid(nonminimum_phase.model, CROSS, PidForm("PI", algorithm), "test")
        for algorithm in ("velocity", "isa")
    }
    settings = [PidSettings(0.4, 60.0), PidSettings(0.3, 90.0)]
    same = [PidSettings(K * (1.0 + 1.0 / Ti), Ti + 1.0) for K, Ti, _ in settings]
    assert loops["velocity"].peak(settings) == pytest.approx(loops["isa"].peak(same), rel=1e-9)
    assert loops["velocity"].peak(settings) != pytest.approx(loops["isa"].peak(settings), rel=1e-4)


@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel", "velocity"])
def test_a_simc_pid_is_the_same_controller_in_every_algorithm(nonminimum_phase, algorithm):
    model = nonminimum_phase.model
    controller = design_simc(model, CROSS, form=PidForm("PID", algorithm))
    assert controller.family == "multiloop PID"
    peak = re.search(r"together ([\d.]+)\.$", controller.design)
    assert float(peak[1]) == 2.0
    for number, (long, short) in enumerate(
        [sorted(nonminimum_phase.T[[i, i + 2]], reverse=True) for i in (0, 1)], start=1
    ):
        values = controller.values
        if algorithm == "series":
            assert values[f"level_{number}.derivative_time"] == pytest.approx(short, rel=1e-9)
        elif algorithm == "parallel":
            Td = (
                values[f"level_{number}.derivative_gain"]
                / values[f"level_{number}.proportional_gain"]
            )
            assert values[f"level_{number}.filter_time"] == pytest.approx(Td / 10.0, rel=1e-9)
            assert Td < short
        else:
            Ti, Td = (
                values[f"level_{number}.integral_time"],
                values[f"level_{number}.derivative_time"],
            )
            # Ti Td of the ISA form is that of the series form, and Ti' = τ1 or less.
            assert Ti * Td <= long * short * (1 + 1e-9)
            assert Td < short


def test_detuning_stops_where_the_peak_is_just_allowed():
    """Of a peak with a closed form: 1 + K/F² for K = 9 is 2 at F = 3."""
    found = slow_down(
        lambda factor: slowed_down([PidSettings(9.0, 60.0)], factor),
        lambda settings: 1.0 + settings[0].gain * 60.0 / settings[0].integral_time,
        OF_LOOPS,
    )
    assert found.peak <= 2.0
    assert found.factor == pytest.approx(3.0, rel=1e-5)
    assert found.design == slowed_down([PidSettings(9.0, 60.0)], found.factor)


@pytest.mark.parametrize("edge", [1.05, 1.3, 7.0, 600.0])
def test_detuning_crosses_the_limit_of_stability(edge):
    """1/peak rises from zero at the edge of stability to one, and is half at twice the edge."""
    tried = []

    def peak(settings):
        factor = settings[0].integral_time
        tried.append(factor)
        return math.inf if factor <= edge else factor / (factor - edge)

    def settings_at(factor):
        return [PidSettings(1.0, factor)]

    if 2 * edge > 1000.0:
        with pytest.raises(NotApplicable, match="the best sensitivity peak is"):
            slow_down(settings_at, peak, OF_LOOPS)
        return
    found = slow_down(settings_at, peak, OF_LOOPS)
    assert found.peak <= 2.0
    assert found.factor == pytest.approx(2 * edge, rel=1e-5)
    # Four steps an octave, then few: a design is quick.
    assert len(tried) < 4 * math.log2(2 * edge) + 15


@pytest.mark.parametrize(
    ("design", "options", "reason"),
    [
        (design_simc, {}, "another pairing"),
        (design_phase_margin, {}, "another pairing"),
        (design_simc, {"closed_loop_time_constant": 500.0}, "unstable"),
    ],
)
def test_a_pairing_that_no_slowing_down_can_save_is_not_applicable(
    nonminimum_phase, design, options, reason
):
    """The diagonal pairing has negative relative gains: unstable with integral action."""
    with pytest.raises(NotApplicable, match=reason):
        design(nonminimum_phase.model, DIRECT, **options)


def test_initial_state_is_rest_at_the_operating_point(minimum_phase):
    tank = minimum_phase
    for design in (design_simc, design_phase_margin):
        for anti_windup in ("back_calculation", "conditional_integration"):
            controller = design(tank.model, DIRECT, form=PidForm(anti_windup=anti_windup))
            law, at = controller.law, tank.model.point.as_dict()
            given = {"time_step": 1.0}
            for i in (1, 2):
                level = at[f"level_{i}"]
                given |= {f"level_{i}.sp": level, f"level_{i}.pv": level}
                given |= {f"level_{i}.good": 1.0, f"pump_{i}.mode": 1.0}
            state = [controller.initial_state[s.name] for s in law.state]
            after, outputs, _ = law.function(
                state,
                [given.get(s.name, 0.0) for s in law.inputs],
                [controller.values[s.name] for s in law.parameters],
            )
            assert np.array(after).ravel().tolist() == state
            kept = {s.name: value for s, value in zip(law.state, state, strict=True)}
            for i in (1, 2):
                assert kept[f"level_{i}.integral"] == kept[f"pump_{i}.last_output"] == 3.0
            assert [float(outputs[0]), float(outputs[2])] == [3.0, 3.0]


def test_an_integrating_tank_is_controlled_by_both(single_tank):
    model = single_tank([[0.0]], [0.02], [1.0])
    gain, integral_time = settings_of(design_simc(model, [("level", "pump")]))[0]
    # 5 V of room for 1 V; Ti = 4 (τc + θ) = 4/(k' K).
    assert (gain, integral_time) == (pytest.approx(5.0), pytest.approx(4 / (0.02 * 5.0)))
    controller = design_phase_margin(model, [("level", "pump")])
    gain, integral_time = settings_of(controller)[0]
    _, margin = margin_of(TransferElement(0.02, (), (), 1), 0.5, PidSettings(gain, integral_time))
    assert (gain, math.degrees(margin)) == (pytest.approx(5.0), pytest.approx(60.0, abs=1e-5))


@pytest.mark.parametrize(
    ("matrices", "reason"),
    [
        (([[0.1]], [1.0], [1.0]), "unstable"),
        (([[-0.1]], [0.0], [1.0]), "pump does not move level"),
        (([[-0.2, 0.0], [0.2, -0.1]], [1.0, -1.0], [0.0, 1.0]), "zero"),
    ],
)
@pytest.mark.parametrize("design", [design_simc, design_phase_margin])
def test_tanks_that_no_pi_can_control_are_not_applicable(single_tank, design, matrices, reason):
    with pytest.raises(NotApplicable, match=reason):
        design(single_tank(*matrices), [("level", "pump")])


def test_signals_without_a_range_are_not_applicable(single_tank):
    model = single_tank([[-0.1]], [1.0], [1.0], span=math.inf)
    with pytest.raises(NotApplicable, match="level has no finite range"):
        design_simc(model, [("level", "pump")])


@pytest.mark.parametrize(
    ("design", "pairing", "options", "place", "value"),
    [
        (design_simc, [], {}, "SIMC, pairing", "[]"),
        (design_simc, [("level_9", "pump_1")], {}, "SIMC, linear model, outputs", "level_9"),
        (
            design_simc,
            [("level_1", "pump_1"), ("level_2", "pump_1")],
            {},
            "SIMC, linear model, inputs",
            "pump_1",
        ),
        (design_simc, 3, {}, "SIMC, pairing", "3"),
        (design_simc, "level_1", {}, "SIMC, pairing", "level_1"),
        (design_simc, ["level_1", "pump_1"], {}, "SIMC, pairing", "['level_1', 'pump_1']"),
        (
            design_simc,
            [("level_1", "pump_1", "pump_2")],
            {},
            "SIMC, pairing",
            "[('level_1', 'pump_1', 'pump_2')]",
        ),
        (design_simc, DIRECT, {"form": "PID"}, "SIMC, form", "PID"),
        (design_phase_margin, DIRECT, {"form": PidForm("PD")}, "phase margin, form", "PD"),
        (
            design_simc,
            DIRECT,
            {"closed_loop_time_constant": 0.0},
            "SIMC, closed_loop_time_constant",
            "0.0",
        ),
        (
            design_simc,
            DIRECT,
            {"closed_loop_time_constant": "30 s"},
            "SIMC, closed_loop_time_constant",
            "30 s",
        ),
        (design_phase_margin, DIRECT, {"phase_margin": "60"}, "phase margin, phase_margin", "60"),
        (design_phase_margin, DIRECT, {"crossover": "0.1"}, "phase margin, crossover", "0.1"),
        (design_phase_margin, DIRECT, {"crossover": 0.0}, "phase margin, crossover", "0.0"),
        (
            design_simc,
            DIRECT,
            {"closed_loop_time_constant": math.nan},
            "SIMC, closed_loop_time_constant",
            "nan",
        ),
        (design_phase_margin, DIRECT, {"phase_margin": 60.0}, "phase margin, phase_margin", "60.0"),
        (design_phase_margin, DIRECT, {"crossover": -1.0}, "phase margin, crossover", "-1.0"),
        (design_phase_margin, DIRECT, {"crossover": math.inf}, "phase margin, crossover", "inf"),
    ],
)
def test_wrong_requests_are_refused(minimum_phase, design, pairing, options, place, value):
    with pytest.raises(InputError) as caught:
        design(minimum_phase.model, pairing, **options)
    assert (caught.value.place, str(caught.value.value)) == (place, value)


@pytest.mark.parametrize(
    ("matrices", "period", "reason"),
    [
        # k' = 1e-9/s and τc + θ = 1 ms: K = 1e12.
        (
            ([[-1.0]], [1e-9], [1.0]),
            1e-3,
            r"level.proportional_gain would be 1e\+12, and a controller",
        ),
        # A time constant of 1 ns.
        (
            ([[-1e9]], [1e9], [1.0]),
            1e-9,
            "level.integral_time would be .*e-0.*from 1e-06 to 1e.09 s",
        ),
    ],
)
def test_settings_that_no_controller_takes_are_not_applicable(
    single_tank, matrices, period, reason
):
    model = single_tank(*matrices, period=period, span=1e-6, high=1e6, at=5e5)
    with pytest.raises(NotApplicable, match=reason):
        design_simc(model, [("level", "pump")])


@pytest.mark.sampled
@pytest.mark.parametrize(
    "design",
    [
        design_simc,
        design_lambda,
        design_phase_margin,
        design_ziegler_nichols,
        design_tyreus_luyben,
        design_amigo,
        design_fuzzy_pi,
        design_glover_mcfarlane,
        design_polynomial,
        design_variable_structure_pid,
    ],
)
def test_without_a_pairing_it_is_the_one_that_the_relative_gains_suggest(design):
    analysis = analysed("quadruple-tank-nonminimum-phase")
    assert analysis.pairing == (("level_1", "pump_2"), ("level_2", "pump_1"))  # the crossed one
    found = design(analysis.model)
    assert (found.measurements, found.manipulated) == (("level_1", "level_2"), ("pump_2", "pump_1"))
    for pairing in (analysis.pairing, dict(analysis.pairing)):
        assert design(analysis.model, pairing).values == found.values


def test_where_no_pairing_is_suggested_one_is_asked_for():
    """Both inputs do the same: their relative gains do not exist."""
    model = analysed("quadruple-tank").model
    same = dataclasses.replace(model, B=np.repeat(model.B[:, :1], 2, axis=1))
    with refused(expected="a pairing, since the relative gains suggest none"):
        design_simc(same)
