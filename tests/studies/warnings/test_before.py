"""Every warning before simulating, raised by one loop and not by another, against closed forms."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import NotApplicable, PidForm, Signal
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Segment
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.program.step_law import Equations, step_law
from clepsydra.studies.warnings.bandwidth import bandwidth_warnings
from clepsydra.studies.warnings.before import blocking_zeros, caveats_before, warnings_before
from clepsydra.studies.warnings.loop_response import loop_response
from clepsydra.studies.warnings.margins import margin_warnings
from clepsydra.studies.warnings.sampling import sampling_warnings
from clepsydra.studies.warnings.stability import stability_warnings
from clepsydra.studies.warnings.unit_mix_up import unit_warnings
from clepsydra.studies.warnings.wind_up import winds_up


def told(analysis, controller, scenario):
    """All that is said before a simulation, but that no load changes, as none does in most."""
    model = linearise(analysis.operating_point)
    caveats = [each.words for each in caveats_before(model, controller, scenario)]
    warned = warnings_before(model, controller, scenario)
    return (*(words for words in caveats if not words.startswith("No load changes")), *warned)


def with_values(controller, **values):
    return replace(controller, values=controller.values | values)


def scaled(controller, name, factor):
    """Return the controller with a parameter of all its loops multiplied."""
    return with_values(
        controller, **{k: factor * v for k, v in controller.values.items() if k.endswith(name)}
    )


def number_in(words, pattern):
    (match,) = re.findall(pattern, words)
    return float(match)


@pytest.mark.sampled
@pytest.mark.parametrize("name", catalogue_names())
def test_the_designs_of_the_catalogue_raise_no_false_alarm(name):
    plant = cl.load(name)
    scenario = default_scenario(plant.linear)
    for design in (cl.design.simc, cl.design.lqi):
        try:
            controller = design(plant)
        except NotApplicable:
            continue
        assert told(plant.analysis, controller, scenario) == (), controller.name


# Stability


def test_an_unstable_loop_is_told_with_its_rate(tank, proportional, stepped):
    """z = 1 + 0.2: the factor e in 1/ln 1.2 s."""
    analysis = tank()
    words = told(analysis, proportional(analysis.model, -1.0), stepped(analysis.model, 0.1))
    assert len(words) == 1 and "level is unstable" in words[0]
    assert number_in(words[0], r"factor e in ([\d.]+) s") == pytest.approx(
        1.0 / math.log(1.2), abs=0.005
    )
    assert told(analysis, proportional(analysis.model, 1.0), stepped(analysis.model, 0.1)) == ()


def test_a_law_that_leaves_small_errors_alone_has_no_linear_loop(tank, pid, stepped):
    """The tank by itself integrates; within the gap that is what is wanted."""
    analysis = tank()
    form = PidForm("P", error="gap")
    for gap_gain, unstable in ((0.0, False), (0.5, True)):
        values = {"proportional_gain": -1.0, "gap": 1.0, "gap_gain": gap_gain}
        words = told(analysis, pid(analysis.model, form, **values), stepped(analysis.model, 0.1))
        assert any("is unstable" in w for w in words) == unstable, gap_gain


def two_tanks(moved, shown):
    """One tank that decays and one that integrates, which is moved and shown or not."""
    A, B, C = np.diag([-0.1, 0.0]), [[0.1], [0.1 * moved]], [[1.0, 1.0 * shown]]
    return A, B, C


@pytest.mark.parametrize(
    ("moved", "shown", "said"),
    [(1, 1, None), (0, 1, "pump_1 cannot move it"), (1, 0, "level_1 cannot show it")],
)
def test_a_mode_that_drifts_unseen_is_told(by_matrices, pid, moved, shown, said):
    model = by_matrices(*two_tanks(moved, shown))
    controller = pid(model, PidForm("P"), proportional_gain=0.5)
    words = list(stability_warnings(controller, model, loop_response(controller, model), []))
    assert [w for w in words if "drifts to a limit" in w] == [
        w for w in words if said is not None and said in w
    ]
    assert bool(words) == (said is not None)
    if said:
        assert any(w.startswith("tank_2.level does not come to rest") for w in words)


def law_with_pole(model, pole, gain=0.01) -> Controller:
    """Return a law x(k+1) = pole x + e, u = gain (e + x)."""
    law = step_law(
        "with_pole",
        inputs=[Signal("level_1.sp"), Signal("level_1.pv")],
        parameters=[],
        state=[Signal("x")],
        outputs=[Signal("pump_1.out"), Signal("pump_1.status")],
        equations=lambda s: Equations(
            {"x": pole * s["x"] + s["level_1.sp"] - s["level_1.pv"]},
            {
                "pump_1.out": gain * (s["level_1.sp"] - s["level_1.pv"] + s["x"]),
                "pump_1.status": 0,
            },
        ),
    )
    return Controller(
        "by hand", "by hand", "By hand.", law, {}, {"x": 0.0}, ("level_1",), ("level_1",),
        ("pump_1",),
    )  # fmt: skip


# (0.3 - s)/((s + 1)(s + 0.5))
INVERSE = ([[-1.5, -0.5], [1.0, 0.0]], [[1.0], [0.0]], [[-1.0, 0.3]])


def test_a_law_that_inverts_a_zero_in_the_right_half_plane_is_told(by_matrices):
    model = by_matrices(*INVERSE)
    zeros = [found.zero for found in blocking_zeros(model)]
    assert zeros == pytest.approx([0.3])

    def words(pole):
        controller = law_with_pole(model, pole)
        return list(stability_warnings(controller, model, loop_response(controller, model), zeros))

    inverting = [w for w in words(math.exp(0.3)) if "inverts the process" in w]
    assert len(inverting) == 1 and "at 0.3 rad/s" in inverting[0]
    assert "factor e in 3.33 s" in inverting[0]
    other = words(math.exp(0.05))
    assert any("step law is unstable by itself" in w and "in 20 s" in w for w in other)
    assert not any("inverts" in w for w in other)
    assert words(0.9) == []


# Bandwidth


def test_a_bandwidth_beyond_a_zero_is_told_with_its_outputs(nonminimum):
    analysis, controller = nonminimum
    zeros = blocking_zeros(analysis.model)
    zero = analysis.zeros[0].real

    def words(factor):
        changed = scaled(controller, "proportional_gain", factor)
        response = loop_response(changed, analysis.model)
        model = analysis.model.select(response.outputs, response.inputs)
        return list(bandwidth_warnings(model, response, zeros))

    (warning,) = words(5.0)
    assert "level_1" in warning and "level_2" in warning
    assert number_in(warning, r"zero at ([\d.]+) rad/s") == pytest.approx(zero, rel=1e-2)
    assert number_in(warning, r"allows about ([\d.]+) rad/s") == pytest.approx(zero / 2, rel=1e-2)
    assert words(1.0) == []


def test_a_crossover_beyond_the_dead_time_is_told(tank, proportional, stepped):
    """0.2 K/s e^(-10 s) crosses over at 0.2 K rad/s (sampled: 2 asin(0.1 K)); 0.1 is allowed."""
    channel = '[delays.channel]\ndestination = "tank"\ntime = "10 s"'
    analysis = tank(destination="channel", more=channel)
    scenario = stepped(analysis.model, 0.1)
    slow = told(analysis, proportional(analysis.model, 0.4), scenario)
    assert not any("dead time" in w for w in slow)
    fast = [
        w for w in told(analysis, proportional(analysis.model, 0.8), scenario) if "dead time" in w
    ]
    assert len(fast) == 1
    assert number_in(fast[0], r"crosses over at ([\d.]+) rad/s") == pytest.approx(
        2.0 * math.asin(0.08), abs=6e-4
    )
    assert "dead time of 10 s allows about 0.1 rad/s" in fast[0]


# Margins


def test_a_small_gain_margin_is_told_with_the_peak(tank, proportional):
    """a = 1.2: S(-1) = 2/(2 - a) = 2.5, gain margin 2/a = 1.67; at a = 0.98 the peak is 1.96."""
    model = tank().model
    words = list(margin_warnings(loop_response(proportional(model, 6.0), model)))
    assert len(words) == 2
    assert words[0].startswith("max|S| is 2.50 at 3.14 rad/s")
    assert words[1].startswith("The loop of level has a gain margin of 1.67 at 3.14 rad/s")
    assert list(margin_warnings(loop_response(proportional(model, 4.9), model))) == []


def test_a_small_phase_margin_is_told(tank, pid):
    """K (1 + 1/(Ti s)) 0.2/s: ωc² = (k² + √(k⁴ + 4 k²/Ti²))/2, phase margin atan(ωc Ti)."""
    model = tank(period=0.01).model

    def words(integral_time):
        controller = pid(model, proportional_gain=1.0, integral_time=integral_time)
        return list(margin_warnings(loop_response(controller, model)))

    k, Ti = 0.2, 1.0
    omega = math.sqrt((k**2 + math.sqrt(k**4 + 4 * k**2 / Ti**2)) / 2)
    (warning,) = [w for w in words(Ti) if "phase margin" in w]
    assert number_in(warning, r"phase margin of (\d+)°") == round(
        math.degrees(math.atan(omega * Ti))
    )
    assert words(20.0) == []


def satellite(coupling):
    """1/(s² + a²) [[s - a², a(s + 1)], [-a(s + 1), s - a²]] with a = `coupling`."""
    a = coupling
    return [[0.0, a], [-a, 0.0]], np.eye(2), [[1.0, a], [-a, 1.0]]


def test_gains_that_are_wrong_all_at_once_are_told_where_no_channel_shows_it(by_matrices, pid):
    """The spinning satellite with u = -y: each loop alone is 1/s, with every gain margin.

    Skogestad and Postlethwaite, 2nd ed., section 3.7.1: with gains 1 + ε and 1 - ε it is
    unstable from ε = 1/√(a² + 1) on, for a = 10 from 0.0995. The disk margin is at most the
    smaller of the two steps, δ = 2 (f - 1)/(f + 1) of f = 1.0995 and 1/0.9005.
    """
    model = by_matrices(*satellite(10.0), period=1e-3)
    controller = pid(model, PidForm("P"), proportional_gain=1.0)
    words = list(margin_warnings(loop_response(controller, model)))
    (warning,) = [w for w in words if "all measurements" in w]
    assert not any(w.startswith("The loop of") for w in words)
    factor = number_in(warning, r"by a factor of ([\d.]+)")
    assert 1.09 <= factor <= 1.0 / (1.0 - 1.0 / math.sqrt(101.0)) + 0.005
    calm = by_matrices(*satellite(0.5), period=1e-3)
    controller = pid(calm, PidForm("P"), proportional_gain=1.0)
    assert list(margin_warnings(loop_response(controller, calm))) == []


# Sampling


def test_a_crossover_too_fast_for_the_sampling_is_told(tank, proportional):
    """2 sin(ωc T/2) = 0.2 K; the hold takes ωc T/2."""
    model = tank().model

    def words(gain):
        controller = proportional(model, gain)
        return list(sampling_warnings(controller, loop_response(controller, model)))

    (warning,) = words(3.0)
    assert number_in(warning, r"takes (\d+)° of phase") == round(math.degrees(math.asin(0.3)))
    assert number_in(warning, r"crosses over at ([\d.]+) rad/s") == pytest.approx(
        2.0 * math.asin(0.3), abs=6e-4
    )
    assert words(2.4) == []


@pytest.mark.parametrize("algorithm", ["isa", "parallel"])
def test_a_derivative_filter_faster_than_the_sampling_is_told(tank, pid, algorithm):
    model = tank().model
    form = PidForm("PID", algorithm=algorithm)

    def words(derivative, filter_time):
        values = {"proportional_gain": 1.0}
        if algorithm == "isa":
            values |= {"integral_time": 50.0, "derivative_time": derivative}
            values["derivative_filter"] = max(derivative, 1.0) / filter_time
        else:
            values |= {"integral_gain": 0.02, "derivative_gain": derivative}
            values["filter_time"] = filter_time
        controller = pid(model, form, **values)
        return list(sampling_warnings(controller, loop_response(controller, model)))

    (warning,) = words(2.0, 0.5)
    assert "filtered with 0.5 s" in warning and "sampling period of 1 s" in warning
    assert words(2.0, 1.5) == []
    assert words(0.0, 0.5) == []


# Units


def test_gains_in_percent_of_the_pumps_range_are_told(quadruple):
    """3 V/V is 30 % of the pump's 10 V for each volt of the level."""
    analysis, controller = quadruple
    model = analysis.model

    def words(changed):
        return list(unit_warnings(changed, model, loop_response(changed, model)))

    both = words(scaled(controller, "proportional_gain", 10.0))
    assert [number_in(w, r"fit as ([\d.]+) % of pump") for w in both] == [30.0, 30.0]
    assert all(w.endswith("the law then needs 3 V/V.") for w in both)
    (one,) = words(with_values(controller, **{"level_1.proportional_gain": 30.0}))
    assert one.startswith("level_1.proportional_gain of 30 V/V is far too strong")
    # Bold, careful, of the wrong sign, or with too short an integral time: no question of units.
    for factor in (0.3, 3.0, -1.0):
        assert words(scaled(controller, "proportional_gain", factor)) == [], factor
    assert words(scaled(controller, "integral_time", 0.01)) == []
    # It is seen from the loops themselves, whatever their kind is called.
    assert words(replace(scaled(controller, "proportional_gain", 10.0), family="ours")) == both


def test_gains_per_centimetre_taken_per_metre_are_told(tank, proportional):
    """A sensor that gives metres: 0.2 V/cm is 20 V/m."""
    model = tank(sensor='range = ["0 cm", "50 cm"]', rest="25 cm").model

    def words(gain):
        controller = proportional(model, gain)
        return list(unit_warnings(controller, model, loop_response(controller, model)))

    (warning,) = words(0.2)
    assert "leaves the process nearly alone" in warning
    assert "fit as 0.2 V per cm" in warning and "needs 20 V/m" in warning
    for gain in (4.0, 20.0, 60.0):
        assert words(gain) == [], gain


# Wind-up and saturation


@pytest.mark.sampled
@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel"])
@pytest.mark.parametrize(
    "anti_windup", ["none", "clamping", "conditional_integration", "back_calculation"]
)
def test_only_an_integral_without_anti_windup_winds_up(tank, pid, algorithm, anti_windup):
    model = tank().model
    form = PidForm("PI", algorithm=algorithm, anti_windup=anti_windup)
    for gain in (2.0, -2.0):
        parallel = algorithm == "parallel"
        values = {"integral_gain": gain / 40.0} if parallel else {"integral_time": 20.0}
        controller = pid(model, form, proportional_gain=gain, **values)
        expected = ("pump",) if anti_windup == "none" else ()
        assert winds_up(controller, model.point.process) == expected, gain


def test_nothing_winds_up_without_an_integral(tank, pid, quadruple):
    model = tank().model
    assert winds_up(pid(model, PidForm("P", anti_windup="none")), model.point.process) == ()
    velocity = pid(model, PidForm("PI", algorithm="velocity"), integral_time=20.0)
    assert winds_up(velocity, model.point.process) == ()
    plant = quadruple[1].plant
    assert winds_up(cl.design.lqi(plant), plant.process) == ()


def test_wind_up_is_foreseen_where_a_step_asks_for_too_much(tank, pid, stepped):
    """The pump rests at 5 V; K = 2 and a step of 4 V ask for 13 V, a step of 2 V for 9 V."""
    analysis = tank()
    none = pid(
        analysis.model,
        PidForm(anti_windup="none"),
        proportional_gain=2.0,
        integral_time=20.0,
    )
    (warning,) = told(analysis, none, stepped(analysis.model, 4.0))
    assert warning.startswith("pump winds up") and "asks for 13 V" in warning
    assert told(analysis, none, stepped(analysis.model, 2.0)) == ()
    other = pid(analysis.model, proportional_gain=2.0, integral_time=20.0)
    assert told(analysis, other, stepped(analysis.model, 4.0)) == ()


def test_a_long_tracking_time_is_told(tank, pid, stepped):
    analysis = tank()

    def words(tracking):
        controller = pid(
            analysis.model,
            proportional_gain=1.0,
            integral_time=20.0,
            tracking_time=tracking,
        )
        return told(analysis, controller, stepped(analysis.model, 0.1))

    (warning,) = words(200.0)
    assert "tracking time of 3.33 min is 10.0 times its integral time of 20 s" in warning
    assert words(20.0) == ()


@pytest.mark.parametrize("demand", [990, 10, 0])
def test_an_operating_point_without_room_is_told_once(tank, proportional, stepped, demand):
    """100 cm³/s a volt, 10 V at most: the point has the warning, and no step is told beside it."""
    analysis = tank(demand=demand)
    steps = stepped(analysis.model, 0.1)
    assert told(analysis, proportional(analysis.model, 1.0), steps) == ()
    assert sum("rests at" in words for words in analysis.operating_point.warnings) == 1


@pytest.mark.parametrize(("load", "said"), [(6e-4, True), (4e-4, False)])
def test_a_load_that_the_pump_cannot_hold_is_told(tank, proportional, stepped, load, said):
    """500 + 600 cm³/s would need 11 V."""
    analysis = tank()
    scenario = stepped(analysis.model, 0.0)
    disturbances = scenario.disturbances.copy()
    disturbances[5:] += load
    scenario = replace(
        scenario,
        disturbances=disturbances,
        segments=(Segment("load", "demand", 5.0, 50.0, load),),
    )
    words = told(analysis, proportional(analysis.model, 1.0), scenario)
    assert len(words) == said
    if said:
        assert "load step of demand by 600 cm³/s" in words[0] and "at about 11 V" in words[0]


@pytest.mark.parametrize(("seconds", "said"), [(4, False), (5, True)])
def test_a_load_that_is_over_before_the_tank_is_empty_needs_not_be_held(
    tank, proportional, stepped, seconds, said
):
    """600 cm³/s more out of 100 cm² lower the level by 6 cm/s, and it stands at 25 cm."""
    analysis = tank()
    scenario = stepped(analysis.model, 0.0)
    disturbances = scenario.disturbances.copy()
    disturbances[5 : 5 + seconds] += 6e-4
    ends = 5.0 + seconds
    scenario = replace(
        scenario,
        disturbances=disturbances,
        segments=(
            Segment("load", "demand", 5.0, ends, 6e-4),
            Segment("load", "demand", ends, 50.0, -6e-4),
        ),
    )
    words = told(analysis, proportional(analysis.model, 1.0), scenario)
    assert [("at about 11 V" in each) for each in words] == [True] * said


# Levels


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (3.5, "The setpoint of level of 8.5 V is beyond the trip of pump, tank above 40 cm"),
        (-4.5, "The setpoint of level of 0.5 V is beyond the trip of pump, tank below 5 cm"),
        (2.5, None),
        (-3.5, None),
    ],
)
def test_a_setpoint_beyond_a_trip_is_told(tank, proportional, stepped, step, said):
    """0.2 V/cm: 40 cm are 8 V and 5 cm are 1 V."""
    trip = 'trip_above = { tank = "40 cm" }\ntrip_below = { tank = "5 cm" }\nhysteresis = "1 cm"'
    analysis = tank(trip=trip)
    words = told(analysis, proportional(analysis.model, 0.5), stepped(analysis.model, step))
    assert len(words) == (said is not None) and all(w.startswith(said) for w in words)


@pytest.mark.parametrize(
    ("step", "said"),
    [(6.0, ["outside of its range", "above the rim"]), (-5.0, ["below the floor"]), (4.0, [])],
)
def test_a_setpoint_outside_of_tank_or_sensor_is_told(tank, proportional, stepped, step, said):
    analysis = tank()
    words = told(analysis, proportional(analysis.model, 0.5), stepped(analysis.model, step))
    assert len(words) == len(said)
    assert all(what in w for what, w in zip(said, words, strict=True))


@pytest.fixture(scope="module")
def well():
    plant = cl.load("wet-well")
    return plant.analysis, cl.design.simc(plant)


@pytest.mark.parametrize(
    ("level", "said"),
    [(1.5, None), (0.45, "stops duty"), (2.6, "starts standby"), (1.1, None)],
)
def test_a_setpoint_beyond_a_level_switch_is_told(well, stepped, level, said):
    """4 mA/m from 4 mA; the duty pump stops below 0.5 m, the standby pump starts above 2.5 m."""
    analysis, controller = well
    words = told(analysis, controller, stepped(analysis.model, 0.004 * (level - 1.5)))
    about = [w for w in words if "level switch" in w]
    assert len(about) == (said is not None) and all(said in w for w in about)


def test_a_tank_that_is_not_controlled_is_watched_too(stepped):
    """Tank 4 of the laboratory stands in the way of tank 1: both pumps trip at 27.5 cm."""
    laboratory = cl.load("laboratory-four-tanks")
    analysis, controller = laboratory.analysis, cl.design.simc(laboratory)

    def words(step):
        scenario = stepped(analysis.model, step, "level_1")
        return [w for w in told(analysis, controller, scenario) if "tank_4.level" in w]

    (warning,) = words(0.13)
    assert warning.startswith("After the setpoint step of level_1 tank_4.level is at about 29")
    assert "beyond the trip of pump_1 and pump_2, tank_4 above 27.5 cm" in warning
    assert words(0.1) == []


def test_what_cannot_be_checked_is_told(tank, proportional, stepped):
    """A dead time of 1000 samples makes no sampled model of moderate size."""
    channel = '[delays.channel]\ndestination = "tank"\ntime = "1000 s"'
    analysis = tank(destination="channel", more=channel)
    (warning,) = told(analysis, proportional(analysis.model, 0.001), stepped(analysis.model, 0.1))
    assert warning.startswith("Stability, margins and bandwidth could not be checked: ")
    assert "1000 s" in warning and warning.endswith("sample more slowly.")
