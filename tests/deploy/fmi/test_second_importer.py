"""FMUs in an importer that shares no code with FMPy: fmi-sim, written in Rust.

It is installed by ``cargo install fmi-sim``; CLEPSYDRA_FMI_SIM names it where it is not found
on the path. Where it is missing these tests are skipped, unless CLEPSYDRA_REQUIRE_IMPORTERS=1.
Version 0.7 does not read units and nominal values of real variables in descriptions of FMI 3.0,
nor amperes in the dimension of a unit, though the standard has them: for it they are taken out.
"""

import csv
import os
import shutil
import subprocess
import zipfile
from dataclasses import replace
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmus import VERSIONS, Imported, written
from models import FRICTIONS, exchange_of, origin, process_of, rig
from plants import designed
from tools import without

from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.exchange import exchange_model

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def simulator() -> str:
    found = os.environ.get("CLEPSYDRA_FMI_SIM") or shutil.which("fmi-sim")
    if not found:
        without("fmi-sim is not installed", "CLEPSYDRA_REQUIRE_IMPORTERS")
    return found


def without_units(path):
    """Return a copy of an FMU whose description says nothing of units."""
    plain = path.with_name(f"plain_{path.name}")
    with zipfile.ZipFile(path) as archive, zipfile.ZipFile(plain, "w") as copy:
        for name in archive.namelist():
            content = archive.read(name)
            if name == "modelDescription.xml":
                root = ElementTree.fromstring(content)
                for units in root.findall("UnitDefinitions"):
                    root.remove(units)
                for variable in root.iter("Float64"):
                    for attribute in ("unit", "quantity", "displayUnit", "nominal"):
                        variable.attrib.pop(attribute, None)
                content = ElementTree.tostring(root)
            copy.writestr(name, content)
    return plain


def simulated(simulator, path, kind, step, stop, inputs=None, start=None) -> dict[str, np.ndarray]:
    """Run fmi-sim and return its table by column."""
    folder = path.parent
    result = folder / f"{path.stem}_result.csv"
    if path.stem.endswith("_3"):
        path = without_units(path)
    command = [simulator, "--model", str(path), "--output-file", str(result)]
    if inputs is not None:
        table = folder / f"{path.stem}_input.csv"
        with table.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(inputs)
            writer.writerows(zip(*inputs.values(), strict=True))
        command += ["--input-file", str(table)]
    command += [kind, "-s", "0", "-f", repr(stop), "--output-interval", repr(step)]
    command += ["--step", repr(step)]
    for name, value in (start or {}).items():
        command += ["--init-values", f"{name}={value!r}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    with result.open(newline="") as file:
        rows = list(csv.reader(file))
    return {
        name: np.array([number(row[place]) for row in rows[1:]])
        for place, name in enumerate(rows[0])
    }


def number(text: str) -> float:
    return float(text == "true") if text in ("true", "false") else float(text)


STEPS = 200


def three_tanks_pi():
    program = designed("simc", "three-tanks").program()
    return controller_model(replace(program, name="three_tanks_pi"), origin("three-tanks", 1.0))


@pytest.mark.parametrize("version", VERSIONS)
def test_a_controller_gives_the_same_numbers(version, simulator, tmp_path):
    """Scan by scan from a control error, in every bit."""
    model = three_tanks_pi()
    path = written(model, tmp_path, version)
    start = {"level_3.sp": 0.21, "level_3.pv": 0.2}
    found = simulated(simulator, path, "co-simulation", 1.0, float(STEPS), start=start)
    assert list(found["time"]) == list(range(STEPS + 1))
    fmu = Imported(path, tmp_path)
    fmu.set(start)
    fmu.initialise()
    for scan in range(STEPS + 1):
        for variable in model.outputs:
            assert found[variable.name][scan] == fmu.get(variable.name)
        fmu.step(float(scan), 1.0)
    fmu.close()
    assert np.ptp(found["feed.out"]) > 1e-6


@pytest.mark.parametrize("version", VERSIONS)
def test_a_process_gives_the_same_numbers(version, simulator, tmp_path):
    """With an input that changes from step to step, in every bit."""
    model = process_of("three-tanks")
    path = written(model, tmp_path, version)
    time = np.arange(STEPS + 1.0)
    inputs = {"time": time, "feed": 5e-5 + 2e-5 * np.sin(time / 9)}
    found = simulated(simulator, path, "co-simulation", 1.0, float(STEPS), inputs=inputs)
    assert list(found["time"]) == list(time)
    fmu = Imported(path, tmp_path).initialise()
    for sample in range(STEPS):
        fmu.set({"feed": inputs["feed"][sample]})
        fmu.step(float(sample), 1.0)
        for variable in model.outputs:
            assert found[variable.name][sample + 1] == fmu.get(variable.name)
    fmu.close()
    assert np.ptp(found["tank_1.level"]) > 1e-3


@pytest.mark.parametrize("version", VERSIONS)
def test_a_process_for_model_exchange_gives_the_same_numbers(version, simulator, tmp_path):
    """fmi-sim integrates by Euler's method, and so does FMPy when told to."""
    path = written(exchange_of("three-tanks"), tmp_path, version)
    start = {"tank_1.level": 0.25, "tank_3.level": 0.03}
    found = simulated(simulator, path, "model-exchange", 0.5, 100.0, start=start)
    expected = by_euler(path, 100.0, 0.5, start)
    assert np.ptp(found["tank_1.level"]) > 1e-3
    for name in ("tank_1.level", "tank_2.level", "level_3"):
        there = np.interp(expected["time"], found["time"], found[name])
        assert there == pytest.approx(expected[name], rel=1e-12)


@pytest.mark.parametrize("version", VERSIONS)
def test_events_are_carried_out(version, simulator, tmp_path):
    """A tank without inflow is pumped empty: its pump runs dry, and the event stops it."""
    path = written(exchange_of("averaging-tank"), tmp_path, version)
    start = {"tank.level": 0.3, "inflow": 0.0}
    found = simulated(simulator, path, "model-exchange", 0.1, 20.0, start=start)
    expected = by_euler(path, 20.0, 0.1, start)
    level = "tank.level"
    assert found[level][0] == 0.3
    assert abs(found[level][-1]) < 0.05
    assert np.ptp(np.diff(found[level])[-20:]) < 1e-9
    there = np.interp(expected["time"], found["time"], found[level])
    assert there == pytest.approx(expected[level], abs=1e-9)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_stem_with_play_is_left_behind(version, simulator, tmp_path):
    """The valve is driven from its start to 60 %, and back by less and by more than its play."""
    model = exchange_model(rig(tmp_path, FRICTIONS[0]), origin("rig", 1.0))
    path = written(model, tmp_path, version)
    time = np.arange(0.0, 60.5, 0.5)
    throttle = np.select([time < t for t in (20, 22)], [0.6, 0.565], default=0.3)
    start = {"throttle.position": 0.4, "throttle.stem": 0.4, "throttle.begins": 0.0}
    inputs = {"time": time, "throttle": throttle}
    found = simulated(simulator, path, "model-exchange", 0.5, 60.0, inputs=inputs, start=start)
    columns = [("time", float), ("throttle", float)]
    table = np.array(list(zip(time, throttle, strict=True)), dtype=columns)
    names = ["throttle.position", "upper.level", "lower.level"]
    expected = by_euler(path, 60.0, 0.5, start, table, [*names, "throttle.stem"])
    for name in names:
        there = np.interp(expected["time"], found["time"], found[name])
        assert np.ptp(found[name]) > 1e-2
        assert there == pytest.approx(expected[name], rel=1e-12)
    stems = set(np.round(expected["throttle.stem"], 9))
    assert {0.4, 0.57} <= stems, "as it starts, and 3 % behind 60 %"


def by_euler(path, stop, step, start, inputs=None, outputs=None):
    return fmpy.simulate_fmu(
        str(path), stop_time=stop, solver="Euler", step_size=step, output_interval=step,
        start_values=start, input=inputs, output=outputs,
    )  # fmt: skip
