"""A run on wires computed again, and beside the simulation: equal, and every spoilt bit is seen."""

from pathlib import Path

import numpy as np
import pytest
from plc_bench import READY, CardBus, FailingBus, PlcBench, ready_of, through_a_card
from tools import need_compiler

from clepsydra.hil.building import c_image
from clepsydra.hil.evidence import evidence_of
from clepsydra.hil.ideal import as_operated, deviations, ideal_run
from clepsydra.hil.replay import replay_law, replay_plant
from clepsydra.hil.wire_check import as_it_is, check_wires
from clepsydra.hil.wires import Wires

ALARMED = Path(__file__).parents[1] / "alarmed-tank.toml"
ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"


def operated(bench: PlcBench) -> PlcBench:
    """A run in which an operator and an instructor do all that they can."""
    bench.scan(10)
    bench.write("level_1.sp", 7.0)
    bench.scan(40)
    bench.instruct("instructor.noise", 1.0)
    bench.scan(30)
    bench.instruct("instructor.noise", 0.0)
    bench.write("pump_1.mode", 0.0)
    bench.write("pump_1.manual", 2.5)
    bench.scan(10)
    bench.write("pump_1.mode", 1.0)
    bench.instruct("level_2.drift", 0.01)
    bench.scan(10)
    bench.instruct("level_2.drift", 0.0)
    bench.instruct("level_1.sensor", 0.0)
    bench.scan(7)
    bench.instruct("level_1.sensor", 1.0)
    bench.instruct("pump_2.stiction", 0.2)
    bench.scan(5)
    bench.write("operator.acknowledge", 1.0)
    bench.scan(10)
    bench.instruct("level_2.forced", 1.0)
    bench.instruct("level_2.reading", -3.0)
    bench.scan(5)
    bench.instruct("level_2.forced", 0.0)
    bench.scan(20)
    return bench


def deviations_of(bench: PlcBench) -> dict[str, float]:
    settings, ready, rows = bench.settings, bench.ready, bench.rows
    given = as_operated(settings, ready, bench.log, bench.wiring, rows, bench.tags)
    ideal = ideal_run(settings, ready, rows.last + 1, given)
    return {each.tag.name: each.largest for each in deviations(ideal, rows, bench.tags)}


def test_all_of_it_is_the_simulation_in_every_bit(compiled_c, tmp_path):
    """Law and process each for themselves, and the loop of both."""
    bench = operated(PlcBench(compiled_c, tmp_path))
    outputs = bench.log.found()["pump_1.out"]
    assert np.ptp(outputs) > 2.0 and len(np.unique(outputs)) > 100
    assert replay_law(READY.program, bench.log).differing == 0
    assert replay_plant(bench.settings, bench.rows).differing == 0
    assert set(deviations_of(bench).values()) == {0.0}
    found = check_wires(bench.settings, bench.log, bench.wiring, bench.rows, bench.tags)
    assert (found.straddled, found.misread, found.late, found.foreign) == (0, 0, 0, 0)
    assert found.in_time == 2 * len(bench.log)


def test_evidence_holds_until_a_bit_is_spoilt(compiled_c, tmp_path):
    bench = operated(PlcBench(compiled_c, tmp_path))
    wires = Wires("none", bench.bus, as_it_is, lambda tag: 0.0)
    checked = (
        READY, "double", bench.settings, bench.log, bench.wiring, bench.rows, bench.tags, wires,
    )  # fmt: skip
    found = evidence_of(*checked)
    assert found.holds and found.bound == 0.0
    assert (found.off, found.left_out, found.unseen, found.lost) == (0, 0, 0, (0, 0))
    place = 2 + bench.rows.layout.columns.index("pump_1.command")
    bench.rows._parts[-1][3, place] += 1e-9
    spoilt = evidence_of(*checked)
    assert spoilt.wires.foreign == 1 and not spoilt.holds


def test_power_failures_and_a_pulled_cable_are_computed_again_too(compiled_c, tmp_path):
    bench = PlcBench(compiled_c, tmp_path, FailingBus)
    bench.write("level_1.sp", 7.0)
    bench.scan(20)
    bench.power_cycle(retained=True)
    bench.scan(20)
    bench.power_cycle(retained=False)
    bench.scan(20, time_step=1.02)
    bench.bus.fails = True
    statuses = bench.scan(4)["pump_1.status"], bench.scan(1)["pump_1.status"]
    bench.bus.fails = False
    # Ridden through for 4 s with the output held; then failed safe.
    assert statuses == (131072.0 + 1 + 16 + 512, 131072.0 + 1 + 4 + 16 + 1024)
    bench.scan(10)
    assert (bench.log.lost, bench.log.unseen) == ((5, 5), 5)
    assert replay_law(READY.program, bench.log).differing == 0
    assert replay_plant(bench.settings, bench.rows).differing == 0
    found = check_wires(bench.settings, bench.log, bench.wiring, bench.rows, bench.tags)
    assert (found.straddled, found.misread, found.late, found.foreign) == (0, 0, 10, 0)


@pytest.mark.parametrize("column", ["level_1.pv", "pump_1.out", "time_step"])
def test_a_spoilt_bit_of_the_law_is_seen(column, compiled_c, tmp_path):
    bench = PlcBench(compiled_c, tmp_path)
    bench.write("level_1.sp", 7.0)
    bench.scan(30)
    log, width = bench.log, bench.log.table.shape[1]
    ports = (*log.inputs, *log.outputs)
    log._numbers[20 * width - len(ports) + ports.index(column)] += 1e-12
    assert replay_law(READY.program, log).differing > 0


@pytest.mark.parametrize("cell", ["level_1", "pump_1.applied", "tank_3.level"])
def test_a_spoilt_bit_of_the_plant_is_seen(cell, compiled_c, tmp_path):
    bench = PlcBench(compiled_c, tmp_path)
    bench.write("level_1.sp", 7.0)
    bench.scan(30)
    place = 2 + bench.rows.layout.columns.index(cell)
    bench.rows._parts[-1][20, place] *= 1.0 + 1e-15
    assert replay_plant(bench.settings, bench.rows).differing > 0


def test_a_card_rounds_and_nothing_else_happens(compiled_c, tmp_path):
    bench = operated(PlcBench(compiled_c, tmp_path, CardBus))
    assert replay_law(READY.program, bench.log).differing == 0
    assert replay_plant(bench.settings, bench.rows).differing == 0
    checked = bench.settings, bench.log, bench.wiring, bench.rows, bench.tags
    found = check_wires(*checked, through_a_card)
    assert (found.straddled, found.misread, found.late, found.foreign) == (0, 0, 0, 0)
    unrounded = check_wires(*checked)
    assert unrounded.misread > 100 and unrounded.foreign > 100
    # Half a count of a level is 1.5 counts of a pump, at 3 V/V; the tank hardly follows these.
    assert 0.0 < deviations_of(bench)["level_1.pv"] < 10.0 / 27648


def test_single_precision_is_the_simulation_in_single_precision(tmp_path):
    need_compiler()
    image = c_image(READY, tmp_path / "c", "single")
    bench = operated(PlcBench(image, tmp_path))
    assert replay_law(READY.program, bench.log, "single").differing == 0
    assert replay_law(READY.program, bench.log).differing > 0
    away = deviations_of(bench)
    assert 0.0 < away["pump_1.position"] < 1e-4


def test_alarms_of_the_plant_hold_the_output_of_the_plc(tmp_path):
    """Bit 262144 while they do; and all is the simulation, in which they hold it too."""
    need_compiler()
    ready = ready_of(ALARMED)
    image = c_image(ready, tmp_path / "c")
    bench = PlcBench(image, tmp_path, ready=ready, name=ALARMED)
    bench.scan(5)
    assert bench.read("pump_1.interlock").value == 0.0
    bench.instruct("inflow_1", 2e-5)
    statuses = []
    for _ in range(80):
        statuses.append(int(bench.scan()["pump_1.status"]))
        if bench.read("level_1.pv").value > 14.0:
            bench.write("operator.acknowledge", float(len(statuses) % 2))
    held = [bool(status & 262144) for status in statuses]
    assert any(held) and not all(held)
    assert bench.log.found()["pump_1.out"][5:][held].max() == 0.0
    assert replay_law(ready.program, bench.log).differing == 0
    assert replay_plant(bench.settings, bench.rows).differing == 0
    assert set(deviations_of(bench).values()) == {0.0}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "design"),
    [("wet-well", "simc"), ("averaging-tank", "simc"), ("equalisation-tank", "simc"),
     ("eight-tanks", "simc"), ("laboratory-four-tanks", "lqi"), ("three-tanks", "lqi"),
     ("quadruple-tank", "mpc")],
)  # fmt: skip
def test_other_processes_and_laws(name, design, tmp_path):
    """In percent, milliamperes and cubic metres an hour, from 50 ms to a minute."""
    need_compiler()
    ready = ready_of(name, design)
    bench = PlcBench(c_image(ready, tmp_path / "c"), tmp_path, ready=ready, name=name)
    period, first = ready.process.sampling_period, ready.process.controlled[0]
    bench.scan(5, time_step=period)
    setpoint = bench.tag(f"{first}.sp")
    bench.write(setpoint.name, bench.read(setpoint.name).value + 0.05 * setpoint.signal.span)
    bench.instruct("instructor.noise", 1.0)
    bench.scan(60, time_step=period)
    outputs = [bench.log.found()[port] for port in bench.wiring.writes if port.endswith(".out")]
    assert all(len(np.unique(output)) > 50 for output in outputs)
    assert replay_law(ready.program, bench.log).differing == 0
    assert replay_plant(bench.settings, bench.rows).differing == 0
    assert set(deviations_of(bench).values()) == {0.0}


def test_ports_with_the_tags_of_a_plant(tmp_path):
    need_compiler()
    text = ONE_TANK.read_text(encoding="utf-8")
    for table, tag in (("sensors.level_1", "LIC101"), ("pumps.pump_1", "P101")):
        assert text.count(f"[{table}]") == 1
        text = text.replace(f"[{table}]", f'[{table}]\ntag = "{tag}"')
    path = tmp_path / "tagged.toml"
    path.write_text(text, encoding="utf-8")
    ready = ready_of(path)
    bench = PlcBench(c_image(ready, tmp_path / "c"), tmp_path, ready=ready, name=path)
    assert bench.wiring.reads["LIC101.sp"] == "level_1.sp"
    assert bench.wiring.writes["P101.out"] == "pump_1.out"
    bench.write("level_1.sp", bench.read("level_1.sp").value + 1.0)
    bench.scan(30)
    assert np.ptp(bench.log.found()["P101.out"]) > 0.1
    assert set(deviations_of(bench).values()) == {0.0}
