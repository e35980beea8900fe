"""Analyses, models from records, exports and proofs, as values and as text."""

import re

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl


def test_zeros_are_those_that_johansson_derived():
    """They solve (1 + T3 s)(1 + T4 s) = (1 - γ1)(1 - γ2)/(γ1 γ2): one is in the right half-plane.

    K. H. Johansson, IEEE Transactions on Control Systems Technology 8(3), 2000, equation 9.
    """
    plant = cl.load("quadruple-tank-nonminimum-phase")
    T3, T4, share_1, share_2 = 39.0, 56.0, 0.43, 0.34  # of table I and the text, two digits
    ratio = (1.0 - share_1) * (1.0 - share_2) / (share_1 * share_2)
    by_hand = np.sort(np.roots([T3 * T4, T3 + T4, 1.0 - ratio]))
    assert np.sort(cl.zeros(plant).real) == pytest.approx(by_hand, rel=0.03)


def test_a_system_of_python_control_has_the_same_poles_and_zeros(plant):
    control = pytest.importorskip("control")
    system = plant.linear.to_control()
    pumps = control.ss(system.A, system.B[:, :2], system.C, system.D[:, :2])
    assert np.sort(cl.zeros(plant).real) == pytest.approx(np.sort(control.zeros(pumps).real))
    assert np.sort(cl.poles(pumps).real) == pytest.approx(np.sort(control.poles(system).real))
    assert cl.relative_gains(pumps).to_numpy() == pytest.approx(cl.relative_gains(plant).to_numpy())


def test_relative_gains_are_labelled_and_add_up_to_one(plant):
    gains = cl.relative_gains(plant)
    assert list(gains.index) == ["level_1", "level_2"] and list(gains) == ["pump_1", "pump_2"]
    assert gains.sum(axis=0).to_list() == pytest.approx([1.0, 1.0])
    static = plant.analysis.static_gain
    by_hand = static * np.linalg.inv(static).T
    assert gains.to_numpy() == pytest.approx(by_hand)


def test_margins_are_those_of_the_loop_with_its_gain_raised(plant, pi):
    """A gain raised by its margin brings the loop to the edge: twice as far is unstable."""
    margin = cl.margins(pi, plant).loc["level_1", "gain margin"]
    gain = pi.values["level_1.proportional_gain"]
    step = [cl.step("level_1", "1 mV", at=5)]
    for factor, swings in ((0.9, False), (1.1, True)):
        raised = pi.with_values({"level_1": {"K": gain * margin * factor}})
        run = cl.simulate(plant, raised, step, duration="5 min")
        late = run.values["level_1"][-60:]
        assert (np.ptp(late) > 1e-3) == swings


@pytest.mark.parametrize("call", ["plant", "analysis", "pi", "run", "alone"])
def test_what_is_printed_fits_and_says_what_it_is(call, plant, pi):
    shown = repr(
        {
            "plant": lambda: plant,
            "analysis": lambda: cl.analyse(plant),
            "pi": lambda: pi,
            "run": lambda: cl.simulate(plant, pi, [cl.step("level_1", "1 V")]),
            "alone": lambda: cl.simulate(plant, None, [cl.step("pump_1", "50 mV")]),
        }[call]()
    )
    lines = shown.splitlines()
    assert 5 < len(lines) < 60 and max(map(len, lines)) <= 100
    assert "quadruple-tank" in shown and "level_1" in shown and "object at" not in shown


@pytest.fixture(scope="module")
def answers(plant, pi, tmp_path_factory):
    """What each verb returns that has more to show and something to do next."""
    folder = tmp_path_factory.mktemp("record")
    step = [cl.step("level_1", "1 V")]
    alone = cl.simulate(plant, None, [cl.step("pump_1", "50 mV")])
    alone.save(folder / "record.csv")
    return {
        "analysis": cl.analyse(plant),
        "study": cl.study(plant, [pi, pi, pi, pi, pi, pi], step, duration="2 min"),
        "simulation": alone,
        "nothing moves": cl.simulate(plant, duration="10 s"),
        "identification": cl.identify(folder / "record.csv", "pump_1", "level_1"),
        "fit": cl.identify(folder / "record.csv", plant=plant, parameters=["outlet_1.area"]),
    }


@pytest.mark.parametrize(
    ("name", "calls"),
    [
        ("analysis", {"every"}),
        ("study", {"every", "why"}),
        ("simulation", {"every"}),
        ("nothing moves", {"every"}),
        ("identification", {"every"}),
        ("fit", {"every"}),
    ],
)
def test_a_result_says_what_to_call_and_not_what_to_type_on_the_command_line(answers, name, calls):
    found = answers[name]
    for said in (repr(found), found._repr_markdown_()):
        assert "--" not in said.replace("---", "") and "clepsydra " not in said
        assert "Next" not in said and "the report" not in said
        assert set(re.findall(r"shown\((\w+)=True\)", said)) == calls
    for call in calls:
        more = found.shown(**{call: True})
        assert f"{call}=True" not in repr(more) and len(repr(more)) > len(repr(found))


def test_a_tuning_is_printed_in_sentences(basin):
    step = [cl.step("level", "5 %")]
    best = cl.tune(cl.design.arrest_time(basin), basin, events=step, duration="1 d")
    said = repr(best.tuning)
    assert said.startswith("Tuned by simulation from PI, arrest time for IAE of level")
    assert "level.gain = " in said and "max|S|" in said and "array" not in said
    assert said.count("\n") < 8 and best.tuning.objective < 1.0
    assert repr(best.tuning).split("objective")[1][:20] in repr(best)


def test_a_drawing_has_the_values_of_the_operating_point(plant, tmp_path):
    assert cl.draw(plant, tmp_path / "plant.svg") is None
    lower = plant.at(inputs={"pump_1": 2.5, "pump_2": 2.5})
    assert cl.draw(lower, tmp_path / "lower.svg") is None
    drawn, other = ((tmp_path / f"{name}.svg").read_text("utf-8") for name in ("plant", "lower"))
    assert "3.00 V" in drawn and "2.50 V" in other and "2.50 V" not in drawn


def test_a_drawing_takes_only_a_controller_of_its_signals(plant, pi, tmp_path):
    drum = cl.load("wet-well")
    with refused(place="measurements", value="level_1", expected=drum.name):
        cl.draw(drum, tmp_path / "drum.svg", pi)
    with refused(place="controller", value="PI", remedy="cl.design.simc(plant)"):
        cl.draw(plant, tmp_path / "plant.svg", "PI")
    assert not list(tmp_path.iterdir())


@pytest.mark.thorough
def test_a_page_of_the_analysis(tmp_path):
    one_tank = cl.load(cl.new_process("one-tank", folder=tmp_path))
    cl.analyse(one_tank).report(tmp_path / "analysis.html")
    assert "<svg" in (tmp_path / "analysis.html").read_text("utf-8")


def test_a_model_of_a_record_and_settings_from_it(plant, tmp_path):
    """A small step is a linear experiment: gain and time constant are those of the model."""
    record = cl.simulate(plant, None, [cl.step("pump_1", "50 mV", at=20)], duration="12 min")
    record.save(tmp_path / "record.csv")
    found = cl.identify(tmp_path / "record.csv", "pump_1", "level_1")
    model = next(each for each in found.models if each.name == "FOPDT")
    gain, time, *_ = (estimate.value for estimate in model.estimates)
    assert gain == pytest.approx(plant.analysis.static_gain[0, 0], rel=0.01)
    assert time == pytest.approx(62.4, rel=0.02)
    assert found.verdict[:20] in repr(found)
    found.report(tmp_path / "page.html")
    settings = found.for_control.settings
    assert settings is not None and (tmp_path / "page.html").exists()


def test_a_record_of_many_columns_asks_for_arguments_of_python(plant, tmp_path):
    cl.simulate(plant, None, [cl.step("pump_1", "0.5 V", at=20)]).save(tmp_path / "record.csv")
    with pytest.raises(cl.InputError) as error:
        cl.identify(tmp_path / "record.csv")
    assert 'manipulated="pump_1", measured="' in error.value.remedy


def test_parameters_of_a_plant_are_found_again(plant, tmp_path):
    true = plant.with_values({"outlet_1.area": "0.07 cm^2"})
    cl.simulate(true, None, [cl.step("pump_1", "0.5 V", at=20)], duration="5 min").save(
        tmp_path / "record.csv"
    )
    fit = cl.identify(tmp_path / "record.csv", plant=plant, parameters=["outlet_1.area"])
    assert fit.values["outlet_1.area"] == pytest.approx(7e-6, rel=1e-6)
    assert fit.plant.process.signal("outlet_1.area").initial == fit.values["outlet_1.area"]
    assert "outlet_1.area" in repr(fit)
    with pytest.raises(cl.InputError) as error:
        cl.identify(tmp_path / "record.csv", "pump_1", plant=plant, parameters=["outlet_1.area"])
    assert error.value.place == "manipulated"


@pytest.mark.thorough
def test_an_export_writes_what_it_says(plant, pi, tmp_path):
    bold = pi.with_values({"level_1": {"K": 6.0}}, name="bold")
    written = cl.export(bold, plant, tmp_path / "plc", to="st", fail_safe={"pump_1": 2.0})
    assert [path.parent for path in written.files] == [tmp_path / "plc"] * len(written.files)
    block = (tmp_path / "plc" / "quadruple_tank_bold.st").read_text("utf-8")
    assert "level_1_proportional_gain : LREAL := 6.0" in block and "bold" in block
    assert "pump_1_fail_safe : LREAL := 2.0" in block
    assert str(written.files[0]) in repr(written) and written.facts["digest"] in block
    tuning = cl.export(pi, plant, tmp_path, to="tuning")
    assert tuning.files[0].suffix == ".md"


def test_a_rate_in_display_units_and_in_text(plant, pi, tmp_path):
    texts = [
        cl.export(pi, plant, tmp_path / str(number), to="c", rate_limit={"pump_1": rate})
        .files[1]
        .read_text("utf-8")
        for number, rate in enumerate(("30 V/min", 0.5, "0.6 V/s"))
    ]
    assert texts[0] == texts[1] != texts[2]


def test_the_catalogue_and_new_files(tmp_path):
    assert {entry.name for entry in cl.catalogue()} >= {"quadruple-tank", "wet-well"}
    table, one = str(cl.catalogue()), str(cl.catalogue("wet-well"))
    assert all(entry.title in table for entry in cl.catalogue())
    assert "Source: " in one and "Source: " not in table
    assert str(cl.catalogue().shown(every=True)).count("Source: ") == len(cl.catalogue())
    assert all(word not in table + one for word in ("CatalogueEntry", "--all", "clepsydra study"))
    mine = cl.new_process("mine", copy_of="quadruple-tank", folder=tmp_path)
    assert cl.load(mine).name == "mine"
    study = cl.new_study("compare", "three-tanks", folder=tmp_path)
    assert study.read_text("utf-8").count("three-tanks") > 0
    with pytest.raises(cl.InputError) as error:
        cl.new_process("mine", folder=tmp_path)
    assert error.value.place == "name"
