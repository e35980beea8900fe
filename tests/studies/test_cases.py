"""Other operating points and variants of a study: the same steps, frozen settings or new ones."""

import pytest
from refusals import refused

import clepsydra as cl

#: A tank that a pump fills and a hole empties; with a linear outlet it has one model at all levels.
TANK = """
name = "tank"
title = "A tank that a pump fills"
source = "written for this test"
sampling_period = "2 s"
controlled = ["level"]

[operating_point]
level = "50 %"

[reservoirs.basin]

[tanks.tank]
area = "0.1 m^2"
height = "1 m"

[orifices.outlet]
source = "tank"
destination = "basin"
area = "2 cm^2"

[flows.inflow]
destination = "tank"
nominal = "0.1 l/s"
range = ["0 l/s", "0.5 l/s"]
step = "0.05 l/s"

[pumps.pump]
source = "basin"
destination = "tank"
gain = "3 l/s"
range = ["0 %", "100 %"]

[sensors.level]
tank = "tank"
range = ["0 cm", "100 cm"]

[variants.slow-pump.pumps.pump]
gain = "1.5 l/s"
"""
LINEAR = (
    '[orifices.outlet]\nsource = "tank"\ndestination = "basin"\narea = "2 cm^2"',
    '[linear_outlets.outlet]\nsource = "tank"\ndestination = "basin"\ncoefficient = "20 cm^2/s"',
)
SCENARIO = """
[scenario]
duration = "30 min"
noise = "20 min"
[[scenario.setpoint]]
signal = "level"
at = "1 min"
by = "5 %"
[[scenario.load]]
signal = "inflow"
at = "10 min"
by = "0.05 l/s"
"""
WRITTEN = """
[controllers.PI.loops.level]
measurement = "level"
output = "pump"
actions = "PI"
action = "reverse"
gain = "3 %/%"
integral_time = "90 s"
setpoint_weight = 0.7
"""
SIMC = '\n[controllers.PI]\ndesign = "simc"\n'
LOW = '\n[cases."at 20 %"]\noperating_point = { level = "20 %" }\n'
ANEW = 'settings = "designed_anew"\n'


@pytest.fixture
def study(tmp_path):
    """Return a function: texts of a study of the tank, and edits of its process, to its result."""

    def made(*texts, edits=(), process="tank.toml"):
        tank = TANK
        for old, new in edits:
            assert old in tank
            tank = tank.replace(old, new)
        (tmp_path / "tank.toml").write_text(tank, encoding="utf-8")
        text = "\n".join([f'process = "{process}"', *texts])
        (tmp_path / "study.toml").write_text(text, encoding="utf-8")
        return cl.study(tmp_path / "study.toml")

    return made


def scores_of(candidate):
    return dict(candidate.scores)


def test_a_linear_tank_does_the_same_at_every_level(study):
    """The integral takes up the other rest, and nothing else differs."""
    found = study(SCENARIO, WRITTEN, LOW, edits=[LINEAR])
    base, low = found["PI"].cases["base case"], found["PI"].cases["at 20 %"]
    pumped = scores_of(base)["volume_pumped[pump]"] - scores_of(low)["volume_pumped[pump]"]
    assert pumped == pytest.approx(20e-4 * 0.3 * 1800.0)  # [m³] through the outlet, for 30 min
    more = {**scores_of(low), "volume_pumped[pump]": scores_of(base)["volume_pumped[pump]"]}
    assert more == pytest.approx(scores_of(base), rel=1e-7, abs=1e-9)
    assert low.maximum_sensitivity == pytest.approx(base.maximum_sensitivity, rel=1e-9)
    levels = [each.run.values["level"] for each in (base, low)]
    assert levels[0] - levels[1] == pytest.approx(0.3, abs=1e-9)


def test_frozen_settings_do_what_a_study_at_that_point_with_these_settings_does(study):
    found = study(SCENARIO, WRITTEN, LOW)["PI"]
    alone = study(SCENARIO, WRITTEN, edits=[('level = "50 %"', 'level = "20 %"')])["PI"]
    low = found.cases["at 20 %"]
    assert scores_of(low) == pytest.approx(scores_of(alone), rel=1e-7, abs=1e-9)
    assert low.maximum_sensitivity == pytest.approx(alone.maximum_sensitivity, rel=1e-9)
    assert scores_of(low)["iae[level]"] != pytest.approx(scores_of(found)["iae[level]"], rel=1e-3)


def test_designed_anew_is_a_study_of_that_point(study):
    found = study(SCENARIO, SIMC, LOW, ANEW)
    alone = study(SCENARIO, SIMC, edits=[('level = "50 %"', 'level = "20 %"')])
    low = found["PI"].cases["at 20 %"]
    assert low.controller.values == alone["PI"].controller.values
    assert low.controller.values != found["PI"].controller.values
    assert scores_of(low) == scores_of(alone["PI"])
    assert found.cases["at 20 %"].settings == "designed_anew"
    (row,) = [line for line in str(alone).splitlines() if line.startswith("level by pump")]
    assert all(cell in str(found) for cell in row.split()) and "designed anew" in str(found)


def test_a_variant_keeps_the_settings_or_gets_its_own(study):
    slow = '[cases.slow]\nvariant = "slow-pump"\n'
    found = study(SCENARIO, SIMC, slow, f'[cases.anew]\nvariant = "slow-pump"\n{ANEW}')
    alone = study(SCENARIO, SIMC, process="tank.toml:slow-pump")["PI"]
    gain = "level.proportional_gain"
    frozen, anew = (found["PI"].cases[name] for name in ("slow", "anew"))
    assert frozen.controller.values == found["PI"].controller.values
    assert anew.controller.values[gain] == alone.controller.values[gain]
    assert anew.controller.values[gain] == pytest.approx(2 * frozen.controller.values[gain])
    assert frozen.maximum_sensitivity < anew.maximum_sensitivity
    assert found.cases["slow"].process.variant == ("slow-pump",)


def test_a_frozen_output_goes_no_further_than_what_it_moves(study):
    narrow = ('[variants.slow-pump.pumps.pump]\ngain = "1.5 l/s"',
              '[variants.slow-pump.pumps.pump]\nrange = ["5 %", "25 %"]')  # fmt: skip
    found = study(SCENARIO, WRITTEN, '[cases.slow]\nvariant = "slow-pump"\n', edits=[narrow])["PI"]
    limits = [found.cases["slow"].controller.values[f"pump.{end}_limit"] for end in ("low", "high")]
    assert limits == [0.05, 0.25]
    assert found.cases["slow"].run.values["pump"].max() == 0.25 < found.run.values["pump"].max()


def test_the_default_scenario_takes_the_same_steps(study):
    found = study(WRITTEN, LOW)
    base, low = found.scenario, found.cases["at 20 %"].scenario
    assert [each.size for each in low.segments] == [each.size for each in base.segments]
    assert low.setpoints[:, 0] == pytest.approx(base.setpoints[:, 0] - 0.3, abs=1e-12)
    assert (low.noise == base.noise).all()


def test_one_that_is_unstable_in_a_case_comes_last_and_is_told_so(study):
    """The faster of two is the better one but where the pump gives twenty times the flow."""
    tight = WRITTEN.replace("controllers.PI", "controllers.tight").replace("3 %/%", "2.4 %/%")
    slow = WRITTEN.replace("controllers.PI", "controllers.calm").replace("3 %/%", "0.8 %/%")
    strong = ('[variants.slow-pump.pumps.pump]\ngain = "1.5 l/s"',
              '[variants.slow-pump.pumps.pump]\ngain = "60 l/s"')  # fmt: skip
    alone = study(SCENARIO, tight, slow)
    assert [each.controller.name for each in alone.ranking] == ["tight", "calm"]
    found = study(SCENARIO, tight, slow, '[cases.strong]\nvariant = "slow-pump"\n', edits=[strong])
    assert [each.controller.name for each in found.ranking] == ["calm", "tight"]
    assert found["tight"].cases["base case"].standing.name == "ROBUST"
    assert found["tight"].standing.name == "UNSAFE"
    assert "In the worst case (strong): unsafe: " in found["tight"].reason
    assert "each controller's worst one counts" in found.rule and "worst" not in alone.rule
    only = study(SCENARIO, tight, '[cases.strong]\nvariant = "slow-pump"\n', edits=[strong])
    said = "can be recommended for every case of A tank that a pump fills; the least bad is tight: "
    assert f"{said}in the worst case (strong): unsafe: unstable" in only.verdict
    assert "Not strong: unstable." in str(only)


def test_the_largest_error_beside_the_best_of_a_case_decides(study):
    other = WRITTEN.replace("controllers.PI", "controllers.other").replace("90 s", "200 s")
    found = study(SCENARIO, WRITTEN, other, LOW, '[ranking]\nscores = ["iae"]')
    for each in found.ranking:
        errors = []
        for name in ("base case", "at 20 %"):
            own = [other.cases[name].scores["iae[level]"] for other in found.ranking]
            errors.append(each.cases[name].scores["iae[level]"] / min(own))
        assert each.mean_error == pytest.approx(max(errors), rel=1e-12)


def test_it_is_told_in_a_line_and_in_two_tables(study):
    judged = '[ranking]\nscores = ["iae"]'
    found = study(SCENARIO, WRITTEN, SIMC.replace("PI", "other"), LOW, judged)
    told = " ".join(str(found).split())
    low, own = (found.best.cases[name].scores["iae[level]"] for name in ("at 20 %", "base case"))
    assert f"Also at 20 % ({low / own:.2f} times the IAE of the base case)." in told
    assert "error × best" in told and f"{low / own:.2f}" != "1.00"
    peaks = {name: each.maximum_sensitivity for name, each in found.best.cases.items()}
    said = f"with the thinnest margin ({max(peaks, key=peaks.get)}) at max|S|"
    assert f"Robust in every case, {said} {max(peaks.values()):.2f}." in " ".join(
        str(found.shown(why=True)).split()
    )


def test_json_and_report_have_the_cases(study, tmp_path):
    found = study(SCENARIO, WRITTEN, LOW)
    document = found.as_dict()
    case = document["cases"]["at 20 %"]
    assert case["settings"] == "frozen"
    assert case["ranking"][0]["scores"] == document["ranking"][0]["cases"]["at 20 %"]["scores"]
    found.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Cases</" in page and "PI in each case; changes from where it rests there." in page
    found.cases["at 20 %"].report(tmp_path / "low.html")
    plain = study(SCENARIO, WRITTEN)
    assert "cases" not in plain.as_dict() and "cases" not in plain.as_dict()["ranking"][0]
    plain.report(tmp_path / "report.html")
    assert "Cases</" not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_python_takes_plants_by_name(study):
    from_file = study(SCENARIO, WRITTEN, LOW)
    plant = from_file.plant
    events = [cl.step("level", by="5 %", at="1 min")]
    low = plant.at(outputs={"level": "20 %"})
    controller = from_file["PI"].controller
    found = cl.study(plant, [controller], events, duration="10 min", cases={"low": low})
    alone = cl.study(low, [found["PI"].cases["low"].controller], events, duration="10 min")
    assert scores_of(found["PI"].cases["low"]) == scores_of(alone["PI"])
    assert found.cases["low"].plant.point.as_dict()["level"] == pytest.approx(0.2)


def test_laws_of_every_kind_rest_at_another_point():
    """What an integral takes up, whatever model or observer stands beside it."""
    plant = cl.load("quadruple-tank")
    low = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    makers = ("simc", "lqi", "lqi_kalman", "feedback_linearisation", "disturbance_rejection")
    controllers = [getattr(cl.design, name)(plant).named(name) for name in makers]
    found = cl.study(plant, controllers, [], duration="1 min", cases={"low": low})
    for name in makers:
        run = found[name].cases["low"].run
        for pump in ("pump_1", "pump_2"):
            assert run.values[pump] == pytest.approx(low.point.as_dict()[pump], abs=1e-5), name


def test_a_design_that_does_not_apply_in_a_case_is_told_with_the_case(study):
    """A level that settles by itself sooner than it is to be arrested, as a low one does."""
    arrest = '[controllers.arrest]\ndesign = "arrest_time"\narrest_time = "250 s"\n'
    found = study(SCENARIO, arrest, WRITTEN, LOW, ANEW)
    assert found["arrest"].cases["at 20 %"] is None
    assert found.ranking[-1].controller.name == "arrest"
    assert found["arrest"].reason.startswith("Does not apply in a case (at 20 %).")
    told = " ".join(str(found.shown(refused=True)).split())
    assert "arrest does not apply in the case at 20 %: " in told


def test_settings_in_other_units_do_not_apply():
    """A tank whose levels and pumps are in percent, and its variant in volts."""
    plant, volts = cl.load("laboratory-four-tanks"), cl.load("laboratory-four-tanks:volts")
    found = cl.study(plant, [cl.design.simc(plant)], cases={"volts": volts})
    ((name, reason),) = found.cases["volts"].not_applicable
    assert name == "PI, SIMC" and "laboratory-four-tanks:volts has no level_1 in" in reason
    assert found.best.cases["volts"] is None


def test_one_controller_by_its_name_is_tried_in_the_base_case_alone(study, tmp_path):
    study(SCENARIO, WRITTEN, LOW)
    found = cl.study(tmp_path / "study.toml", only="PI")
    assert found.cases == {} and found.best.cases == {}


@pytest.mark.thorough
def test_every_design_stands_beside_ones_own_in_every_case(study):
    texts = (SCENARIO, WRITTEN, LOW, '[cases.slow]\nvariant = "slow-pump"\n', ANEW)
    found = study('designs = "all"', *texts)
    names = {each.controller.name for each in found.ranking}
    assert {"PI", "PI, SIMC", "PI, SIMC, tuned"} < names
    for case in found.cases.values():
        assert {each.controller.name for each in case.ranking} == names
    frozen, anew = (found["PI, SIMC, tuned"].cases[name] for name in ("at 20 %", "slow"))
    assert frozen.controller.values == found["PI, SIMC, tuned"].controller.values
    assert anew.tuning is not None and anew.controller.values != frozen.controller.values


def test_a_step_that_a_case_cannot_hold_and_another_sampling_period_are_refused(study):
    weak = ('gain = "1.5 l/s"', 'gain = "0.55 l/s"')
    slow = '[cases.slow]\nvariant = "slow-pump"\n'
    with refused(place="cases.slow", expected="setpoint steps that can be held there"):
        study(SCENARIO, WRITTEN, slow, edits=[weak])
    sampled = ("[variants.slow-pump.pumps.pump]", '[variants.slow-pump]\nsampling_period = "4 s"')
    pump = ('gain = "1.5 l/s"', "")
    with refused(place="cases.slow.variant", expected="the sampling period of the study, 2 s"):
        study(SCENARIO, WRITTEN, slow, edits=[sampled, pump])
    anew = study(SCENARIO, WRITTEN, slow, ANEW, edits=[sampled, pump])
    assert anew.cases["slow"].scenario.sampling_period == 4.0
