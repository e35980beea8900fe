"""The designs as functions of a plant: every one of them, their quantities and their help."""

import inspect

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl

#: What a design needs besides the plant.
NEEDS = {
    "lqi_by_weights": {
        "weights": {
            "states": {"tank_1.level": 4.0, "tank_2.level": 4.0},
            "inputs": {"pump_1": 0.2, "pump_2": 0.2},
            "integrals": {"level_1": 0.1, "level_2": 0.1},
        }
    }
}
SLOW = pytest.mark.thorough
#: Those that are designed at many points, or searched for, are seldom tried.
SEARCHED = ("gain_scheduled_lqi", "gain_scheduled_pid", "glover_mcfarlane", "pole_placement")
NAMES = [
    pytest.param(name, marks=SLOW) if name in SEARCHED else name
    for name in dir(cl.design)
    if name not in ("own", "fuzzy", "regulator")
]


@pytest.mark.sampled
@pytest.mark.parametrize("name", NAMES)
def test_every_design_gives_a_controller_or_a_reason(plant, name):
    try:
        found = getattr(cl.design, name)(plant, **NEEDS.get(name, {}))
    except cl.NotApplicable as refusal:
        assert len(refusal.reason) > 20
        return
    assert isinstance(found, cl.Controller) and found.plant is plant
    assert found.name in repr(found) and set(found.manipulated) <= {"pump_1", "pump_2"}


@pytest.mark.parametrize("name", dir(cl.design))
def test_help_speaks_of_the_plant(name):
    design = getattr(cl.design, name)
    signature, text = inspect.signature(design), inspect.getdoc(design)
    assert next(iter(signature.parameters)) == "plant"
    assert "plant : Plant" in text and "model : LinearModel" not in text
    for parameter in signature.parameters:
        assert parameter in text


@pytest.mark.parametrize(
    ("name", "text", "number"),
    [
        ("simc", {"closed_loop_time_constant": "0.5 min"}, {"closed_loop_time_constant": 30.0}),
        ("phase_margin", {"phase_margin": "180/1 deg"}, None),
        ("phase_margin", {"crossover": "0.02 rad/s"}, {"crossover": 0.02}),
        ("lqi", {"maximum_errors": {"level_1": "5 %"}}, {"maximum_errors": {"level_1": 0.5}}),
        ("lqi", {"maximum_moves": {"pump_1": "500 mV"}}, {"maximum_moves": {"pump_1": 0.5}}),
        pytest.param(
            "gain_scheduled_lqi", {"over": "level_1", "points": ["40 %", "6 V"]},
            {"over": "level_1", "points": [4.0, 6.0]}, marks=SLOW,
        ),
        pytest.param(
            "pole_placement", {"bandwidth": "0.05 rad/s"}, {"bandwidth": 0.05}, marks=SLOW
        ),
    ],
)  # fmt: skip
def test_text_with_a_unit_is_the_number_in_its_unit(plant, name, text, number):
    design = getattr(cl.design, name)
    if number is None:
        with pytest.raises(cl.InputError) as error:
            design(plant, **text)
        assert error.value.place == "phase margin, phase_margin"
        return
    assert design(plant, **text).values == design(plant, **number).values
    assert design(plant, **text).values != design(plant).values


def test_an_angle_in_degrees_and_in_radians(plant):
    by_degrees = cl.design.phase_margin(plant, phase_margin="75 deg")
    by_radians = cl.design.phase_margin(plant, phase_margin=1.3089969389957472)
    assert by_degrees.values == by_radians.values


def test_a_number_of_a_signal_is_in_its_display_unit(basin):
    """The basin shows its level in %, and holds it as a share of 1."""
    level = basin.process.signal("level")
    assert (level.unit, level.shown_unit) == ("1", "%")
    by_text = cl.design.arrest_time(basin, deviation="8 %")
    assert cl.design.arrest_time(basin, deviation=8.0).values == by_text.values
    assert basin.at(outputs={"level": 40.0}).point.as_dict()["level"] == pytest.approx(0.4)


def test_pairing_and_form_go_through():
    plant = cl.load("quadruple-tank-nonminimum-phase")
    pairs = {"level_2": "pump_1", "level_1": "pump_2"}
    crossed = cl.design.simc(plant, pairs, form=cl.PidForm(algorithm="series"))
    assert dict(zip(crossed.measurements, crossed.manipulated, strict=True)) == pairs
    assert "series" in repr(crossed.law.blocks[0])


def test_too_many_arguments_are_python_s_own_error(plant):
    with pytest.raises(TypeError, match="too many"):
        cl.design.simc(plant, None, "PID")


def test_a_relay_takes_what_people_write_and_leads_to_the_ultimate_point():
    plant = cl.load("three-tanks")
    record = cl.relay_experiment(plant, "level_3", "feed", amplitude="10 cm^3/s", hysteresis="1 mm")
    assert np.ptp(record.manipulated) == pytest.approx(20e-6) and record.hysteresis == 1e-3
    found = cl.ultimate_point_of_relay(record)
    swing = np.ptp(record.measured[len(record.measured) // 2 :]) / 2
    size = 4 * 10e-6 / (np.pi * np.sqrt(swing**2 - 1e-6))
    assert found.gain == pytest.approx(size, rel=0.02)
    for options in ({"amplitude": "1 m"}, {"duration": "-1 s"}, {"hysteresis": "wide"}):
        with refused(place=f"relay experiment, {next(iter(options))}"):
            cl.relay_experiment(plant, "level_3", "feed", **options)
    with refused(place="relay experiment", value="level_9"):
        cl.relay_experiment(plant, "level_9", "feed")


def test_relative_gains_at_a_frequency_go_on_from_those_at_rest():
    plant = cl.load("quadruple-tank")
    at_rest, slow, fast = (cl.relative_gains(plant, w).to_numpy() for w in (0.0, 1e-6, 10.0))
    np.testing.assert_allclose(slow, at_rest, atol=1e-4)
    np.testing.assert_allclose(fast, np.eye(2), atol=1e-2)  # other pumps are a tank farther away


def test_a_rate_may_be_text():
    plant = cl.load("quadruple-tank")
    rates = [
        cl.design.variable_structure_pid(plant, alpha=alpha).values["level_1.saturation_rate"]
        for alpha in (0.2, "0.2 1/s", "12 1/min", ["0.2 1/s", "0.25 1/s"])
    ]
    assert rates == pytest.approx([0.2] * 4)
    with refused(place="variable structure pid, alpha", value="7 s"):
        cl.design.variable_structure_pid(plant, alpha="7 s")
