"""Equilibria: Johansson's closed forms, and the reasons why there is none."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from refusals import refused
from written_plants import plant_of

from clepsydra import InputError, NoEquilibrium
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process


def torricelli(level, outlet=0.1):
    return outlet * ca.sqrt(ca.fmax(level, 0))


def torricelli_by_choice(level, outlet=0.1):
    return ca.if_else(level > 0, outlet * ca.sqrt(level), 0)


def test_levels_from_nominal_inputs(johansson):
    point = find_equilibrium(johansson.process)
    np.testing.assert_allclose(point.state, johansson.levels(johansson.voltage), rtol=1e-13)
    np.testing.assert_allclose(point.measurements, 50 * point.state, rtol=1e-15)
    assert point.warnings == ()
    # Levels move by less than a hundred-thousandth of a millionth of their height in an hour.
    assert point.residual * 3600 < 1e-11 * 0.2


@pytest.mark.parametrize("voltage", [(2.0, 3.5), (0.5, 0.4), (3.3, 2.1)])
def test_levels_from_given_inputs(johansson, voltage):
    point = find_equilibrium(johansson.process, {"pump_2": voltage[1], "pump_1": voltage[0]})
    np.testing.assert_allclose(point.state, johansson.levels(voltage), rtol=1e-13)
    np.testing.assert_array_equal(point.inputs, voltage)


def test_an_input_that_is_not_named_keeps_its_nominal_value(minimum):
    point = find_equilibrium(minimum.process, {"pump_2": 2.0})
    np.testing.assert_allclose(point.state, minimum.levels((3.0, 2.0)), rtol=1e-13)


@pytest.mark.parametrize("voltage", [(3.0, 3.0), (2.5, 3.2)])
def test_inputs_and_upper_levels_from_outputs(johansson, voltage):
    levels = johansson.levels(voltage)
    asked = {"level_1": 50 * levels[0], "level_2": 50 * levels[1]}
    point = find_equilibrium(johansson.process, outputs=asked)
    # The nonminimum phase's map from outputs to inputs multiplies rounding about tenfold.
    np.testing.assert_allclose(point.inputs, voltage, rtol=1e-12)
    np.testing.assert_allclose(point.state, levels, rtol=1e-12)


def test_one_input_given_and_one_output_asked(minimum):
    levels = minimum.levels((2.0, 3.5))
    point = find_equilibrium(
        minimum.process, inputs={"pump_1": 2.0}, outputs={"level_2": 50 * levels[1]}
    )
    np.testing.assert_allclose(point.inputs, (2.0, 3.5), rtol=1e-13)


def test_nominal_outputs_fix_the_point_unless_inputs_are_given(minimum):
    from dataclasses import replace

    levels = minimum.levels((2.0, 3.5))
    asked = {"level_1": 50 * levels[0], "level_2": 50 * levels[1]}
    process = replace(minimum.process, nominal_outputs=asked)
    np.testing.assert_allclose(find_equilibrium(process).inputs, (2.0, 3.5), rtol=1e-12)
    given = {"pump_1": 1.0, "pump_2": 2.5}
    np.testing.assert_array_equal(find_equilibrium(process, given).inputs, (1.0, 2.5))
    for given in ({"pump_1": 1.0}, {}):
        with pytest.raises(InputError, match=r"no (pump_1, )?pump_2, expected a value of every"):
            find_equilibrium(process, given)


def test_a_disturbance_is_balanced(minimum):
    point = find_equilibrium(minimum.process, disturbances={"inflow_1": 2e-6})
    flow = minimum.flows((3.0, 3.0))[0] + 2e-6
    expected = (flow / minimum.outlet[0]) ** 2 / (2 * 9.81)
    assert point.state[0] == pytest.approx(expected, rel=1e-13)
    np.testing.assert_array_equal(point.disturbances, (2e-6, 0.0))


@pytest.mark.parametrize("outflow", [torricelli, torricelli_by_choice])
@pytest.mark.parametrize("initial", [0.0, 1e-6, 0.5, 1.0])
def test_either_form_of_the_square_root_from_any_start(make_process, outflow, initial):
    process = make_process(
        lambda x, u, d: [0.01 * u[0] - outflow(x[0]), outflow(x[0]) - outflow(x[1], 0.2)],
        levels=2,
        pumps=1,
        initial=initial,
    )
    point = find_equilibrium(process, {"pump_1": 4.0})
    np.testing.assert_allclose(point.state, (0.16, 0.04), rtol=1e-13)


def test_laws_other_than_the_square_root(make_process):
    # A weir, a linear outflow and a level-dependent pump curve.
    process = make_process(
        lambda x, u, d: [
            0.1 * u[0] * (1 - x[0]) - ca.fmax(x[0] - 0.2, 0) ** 1.5,
            ca.fmax(x[0] - 0.2, 0) ** 1.5 - 0.3 * x[1],
        ],
        levels=2,
        pumps=1,
    )
    level = find_equilibrium(process, {"pump_1": 1.0}).state
    low, high = 0.2, 1.0  # bisection on the one equation of the first tank
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if 0.1 * (1 - middle) > (middle - 0.2) ** 1.5 else (low, middle)
    assert level[0] == pytest.approx(low, rel=1e-13)
    assert level[1] == pytest.approx((low - 0.2) ** 1.5 / 0.3, rel=1e-12)


def test_all_pumps_off_leaves_empty_tanks_and_says_so(minimum):
    point = find_equilibrium(minimum.process, {"pump_1": 0.0, "pump_2": 0.0})
    np.testing.assert_array_equal(point.state, 0.0)
    assert len(point.warnings) == 6
    assert point.warnings[2].startswith("tank_3.level stands on its floor")


def test_only_the_tank_without_flow_is_empty(minimum):
    process = minimum.process
    point = find_equilibrium(process, {"pump_1": 3.0, "pump_2": 0.0})
    np.testing.assert_allclose(point.state, minimum.levels((3.0, 0.0)), rtol=1e-13)
    assert point.state[2] == 0.0
    assert [text.split()[0] for text in point.warnings] == ["tank_3.level", "pump_2"]


def test_an_empty_tank_with_a_smooth_law_is_found(make_process):
    process = make_process(lambda x, u, d: [0.01 * u[0] - 0.1 * x[0]], levels=1, pumps=1)
    assert find_equilibrium(process, {"pump_1": 0.0}).state[0] == 0.0


def test_inflow_without_outlet_accumulates(make_process):
    process = make_process(
        lambda x, u, d: [0.01 * u[0] - torricelli(x[0]), torricelli(x[0])], levels=2, pumps=1
    )
    with pytest.raises(NoEquilibrium, match=r"tank_2\.level accumulates.*rises by 0\.04 m/s"):
        find_equilibrium(process, {"pump_1": 4.0})


@pytest.mark.thorough
def test_tanks_that_only_exchange_accumulate_together(make_process):
    def rates(x, u, d):
        exchange = 0.1 * (x[0] - x[1])
        return [0.01 * u[0] - exchange, exchange]

    with pytest.raises(NoEquilibrium, match=r"tank_1\.level and tank_2\.level accumulate together"):
        find_equilibrium(make_process(rates, levels=2, pumps=1), {"pump_1": 1.0})


def test_a_balanced_integrator_keeps_its_level_with_a_warning(make_process):
    process = make_process(lambda x, u, d: [u[0] - u[1]], levels=1, pumps=2, initial=0.3)
    point = find_equilibrium(process, {"pump_1": 2.5, "pump_2": 2.5})
    assert point.state[0] == pytest.approx(0.3, rel=1e-15)
    assert point.warnings[0].startswith("tank_1.level may take other values")


def test_an_integrating_tank_is_held_by_the_pump_that_is_free(make_process):
    process = make_process(lambda x, u, d: [0.1 * (d[0] + u[0] - 3)], 1, 1, inflows=1)
    point = find_equilibrium(process, outputs={"level_1": 0.7}, disturbances={"inflow_1": 0.5})
    assert point.inputs[0] == pytest.approx(2.5, rel=1e-15)
    assert point.state[0] == pytest.approx(0.7, rel=1e-15)
    assert point.warnings == ()


def test_more_drawn_than_flows_in(make_process):
    process = make_process(lambda x, u, d: [0.01 * u[0] + d[0] - torricelli(x[0])], 1, 1, inflows=1)
    with pytest.raises(NoEquilibrium, match=r"tank_1\.level would have to fall below its floor"):
        find_equilibrium(process, {"pump_1": 1.0}, disturbances={"inflow_1": -0.02})


def test_more_flows_in_than_is_drawn_from_a_lying_cylinder(tmp_path):
    drum = """
        name = "drum"
        sampling_period = "2 s"
        controlled = ["level_1"]
        [reservoirs.downstream]
        [tanks.drum]
        shape = "horizontal cylinder"
        diameter = "2.4 m"
        length = "6 m"
        [pumps.pump_1]
        source = "drum"
        destination = "downstream"
        gain = "0.8 m^3/(h %)"
        range = ["0 %", "100 %"]
        nominal = "NOMINAL %"
        [flows.feed]
        destination = "drum"
        range = ["20 m^3/h", "60 m^3/h"]
        nominal = "40 m^3/h"
        [sensors.level_1]
        tank = "drum"
        range = ["0 m", "2.4 m"]
    """
    file = tmp_path / "drum.toml"
    for nominal, reason in (("40", "finds no rest: where"), ("60", "would have to fall below its")):
        file.write_text(drum.replace("NOMINAL", nominal), encoding="utf-8")
        with pytest.raises(NoEquilibrium, match=rf"drum\.level {reason}"):
            find_equilibrium(load_process(file))


def test_an_input_outside_its_range_is_named_with_its_value(minimum):
    levels = minimum.levels((-0.5, 4.0))
    lower_flows = minimum.flows((-0.5, 4.0))[:2]
    assert min(lower_flows) > 0  # the lower tanks alone do not show that a flow is negative
    asked = {"level_1": 50 * levels[0], "level_2": 50 * levels[1]}
    with pytest.raises(
        NoEquilibrium,
        match=r"pump_1 would have to be -0\.5 V, outside its range from 0 V to 10 V",
    ):
        find_equilibrium(minimum.process, outputs=asked)


def test_a_pump_too_small_is_named_with_its_value(make_process):
    process = make_process(lambda x, u, d: [0.01 * u[0] - torricelli(x[0], 0.2)], 1, 1)
    needed = 0.2 * math.sqrt(0.64) / 0.01
    with pytest.raises(NoEquilibrium, match=rf"pump_1 would have to be {needed:.4g} V"):
        find_equilibrium(process, outputs={"level_1": 0.64})


def test_a_level_above_its_rim_is_named_with_both_heights(minimum):
    height = minimum.levels((6.0, 6.0))[0] * 100
    with pytest.raises(
        NoEquilibrium,
        match=rf"tank_1\.level would stand at {height:.4g} cm, above its rim at 20 cm",
    ):
        find_equilibrium(minimum.process, {"pump_1": 6.0, "pump_2": 6.0})


def test_a_level_just_above_its_rim_is_told_from_it(make_process):
    """The inflow that a level of 1.000013 m lets out; that level and the rim are both "1 m" in
    four digits."""
    process = make_process(lambda x, u, d: [0.02 * u[0] - torricelli(x[0])], 1, 1)
    pumped = 5.0 * math.sqrt(1.000013)
    with pytest.raises(NoEquilibrium, match=r"would stand at 1\.00001 m, above its rim at 1 m"):
        find_equilibrium(process, {"pump_1": pumped})


def test_outputs_that_hang_together_cannot_be_chosen(make_process):
    process = make_process(
        lambda x, u, d: [0.01 * (u[0] + u[1]) - torricelli(x[0])],
        levels=1,
        pumps=2,
        measure=lambda x: [x[0], 2 * x[0]],
    )
    with pytest.raises(NoEquilibrium, match="level_1 and level_2 cannot take the asked values"):
        find_equilibrium(process, outputs={"level_1": 0.2, "level_2": 0.3})


def test_consistent_outputs_that_leave_an_input_open_warn(make_process):
    process = make_process(
        lambda x, u, d: [0.01 * (u[0] + u[1]) - torricelli(x[0])],
        levels=1,
        pumps=2,
        measure=lambda x: [x[0], 2 * x[0]],
    )
    point = find_equilibrium(process, outputs={"level_1": 0.25, "level_2": 0.5})
    assert point.inputs.sum() == pytest.approx(5.0, rel=1e-12)
    assert "pump_1 and pump_2 may take other values" in point.warnings[0]


def test_an_equation_without_a_root_is_refused(make_process):
    process = make_process(lambda x, u, d: [0.01 * u[0] - 1 - x[0] ** 2], 1, 1)
    with pytest.raises(NoEquilibrium, match=r"tank_1\.level would have to fall below its floor"):
        find_equilibrium(process, {"pump_1": 5.0})


def test_equations_without_a_derivative_are_refused_in_words(make_process):
    process = make_process(lambda x, u, d: [0.1 * u[0] - ca.sqrt(x[0] - 2)], 1, 1)
    with pytest.raises(NoEquilibrium, match=r"tank_1\.level have no finite derivative"):
        find_equilibrium(process, {"pump_1": 5.0})


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"inputs": {"pump_3": 1.0}}, r"inputs\.pump_3: got 'pump_3', expected one of pump_1, pu"),
        ({"inputs": {"pmp_1": 1.0}}, r"perhaps 'pump_1' was meant"),
        (
            {"inputs": {"pump_1": 11.0}},
            r"inputs\.pump_1: got '11 V', expected a value from 0 to 10 V",
        ),
        ({"inputs": {"pump_1": -1e-9}}, r"inputs\.pump_1: got '-1e-09 V'"),
        ({"inputs": {"pump_1": math.nan}}, r"inputs\.pump_1: got nan"),
        ({"inputs": {"pump_1": True}}, r"inputs\.pump_1: got True"),
        ({"inputs": {"pump_1": "3 V"}}, r"inputs\.pump_1: got '3 V'"),
        ({"outputs": {"level_9": 5.0, "level_1": 5.0}}, r"outputs\.level_9"),
        ({"outputs": {"level_1": 10.5, "level_2": 5.0}}, r"outputs\.level_1: got '10.5 V'"),
        ({"outputs": {"level_1": 5.0}}, r"expected exactly 2 outputs.*\(pump_1, pump_2\)"),
        ({"outputs": dict.fromkeys(("level_1", "level_2", "level_3"), 5.0)}, r"exactly 2 outputs"),
        (
            {"inputs": {"pump_1": 3.0, "pump_2": 3.0}, "outputs": {"level_1": 6.0}},
            r"got 'level_1', expected as many outputs as inputs that are not given \(0: none\)",
        ),
        (
            {"inputs": {"pump_1": 3.0}, "outputs": {"level_1": 6.0, "level_2": 6.0}},
            r"not given \(1: pump_2\); give either an input or an output",
        ),
        ({"disturbances": {"inflow_1": 1.0}}, r"disturbances\.inflow_1: got '1 m\^3/s'"),
        ({"disturbances": {"leak": 1.0}}, r"disturbances\.leak"),
    ],
)
def test_what_cannot_be_asked(minimum, asked, message):
    with pytest.raises(InputError, match=message):
        find_equilibrium(minimum.process, **asked)


@pytest.mark.parametrize("seed", range(20))
def test_a_random_network_of_tanks(make_process, seed):
    # Each tank passes shares of its outflow on to the others, loops included: the flows solve
    # q = R q + F u, and the levels follow from Torricelli's law.
    numbers = np.random.default_rng(seed)
    tanks, pumps = 8, 3
    routing = numbers.uniform(0, 1, (tanks, tanks)) * (numbers.uniform(0, 1, (tanks, tanks)) < 0.4)
    routing *= 0.9 / np.maximum(routing.sum(axis=0), 0.9)
    feeds = numbers.uniform(0.1, 1, (tanks, pumps)) * 1e-3
    outlets = numbers.uniform(0.05, 0.2, tanks)
    voltages = numbers.uniform(1, 9, pumps)
    flows = np.linalg.solve(np.eye(tanks) - routing, feeds @ voltages)
    levels = (flows / outlets) ** 2
    outlets *= np.sqrt(levels / np.minimum(levels, 0.95))  # no level above its rim
    levels = (flows / outlets) ** 2

    def rates(x, u, d):
        q = [outlets[i] * ca.sqrt(ca.fmax(x[i], 0)) for i in range(tanks)]
        return [
            sum(routing[i, j] * q[j] for j in range(tanks))
            + sum(feeds[i, j] * u[j] for j in range(pumps))
            - q[i]
            for i in range(tanks)
        ]

    process = make_process(rates, tanks, pumps, initial=float(numbers.uniform(0, 1)))
    given = {f"pump_{i + 1}": float(v) for i, v in enumerate(voltages)}
    np.testing.assert_allclose(find_equilibrium(process, given).state, levels, rtol=1e-11)
    asked = {f"level_{i + 1}": float(levels[i]) for i in range(pumps)}
    point = find_equilibrium(process, outputs=asked)
    sensitivity = np.linalg.cond(np.linalg.solve(np.eye(tanks) - routing, feeds)[:pumps])
    np.testing.assert_allclose(point.inputs, voltages, rtol=1e-13 * sensitivity)


@pytest.mark.parametrize("value", ["quadruple-tank", None, 3])
def test_what_is_no_process_is_refused_in_words(value):
    for search in (find_equilibrium, analyse):
        with refused(expected="a Process", remedy="read it with load_process"):
            search(value)


#: Under pressure more goes out than comes in, into a cone that has no area at its tip.
SLENDER = """
name = "slender"
sampling_period = "1 s"
controlled = ["level_1"]
manipulated = ["feed"]
[reservoirs.basin]
[tanks.tank_1]
shape = "horizontal cylinder"
diameter = "4.86373 m"
length = "0.520017 m"
[tanks.tank_2]
shape = "cone"
rim_diameter = "4.32453 mm"
height = "5.51613 m"
[valves.valve_1]
source = "tank_1"
destination = "tank_2"
kv = "7.39506e-05 m^3/s"
range = ["0 %", "100 %"]
nominal = "35.6 %"
pressure = "0.5 bar"
line_kv = "0.0171453 m^3/s"
[valves.valve_2]
source = "tank_2"
destination = "basin"
kv = "7.76304e-05 m^3/s"
range = ["0 %", "100 %"]
nominal = "80.8 %"
characteristic = "quick opening"
line_kv = "0.0326833 m^3/s"
[flows.feed]
destination = "tank_1"
range = ["0 l/s", "1 l/s"]
nominal = "0 l/s"
[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "5 cm"]
"""


@pytest.mark.thorough
def test_a_search_that_leaves_the_numbers_ends_in_words(tmp_path):
    """It comes by a tip, where 1/A has no value: NumPy warned, which is an error of the tests."""
    with pytest.raises(NoEquilibrium, match="fall below its floor"):
        find_equilibrium(plant_of(tmp_path, SLENDER).process)


def test_a_pump_that_lifts_nothing_where_the_search_begins_is_found_above():
    """At 70 % the pump of the wet well does not reach 9.5 m; at 74 % it gives the inflow."""
    process = load_process("wet-well")
    numbers = {"duty.static_head": 9.55, "well.weir": 2.21, "level.gain": 0.00364}
    parameters = tuple(
        replace(s, initial=numbers.get(s.name, s.initial)) for s in process.parameters
    )
    point = find_equilibrium(replace(process, parameters=parameters), outputs={"level": 0.01})
    assert 0.7 < point.as_dict()["duty"] < 0.8
    assert point.residual < 1e-12
