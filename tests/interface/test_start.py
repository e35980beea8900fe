"""Closed loops that begin elsewhere than at rest."""

import numpy as np
import pytest
from refusals import refused
from scipy.integrate import solve_ivp
from scipy.io import savemat

import clepsydra as cl

#: Johansson's table I in cm and s: sections, holes, pumps, shares to the lower tanks.
A, HOLES = np.array([28.0, 32.0, 28.0, 32.0]), np.array([0.071, 0.057, 0.071, 0.057])
PUMPS, SHARES, VOLTS_PER_CM = np.array([3.33, 3.35]), np.array([0.7, 0.6]), 0.5
#: Calm enough for the pumps to stay between their limits: nothing but the law itself acts.
GAIN, TIME = 0.45, 60.0
SETPOINTS = np.array([6.0, 5.0])


def _flow(level):
    """Torricelli, but for the smooth law that `signed_root` documents, below 1 mm."""
    small = level / 0.1
    laminar = np.sqrt(0.1) * (45 * small - 18 * small**3 + 5 * small**5) / 32
    root = np.where(level < 0.1, laminar, np.sqrt(np.maximum(level, 0.1)))
    return np.sqrt(2 * 981.0) * HOLES * root


def _by_hand(samples, integral, level):
    """A discrete PI controller and solve_ivp: samples, pumps [V] and levels [cm]."""

    def rates(_, level, volts):
        out, lower, upper = _flow(level), SHARES * PUMPS * volts, (1 - SHARES) * PUMPS * volts
        into = np.array([lower[0] + out[2], lower[1] + out[3], upper[1], upper[0]])
        return (into - out) / A

    volts, levels = [], []
    for _ in range(samples):
        error = SETPOINTS - VOLTS_PER_CM * level[:2]
        asked = GAIN * error + integral
        assert np.all((asked >= 0.0) & (asked <= 10.0))
        volts.append(asked)
        levels.append(level)
        integral = integral + GAIN / TIME * error
        found = solve_ivp(rates, (0.0, 1.0), level, args=(asked,), rtol=1e-10, atol=1e-11)
        level = found.y[:, -1]
    return np.array(volts), np.array(levels)


def words(run):
    return " ".join(str(run).split())


@pytest.fixture(scope="module")
def calm(plant, pi):
    settings = {"K": GAIN, "Ti": f"{TIME} s"}
    return pi.with_values({"level_1": settings, "level_2": settings})


STEPS = [cl.step("level_1", to="6 V", at=0), cl.step("level_2", to="5 V", at=0)]


@pytest.mark.parametrize("way", ["cold", "bumpless"])
def test_pi_control_from_empty_is_that_of_a_loop_written_by_hand(plant, calm, way):
    run = cl.simulate(
        plant,
        calm,
        STEPS,
        duration="10 min",
        start="empty",
        state={"pump_1": "2 V", "pump_2": "1.5 V"},
        controller_start=way,
    )
    integral = np.zeros(2)
    if way == "bumpless":  # u = K e + I stands where the pumps do
        integral = np.array([2.0, 1.5]) - GAIN * SETPOINTS
    volts, levels = _by_hand(600, integral, np.zeros(4))
    for place in range(2):
        assert run.values[f"pump_{place + 1}"] == pytest.approx(volts[:, place], abs=1e-5)
    for place in range(4):
        level = 100.0 * run.values[f"tank_{place + 1}.level"]
        assert level == pytest.approx(levels[:, place], abs=2e-5)


#: Whatever has an integral, or takes up in its first sample what stands at its output.
TAKES_OVER = (
    "simc", "lqi", "lqi_kalman", "glover_mcfarlane", "pole_placement", "feedback_linearisation",
    "variable_structure_pid", "lqr",
)  # fmt: skip


@pytest.mark.parametrize("name", TAKES_OVER)
def test_without_a_bump_every_output_begins_where_its_input_stands(plant, name):
    controller = getattr(cl.design, name)(plant)
    state = {"pump_1": "1.5 V", "pump_2": "4 V", "tank_1.level": "3 cm"}
    run = cl.simulate(plant, controller, start="empty", state=state, duration="20 s")
    assert [run.values[f"pump_{i}"][0] for i in (1, 2)] == pytest.approx([1.5, 4.0], abs=1e-9)
    assert run.values["tank_1.level"][0] == 0.03 and run.values["tank_2.level"][0] == 0.0
    assert "without a bump: pump_1 begins at 1.5 V, pump_2 begins at 4 V" in words(run)


def test_a_cold_controller_begins_with_the_states_that_its_law_declares(plant, pi):
    """K = 3 V/V of 6.13 V and 6.39 V asks for 18.4 V and 19.2 V, and a pump gives 10 V."""
    run = cl.simulate(plant, pi, start="empty", controller_start="cold")
    assert run.values["pump_1"][0] == run.values["pump_2"][0] == 10.0
    said = {"controller.level_1.integral": "-15 V"}
    run = cl.simulate(plant, pi, start="empty", controller_start="cold", state=said)
    rest = plant.point.as_dict()["level_1"]
    assert run.values["pump_1"][0] == pytest.approx(3.0 * rest - 15.0, abs=1e-9)


def test_a_law_that_cannot_stand_still_says_that_it_moves(plant):
    """ADRC has no integral that takes up its error."""
    run = cl.simulate(plant, cl.design.disturbance_rejection(plant), start="empty")
    moves = "as from manual, which moves its outputs: pump_1 goes from 3 V to 10 V at once"
    assert moves in words(run)


def test_the_way_from_empty_is_scored_as_a_step_from_where_the_levels_stand(plant, pi):
    run = cl.simulate(plant, pi, STEPS, start="empty", controller_start="cold", duration="20 min")
    sizes = {part.signal: part.size for part in run.scenario.segments}
    assert sizes == {"level_1": 6.0, "level_2": 5.0}
    for name, target in (("level_1", 6.0), ("level_2", 5.0)):
        over = run.values[name].max() / target - 1.0
        assert run.scores[f"overshoot[{name}]"] == pytest.approx(100.0 * over, rel=1e-9)


def test_a_load_at_the_start_is_judged_where_every_level_begins_at_its_setpoint(plant, pi):
    """Only the pump stands elsewhere: there is no way to a setpoint that the load could be in."""
    load = cl.disturbance("inflow_1", "5 cm^3/s", at=0)
    run = cl.simulate(plant, pi, [load], state={"pump_1": "2.9 V"}, duration="2 min")
    assert [(part.kind, part.signal) for part in run.scenario.segments] == [("load", "inflow_1")]
    assert run.scores["iae_load[level_1]"] == pytest.approx(run.scores["iae[level_1]"], rel=0.02)


def test_a_loop_can_begin_at_another_operating_point(plant, pi):
    lower = plant.at(outputs={"level_1": "4 V", "level_2": "5 V"})
    run = cl.simulate(plant, pi, start=lower)
    at = lower.point.as_dict()
    for name in ("tank_1.level", "tank_3.level", "pump_1", "pump_2"):
        assert run.values[name][0] == pytest.approx(at[name], rel=1e-9)
    end = plant.point.as_dict()
    assert run.values["level_1"][-1] == pytest.approx(end["level_1"], abs=1e-3)
    alone = cl.simulate(plant, start=lower, duration="1 min")
    assert alone.values["tank_1.level"][-1] == pytest.approx(at["tank_1.level"], abs=1e-9)


def test_a_regulator_from_a_mat_file_goes_from_empty_to_sixty_percent_in_a_line(plant, tmp_path):
    gain, time = np.array([3.0, 2.7]), np.array([30.0, 40.0])
    matrices = np.zeros((2, 2)), np.diag(gain / time), np.eye(2), np.diag(gain)
    path = tmp_path / "reg1.mat"
    savemat(path, dict(zip("ABCD", matrices, strict=True)))
    steps = [cl.step("level_1", to="60 %", at=0), cl.step("level_2", to="60 %", at=0)]
    regulator = cl.design.regulator(plant, path)
    run = cl.simulate(plant, regulator, steps, start="empty", controller_start="cold", duration=900)
    assert run.values["level_1"][0] == run.values["level_2"][0] == 0.0
    assert run.values["pump_1"][0] == run.values["pump_2"][0] == 10.0  # u° + K e, limited
    assert [run.values[f"level_{i}"][-1] for i in (1, 2)] == pytest.approx([6.0, 6.0], abs=1e-3)


def test_states_at_their_values_at_rest_change_nothing_but_rounding(plant, pi):
    rest = cl.simulate(plant, pi, [cl.step("level_1", "1 V", at=5)], duration="2 min")
    level = 100.0 * plant.point.as_dict()["tank_1.level"]
    same = cl.simulate(
        plant, pi, [cl.step("level_1", "1 V", at=5)], duration="2 min",
        state={"tank_1.level": float(level)},
    )  # fmt: skip
    assert same.values["level_1"] == pytest.approx(rest.values["level_1"], abs=1e-9)


MISTAKES = {
    "start": ({"start": "emtpy"}, {"place": "start", "value": "emtpy", "remedy": "'empty' was"}),
    "no start": ({"start": "banana"}, {"place": "start", "expected": "one of rest, empty"}),
    "state": (
        {"state": {"tank_1.levle": "5 cm"}},
        {"place": "state", "value": "tank_1.levle", "remedy": "'tank_1.level' was meant"},
    ),
    "no start at all": ({"start": None}, {"place": "start", "remedy": "final_state"}),
    "unit": ({"state": {"tank_1.level": "5 V"}}, {"place": "state, tank_1.level", "value": "5 V"}),
    "range": ({"state": {"tank_1.level": "5 m"}}, {"place": "state, tank_1.level"}),
    "other plant": ({"start": cl.load("three-tanks")}, {"place": "start", "expected": "tank_4"}),
}


@pytest.mark.parametrize("controlled", [True, False])
@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_wrong_start_is_refused_with_and_without_a_controller(plant, pi, mistake, controlled):
    wrong, told = MISTAKES[mistake]
    with refused(**told):
        cl.simulate(plant, pi if controlled else None, duration="10 s", **wrong)


def test_a_wrong_start_of_a_controller_is_refused(plant, pi):
    with refused(place="controller_start", value="clod", remedy="'cold' was meant"):
        cl.simulate(plant, pi, start="empty", controller_start="clod")
    with refused(place="controller_start", expected="a controller that starts"):
        cl.simulate(plant, start="empty", controller_start="cold")
    with refused(place="state", remedy="'controller.level_1.integral' was meant"):
        cl.simulate(plant, pi, start="empty", state={"controller.level_1.integrl": 0.0})
    last = cl.simulate(plant, pi, [], duration="10 s").final_state
    with refused(place="start", expected="a controller that goes on"):
        cl.simulate(plant, start=last)


def test_a_profile_of_an_input_is_refused_under_a_controller(plant, pi, tmp_path):
    path = tmp_path / "pumps.csv"
    path.write_text("time [s],pump_1 [V]\n0,3\n10,3.5\n", encoding="utf-8")
    with refused(value="pump_1", expected="since the controller moves the inputs"):
        cl.simulate(plant, pi, cl.profile(path, plant), duration="20 s")
