"""From a process of the catalogue to proven code, as a user of other libraries would write it."""

from pathlib import Path

import clepsydra as cl


def test_the_whole_way(tmp_path):
    plant = cl.load("quadruple-tank")
    analysis = cl.analyse(plant)
    assert "relative gain" in repr(analysis)
    pi = cl.design.simc(plant)
    assert "level_1" in repr(pi)
    run = cl.simulate(plant, pi)
    assert {"iae[level_1]", "overshoot[level_2]"} <= set(run.scores)
    assert run.plot().axes and len(run.to_pandas()) == run.time.size
    assert run.to_xarray()["tank_1.level"].attrs["units"] == "m"
    bold = pi.with_values({"level_1": {"K": 6.0}})
    events = [
        cl.step("level_1", "+1 V", at="1 min"),
        cl.ramp("level_2", "+1 V", over="5 min"),
        cl.disturbance("inflow_1", "+10 %"),
    ]
    run = cl.simulate(plant, bold, events)
    assert [change.signal for change in run.changes] == ["level_1", "level_2", "inflow_1"]
    study = cl.study(plant, [pi, bold])
    assert study.best.controller.name in (pi.name, bold.name) and len(study.ranking) == 2
    study.report(tmp_path / "out.html")
    assert (tmp_path / "out.html").stat().st_size > 10_000
    best = cl.tune(
        pi, plant, goal="iae", limits={"overshoot": "10 %", "max|S|": 1.6},
        parameters={name: {"K": (1, 9)} for name in ("level_1", "level_2")},
        events=events[:1], duration="3 min",
    )  # fmt: skip
    assert best.tuning.objective < 1.0 and best.tuning.maximum_sensitivity < 1.6 + 1e-5
    record = cl.simulate(plant, None, [cl.step("pump_1", "+0.5 V", at="1 min")])
    record.save(tmp_path / "record.csv")
    model = cl.identify(tmp_path / "record.csv", "pump_1", "level_1")
    assert model.best.name in repr(model)
    written = cl.export(bold, plant, tmp_path / "out", to="st")
    assert any(path.suffix == ".st" for path in written.files)


def test_a_name_or_a_path_stands_for_a_plant_wherever_one_is_taken(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pi = cl.design.simc("quadruple-tank")
    assert cl.analyse("quadruple-tank").minimum_phase
    assert cl.zeros("quadruple-tank").shape == (2,)
    assert cl.margins(pi, "quadruple-tank").shape == (4, 5)
    step = [cl.step("level_1", "1 V", at="10 s")]
    run = cl.simulate("quadruple-tank", pi, step, duration="1 min")
    assert run.scores["iae[level_1]"] > 0.0
    assert len(cl.export(pi, "quadruple-tank", to="c").files) == 2
    assert cl.draw("quadruple-tank") is None and Path("quadruple-tank.svg").exists()
    own = cl.new_process("one-tank")
    assert cl.analyse(own).pairing == (("level_1", "pump_1"),)
    study = cl.new_study("compare", str(own))
    assert cl.analyse(study).pairing == (("level_1", "pump_1"),)
    assert cl.export(cl.design.simc(own), study, to="signals").files


def test_a_candidate_of_a_study_stands_for_its_controller(plant, pi, tmp_path):
    best = cl.study(plant, [pi], [cl.step("level_1", "1 V")], duration="2 min").best
    assert cl.simulate(plant, best, [], duration="10 s").controller.name == pi.name
    written = cl.export(best, plant, tmp_path, to="c")
    assert [path.name for path in written.files] == [
        "quadruple_tank_pi_simc.h",
        "quadruple_tank_pi_simc.c",
    ]
    again = cl.study(plant, [best, pi], [cl.step("level_1", "1 V")], duration="2 min")
    assert {each.controller.name for each in again.ranking} == {"PI, SIMC", "PI, SIMC, 2"}
    assert cl.draw(plant, tmp_path / "plant.svg", best) is None
