"""Controllers in the words and units of their own table, on their plant and on others."""

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl


def at_rest(plant, controller):
    """Return how far anything moves when nothing happens, as a share of its range."""
    run = cl.simulate(plant, controller, [], duration="10 min")
    spans = [(signal.name, signal.span) for signal in plant.process.measurements]
    return max(np.ptp(run.values[name]) / span for name, span in spans)


def test_a_gain_is_in_percent_per_percent_of_the_ranges(basin):
    """The level of the basin in mA, its valve in %: K in %/% is not the gain of the law."""
    pi = cl.design.simc(basin)
    (measured,), (moved,) = pi.measurements, pi.manipulated
    signals = basin.process.signal(measured), basin.process.signal(moved)
    factor = signals[1].percent_span / signals[0].percent_span
    changed = pi.with_values({measured: {"K": "2 %/%"}})
    assert abs(changed.values["level.proportional_gain"]) == pytest.approx(2.0 * factor, rel=1e-12)
    assert np.sign(changed.values["level.proportional_gain"]) == np.sign(
        pi.values["level.proportional_gain"]
    )
    same = pi.with_values({measured: {"gain": "200 %/%"}})
    assert same.values["level.proportional_gain"] == pytest.approx(
        100 * changed.values["level.proportional_gain"]
    )
    assert "2.000 %/%" in repr(changed)


@pytest.mark.parametrize(
    ("word", "value", "own", "percent", "as_percent", "as_own"),
    [
        # 1 % of 100 cm³/s for 1 % of 70 cm: 1/0.7 (cm³/s)/cm is 1 %/%.
        ("K", 7.0, "(cm³/s)/cm", "%/%", "4.9", "10"),
        ("Ki", 0.14, "(cm³/s)/cm/s", "%/%/s", "0.098", "0.2"),
    ],
)
def test_a_bare_gain_is_refused_where_it_would_be_two(
    word, value, own, percent, as_percent, as_own
):
    tanks = cl.load("three-tanks")
    form = cl.PidForm("PI", algorithm="isa" if word == "K" else "parallel")
    pi = cl.design.simc(tanks, form=form)
    readings = (
        f"{value:g} {own} is {as_percent} {percent}, and {value:g} {percent} is {as_own} {own}"
    )
    with refused(place=f"values, level_3, {word}", value=value, expected=readings):
        pi.with_values({"level_3": {word: value}})
    found = [
        pi.with_values({"level_3": {word: f"{number} {unit}"}}).settings["level_3"][word]
        for number, unit in ((value, own), (as_percent, percent))
    ]
    assert found[0].value == pytest.approx(found[1].value, rel=1e-12)
    assert found[0].value == pytest.approx(value, rel=1e-12)


def test_a_bare_gain_is_taken_where_both_are_the_same(plant, pi):
    """Volts of 0 to 10 V on both sides: 6 V/V is 6 %/%."""
    changed = pi.with_values({"level_1": {"K": 6}})
    assert changed.settings["level_1"]["K"].value == changed.settings["level_1"]["K"].percent == 6.0


def test_a_direct_acting_loop_stays_one(basin):
    pi = cl.design.simc(basin)
    assert pi.values["level.proportional_gain"] < 0.0
    changed = pi.with_values({"level": {"K": "1 %/%"}})
    assert changed.values["level.proportional_gain"] < 0.0 and at_rest(basin, changed) < 1e-9


def test_what_the_table_shows_can_be_given_back(plant, pi):
    """The numbers of the printed table, given as bare numbers, are the settings."""
    rows = [line.split() for line in repr(pi).splitlines() if line.startswith(" level_")]
    for name, moved, gain, _, time, _, weight, tracking, _ in rows:
        assert moved in pi.manipulated
        back = pi.with_values(
            {name: {"K": float(gain), "Ti": float(time), "b": float(weight),
                    "tracking_time": float(tracking)}}
        )  # fmt: skip
        for key, value in pi.values.items():
            assert back.values[key] == pytest.approx(value, rel=5e-4), (name, key)
    assert len(rows) == 2


def test_settings_are_the_numbers_of_the_table_in_the_units_of_the_file(basin):
    """A level in cm and a pump in V: the gain in V/cm, and in percent of 30 cm and 12 V."""
    tanks = cl.load("three-tanks")
    pi = cl.design.simc(tanks).with_values({"level_3": {"K": "0.005 m^2/s", "Ti": "2 min"}})
    loop = pi.settings["level_3"]
    # 0.005 m^2/s is 50 cm^3/s a cm; 1 % of 100 cm^3/s for 1 % of 70 cm is 1/0.7 cm^3/s a cm.
    assert loop["K"].value == pytest.approx(50.0, rel=1e-12)
    assert loop["K"].percent == pytest.approx(35.0, rel=1e-12)
    assert (loop["K"].unit, loop["K"].percent_unit) == ("(cm³/s)/cm", "%/%")
    assert (loop["Ti"].value, loop["Ti"].unit, loop["Ti"].percent) == (120.0, "s", None)
    assert (loop.moves, loop.action, loop.form) == ("feed", "reverse", cl.PidForm("PI"))
    shown = repr(pi.settings)
    assert shown in repr(pi) and "35.00 %/%   120.0 s" in shown
    direct = cl.design.simc(basin).settings["level"]
    assert direct.action == "direct" and direct["K"].value > 0.0


@pytest.mark.parametrize("algorithm", ["isa", "series", "parallel", "velocity"])
def test_settings_of_one_controller_are_those_of_another(algorithm):
    form = cl.PidForm("PID", algorithm=algorithm)
    pid = cl.design.simc(cl.load("three-tanks"), form=form)
    other = pid.with_values({"level_3": {"K": "0.5 %/%", "b": 0.5}}).with_values(pid.settings)
    assert other.values == pytest.approx(pid.values, rel=1e-12)


def test_what_is_no_setting_leads_to_where_it_stands(plant, pi):
    for owner, name, remedy in (
        (pi, "K", 'settings["level_1"]["K"]'),
        (pi, "setings", "'settings' was meant"),
        (cl.study(plant, [pi], duration="2 min"), "recomended", "'recommended' was meant"),
    ):
        with pytest.raises(AttributeError) as error:
            getattr(owner, name)
        assert isinstance(error.value, cl.InputError) and remedy in error.value.remedy
        assert not hasattr(owner, name)
    for wrong, loop in (("level", pi.settings), ("Kp", pi.settings["level_1"])):
        with pytest.raises(KeyError, match="was meant"):
            loop[wrong]
    lqi = cl.design.lqi(plant)
    assert not lqi.settings
    with pytest.raises(KeyError, match="see its values"):
        lqi.settings["level_1"]


def test_a_tracking_time_follows_its_integral_time(pi):
    changed = pi.with_values({"level_1": {"Ti": "1 min"}})
    assert (
        changed.values["level_1.integral_time"] == changed.values["level_1.tracking_time"] == 60.0
    )
    apart = pi.with_values({"level_1": {"Ti": 60, "tracking_time": 20}})
    assert apart.values["level_1.tracking_time"] == 20.0
    later = apart.with_values({"level_1": {"Ti": 30}})
    assert (later.values["level_1.integral_time"], later.values["level_1.tracking_time"]) == (
        30.0,
        20.0,
    )


def test_the_controller_that_was_changed_stays_as_it_was(pi):
    before = dict(pi.values)
    changed = pi.with_values({"level_1": {"K": 6.0}}, name="bold")
    assert pi.values == before and changed.name == "bold" and pi.name == "PI, SIMC"


@pytest.mark.parametrize("settings", [{"b": 0.5}, {"K": 9.0}, {"Ti": "5 min", "b": 0.0}])
def test_it_is_at_rest_with_other_settings(plant, pi, settings):
    """A smaller setpoint weight needs another integral for the same output."""
    assert at_rest(plant, pi.with_values({"level_1": settings})) < 1e-9


@pytest.mark.parametrize(
    "design",
    [
        cl.design.simc,
        cl.design.lqi,
        pytest.param(cl.design.lqi_kalman, marks=pytest.mark.thorough),
    ],
)
def test_it_is_at_rest_on_another_plant_with_its_signals(plant, design):
    other = plant.at(outputs={"level_1": "4 V", "level_2": "5 V"})
    wider = plant.with_values({"tank_1.area": "40 cm^2", "outlet_1.area": "0.08 cm^2"})
    controller = design(plant)
    assert at_rest(other, controller) < 1e-6 and at_rest(wider, controller) < 1e-6


def test_robustness_by_hand_changes_the_plant_and_not_the_controller(plant, pi):
    nominal = cl.simulate(plant, pi, [cl.step("level_1", "1 V")])
    slower = cl.simulate(
        plant.with_values({"tank_1.area": "56 cm^2"}), pi, [cl.step("level_1", "1 V")]
    )
    assert slower.controller.values == pi.values
    assert slower.scores["rise_time[level_1]"] > 1.3 * nominal.scores["rise_time[level_1]"]


def test_parameters_of_other_laws_have_the_names_of_the_law(plant):
    lqi = cl.design.lqi(plant)
    name = "pump_1.feedback.level_2"
    changed = lqi.with_values({name: "1.5 V/V"})
    assert changed.values[name] == 1.5 and "feedback" in repr(lqi)
    for wrong, remedy in ((f"{name}9", "was meant"), ("feedback_1_2", f"write {name}")):
        with pytest.raises(cl.InputError) as error:
            lqi.with_values({wrong: 1.0})
        assert error.value.value == wrong and remedy in error.value.remedy


def test_a_decoupled_controller_has_loops_too(plant):
    decoupled = cl.design.simc(plant, decoupling="static")
    changed = decoupled.with_values({"level_2": {"K": 1.0}})
    assert changed.values["level_2.proportional_gain"] == 1.0 and at_rest(plant, changed) < 1e-9


@pytest.mark.parametrize(
    ("process", "design"),
    [("wet-well:start-stop", "start_stop_levels"), ("three-tanks", "lqi")],
)
def test_values_go_back_as_they_are(process, design):
    """Also where the process shows mA, percent or cm: bare numbers are those of `values`."""
    given = getattr(cl.design, design)(cl.load(process))
    assert any(p.display_unit not in ("", p.unit) for p in given.law.parameters)
    assert given.with_values(given.values).values == given.values
