"""What the interface returns goes to another process and back, as pools and clusters need it.

The other process is spawned: it has imported nothing, and what it is sent brings all that it needs.
"""

import importlib
import json
import multiprocessing
import pickle
import pkgutil
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from pages import blocks

import clepsydra as cl
from clepsydra import interface
from clepsydra.interface.lab import rig_of
from clepsydra.interface.papers import AgainstLimit, beside

STEP = [cl.step("level_1", "0.5 V", at="5 s")]
#: A function of Python's own that returns the one thing in a list.
same = max
#: What a user writes, and no call returns.
WRITTEN = (
    cl.Connection, cl.Doors, cl.Element, cl.Flow, cl.Key, cl.Outlet, cl.PythonLaw,
    cl.VirtualSettings,
)  # fmt: skip
#: What takes minutes of a real clock: tests/cli/test_hil.py sends it to and fro.
IN_REAL_TIME = (cl.HardwareInTheLoop,)
#: Plants of several kinds; a design is tried on the first to which it applies.
PLANTS = ("quadruple-tank", "three-tanks", "wet-well", "wet-well:start-stop")


@pytest.fixture(scope="module")
def elsewhere():
    """Call a function in another process."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        yield lambda function, *given, **named: pool.submit(function, *given, **named).result()


@pytest.fixture(scope="module")
def results(plant, pi, tmp_path_factory):
    """One of each that the interface returns; shown already, so that each holds all."""
    folder = tmp_path_factory.mktemp("results")
    alone = cl.simulate(plant, None, [cl.step("pump_1", "50 mV", at="5 s")], duration="2 min")
    alone.save(folder / "record.csv")
    run = cl.simulate(plant, pi, STEP, duration="2 min")
    study = cl.study(plant, [pi], STEP, duration="2 min")
    tuned = cl.tune(pi, plant, events=STEP, duration="2 min")
    kernel = cl.Kernel(cl.program_of(pi.law))
    kernel.run(4, parameters=pi.values, inputs={"time_step": 1.0})
    loop = pi.settings["level_1"]
    rig = rig_of(plant, pi)
    session = {"form": 2, "version": cl.__version__, "digest": rig.digest, "process": plant.name}
    session |= {"controllers": [pi.name], "start": "rest", "samples": 9, "seed": 1, "touches": []}
    (folder / "session.json").write_text(json.dumps(session), encoding="utf-8")
    level = plant.process.signal("level_1")
    ours = beside.Entrant(
        pi.name, False, True, False, True, 12.0, 1.2, 1.3, {level.name: 0.0}, {"pump_1": 0.0}
    )
    outcome = beside.Outcome(
        "three-tanks",
        "Every second",
        10.0,
        True,
        ((level, 0.1),),
        plant.process.inputs,
        60.0,
        (ours,),
    )
    found = [
        plant, plant.point, plant.linear, cl.analyse(plant), pi, pi.settings, loop, loop["K"],
        cl.batch(plant, pi, STEP, duration="2 min", draws=2),
        cl.robustness(pi, plant, STEP, duration="2 min", draws=2, sensitivity=False),
        run, run.scores, alone, study, study.best, study.shown(every=True), tuned, tuned.tuning,
        cl.identify(folder / "record.csv", "pump_1", "level_1"),
        cl.identify(folder / "record.csv", plant=plant, parameters=["outlet_1.area"]),
        cl.catalogue(), cl.catalogue()[0], cl.export(pi, plant, folder, to="c"),
        cl.verify(pi, plant, to=["c"]), cl.replay(folder / "session.json", plant, pi),
        cl.relay_experiment(plant, "level_1", "pump_1"),
        cl.limit("three-tanks", [cl.step("level_3", "+1 cm", at="1 s")], duration="5 min"),
        cl.margins(pi, plant), cl.relative_gains(plant), cl.poles(plant), cl.audit(["three-tanks"]),
        AgainstLimit((outcome,)),
        cl.Laboratory(folder / "lab.html", "tanks"), cl.registers(plant),
        pi.law, kernel, STEP[0], cl.PidForm("PI"), cl.Signal("level", "m"),
    ]  # fmt: skip
    assert all(map(repr, found))
    return found


def test_every_result_of_the_interface_is_among_them(results):
    """A class that fails here is to be made in `results`."""
    for module in pkgutil.iter_modules(interface.__path__):
        importlib.import_module(f"{interface.__name__}.{module.name}")
    published = {getattr(cl, name) for name in cl.__all__}
    kinds = {each for each in published if isinstance(each, type) and each not in WRITTEN}
    kinds -= {*IN_REAL_TIME}
    kinds |= {*every_kind(interface.shown.Shown)} - {*IN_REAL_TIME}
    left = {each for each in kinds if not any(isinstance(result, each) for result in results)}
    assert {each for each in left if not issubclass(each, Exception)} == set()


def every_kind(base):
    for kind in base.__subclasses__():
        yield kind
        yield from every_kind(kind)


def test_every_result_is_shown_elsewhere_as_here(results, elsewhere):
    for each in results:
        again = elsewhere(same, [each])
        assert type(again) is type(each)
        if " at 0x" not in repr(each):
            assert elsewhere(repr, each) == repr(again) == repr(each)


def test_a_run_elsewhere_has_the_same_bits(plant, pi, elsewhere):
    for controller in (pi, cl.design.lqi(plant)):
        here = cl.simulate(plant, controller, STEP, duration="2 min")
        there = elsewhere(cl.simulate, plant, controller, STEP, duration="2 min")
        assert list(there.values) == list(here.values)
        for name, values in here.values.items():
            np.testing.assert_array_equal(there.values[name], values, err_msg=name)
        assert there.scores["iae[level_1]"] == here.scores["iae[level_1]"]


def test_a_kernel_is_compiled_anew_where_it_arrives(pi, elsewhere):
    kernel = cl.Kernel(cl.program_of(pi.law))
    given = {"parameters": pi.values, "inputs": {"time_step": 1.0, "level_1.pv": 4.0}}
    here, there = kernel.run(4, **given), elsewhere(kernel.run, 4, **given)
    np.testing.assert_array_equal(there.output("pump_1.out"), here.output("pump_1.out"))


@pytest.mark.sampled
@pytest.mark.parametrize("name", [name for name in dir(cl.design) if name not in ("own", "fuzzy")])
def test_what_is_exported_elsewhere_has_the_same_text(name, tmp_path):
    """Blocks, loops, conditions, rings: the equations come back as they were written."""
    if name in ("regulator", "lqi_by_weights"):
        pytest.skip("asks for matrices; its law is that of another design")
    for plant in map(cl.load, PLANTS):
        try:
            controller = getattr(cl.design, name)(plant)
        except (cl.NotApplicable, cl.InputError):
            continue
        again = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(controller))))
        if isinstance(controller.law, cl.PythonLaw):
            assert again.law.state == controller.law.state
            return  # has no text
        texts = [
            [file.read_text("utf-8") for file in cl.export(each, plant, folder, to="st").files]
            for each, folder in ((controller, tmp_path / "a"), (again, tmp_path / "b"))
        ]
        assert texts[0] == texts[1]
        return
    raise AssertionError(f"{name} applies to none of {', '.join(PLANTS)}: add a plant")


def written(page, folder):
    """Write the files of a page."""
    for block in blocks(f"docs/{page}.md"):
        if block.file:
            (folder / block.file).write_text(block.text, "utf-8")


@pytest.mark.parametrize("file", ["my_pi.py", "my_fast_pi.py"])
def test_a_law_of_ones_own_goes_where_its_file_is_not(plant, elsewhere, tmp_path, file):
    written("own-law", tmp_path)
    controller = cl.design.own(
        plant, cl.load_law(tmp_path / file), measurements=["level_1"], setpoints=["level_1"],
        manipulated=["pump_1"], values={"gain": 2.0}, initial_state={"integral": 3.0},
    )  # fmt: skip
    here = cl.simulate(plant, controller, STEP, duration="1 min")
    (tmp_path / file).unlink()
    there = elsewhere(cl.simulate, plant, controller, STEP, duration="1 min")
    np.testing.assert_array_equal(there.values["pump_1"], here.values["pump_1"])
    assert np.ptp(here.values["pump_1"]) > 0.1
    back = cl.simulate(plant, there.controller, STEP, duration="1 min")  # and it comes back
    np.testing.assert_array_equal(back.values["pump_1"], here.values["pump_1"])


def test_a_plant_with_an_element_of_ones_own_does_too(elsewhere, tmp_path):
    written("own-element", tmp_path)
    plant = cl.load(tmp_path / "leaky-tank.toml")
    here = cl.simulate(plant, None, [cl.step("pump_1", "10 %", at="5 s")], duration="1 min")
    for file in tmp_path.iterdir():
        file.unlink()
    again = elsewhere(same, [plant])
    assert [type(each).__name__ for each in again.process.elements] == [
        type(each).__name__ for each in plant.process.elements
    ]
    leak = next(each for each in again.process.elements if each.name == "leak_1")
    assert isinstance(leak, type(next(e for e in plant.process.elements if e.name == "leak_1")))
    there = cl.simulate(again, None, [cl.step("pump_1", "10 %", at="5 s")], duration="1 min")
    np.testing.assert_array_equal(there.values["tank_1.level"], here.values["tank_1.level"])


def test_a_mistake_elsewhere_is_told_here(plant, pi, elsewhere):
    for function, given, named in (
        (cl.simulate, (plant, pi), {"durations": 3}),
        (pi.with_values, ({"level_9": {"K": 1.0}},), {}),
        (getattr, (cl, "simulat"), {}),
        (cl.design.smith_predictor, (plant,), {}),
        (plant.at, (), {"inputs": {"pump_9": "4 V"}}),
    ):
        said = []
        for call in (lambda f, *a, **k: f(*a, **k), elsewhere):
            with pytest.raises(cl.ClepsydraError) as refusal:
                call(function, *given, **named)
            said.append((type(refusal.value), str(refusal.value), vars(refusal.value)))
        assert said[0] == said[1]
