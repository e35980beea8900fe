"""A controller as a PLC has it loaded: its instances, and what a power failure leaves of it."""

import shutil

import pytest
from plc_bench import READY, PlcBench

import clepsydra as cl
from clepsydra.hil.building import Absent, c_image, structured_text_image
from clepsydra.hil.controller_image import LoadedController

#: Bits of the status word: automatic, at the low limit, follows, nothing was kept.
AUTOMATIC, AT_LOW, FOLLOWS, NOTHING_KEPT = 1, 4, 8192, 131072


@pytest.fixture(params=["compiled_c", "by_matiec"])
def image(request):
    return request.getfixturevalue(request.param)


def test_power_comes_back_with_what_is_retained(image, tmp_path):
    """The block follows its last output in the first scan, and goes on without a bump."""
    bench = PlcBench(image, tmp_path)
    bench.write("level_1.sp", 7.0)
    before = bench.scan(60)
    bench.power_cycle(retained=True)
    first = bench.scan()
    assert first["pump_1.out"] == before["pump_1.out"]
    assert first["pump_1.status"] == AUTOMATIC + FOLLOWS
    assert abs(bench.scan()["pump_1.out"] - before["pump_1.out"]) < 0.1
    assert bench.scan()["pump_1.status"] == AUTOMATIC


def test_power_comes_back_with_nothing(image, tmp_path):
    """Automatic begins at the fail-safe value, and says so until it is acknowledged."""
    bench = PlcBench(image, tmp_path)
    bench.scan(60)
    bench.power_cycle(retained=False)
    first = bench.scan()
    assert first["pump_1.out"] == 0.0
    assert first["pump_1.status"] == AUTOMATIC + AT_LOW + FOLLOWS + NOTHING_KEPT
    assert bench.scan(5)["pump_1.status"] == AUTOMATIC + NOTHING_KEPT
    bench.write("operator.acknowledge", 1.0)
    assert bench.scan()["pump_1.status"] == AUTOMATIC


def test_an_unwired_block_fails_safe_as_the_page_says(image):
    """docs/plc.md: 4 + 16 + 64 + 1024 in the first scan, and each output at its fail-safe value."""
    controller = LoadedController(image)
    found = controller.scan({})
    for pump in ("pump_1", "pump_2"):
        assert (found[f"{pump}.status"], found[f"{pump}.out"]) == (1108.0, 0.0)
    assert controller.given == tuple(signal.initial for signal in READY.program.inputs)


def test_what_runs_is_what_a_user_exports(compiled_c, by_matiec, tmp_path):
    plant = cl.load("quadruple-tank")
    cl.export(cl.design.simc(plant), plant, tmp_path, to=["st", "c"], dialect="matiec")
    name, built = READY.program.name, compiled_c.library.parent
    for file in (f"{name}.c", f"{name}.h"):
        assert (built / file).read_bytes() == (tmp_path / file).read_bytes()
    translated = by_matiec.library.parent / "printed.st"
    assert translated.read_bytes() == (tmp_path / f"{name}.st").read_bytes()


def test_inputs_keep_their_value_and_instances_their_own(image):
    first, second = LoadedController(image), LoadedController(image)
    given = {"pump_1.mode": 0.0, "pump_1.manual": 4.0, "time_step": 1.0, "start": 2.0}
    sensors = {f"level_{k}.{part}": x for k in (1, 2) for part, x in (("pv", 6.0), ("good", 1.0))}
    assert first.scan(given | sensors)["pump_1.out"] == 4.0
    assert first.scan({})["pump_1.out"] == 4.0
    assert second.scan({})["pump_1.out"] == 0.0


def test_what_is_missing_is_told(monkeypatch, tmp_path):
    monkeypatch.setenv("CLEPSYDRA_MATIEC", str(tmp_path / "none"))
    monkeypatch.setattr(shutil, "which", lambda program: None)
    with pytest.raises(Absent, match="iec2c is neither where CLEPSYDRA_MATIEC says nor on the pa"):
        structured_text_image(READY, tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(Absent, match="no C compiler"):
        c_image(READY, tmp_path)
