"""What the page writes of a stretch is read: by `identify`, by SciPy, and by Octave."""

import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
from page_in_node import answered, source
from scipy.io import loadmat
from tools import without

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig

SCRIPT = f"""
import {{ columnOf, csvParts, matRecord }} from "{source("lab/record.ts")}";
import {{ writeFileSync }} from "node:fs";
const signals = new Map(given.signals.map((each) => [each.name, each]));
const columns = (names, end = "") => names.map((name) =>
  columnOf(signals.get(name), name + end, Float64Array.from(given.values[name + end])));
const [y, yref] = [columns(given.controlled), columns(given.controlled, ".setpoint")];
const [u, d] = [columns(given.inputs), columns(given.disturbances)];
const {{ first, period }} = given;
writeFileSync("record.csv", csvParts(first, period, [...y, ...yref, ...u, ...d]).join(""));
writeFileSync("record.mat", matRecord(first, period, {{ y, yref, u, d }}));
answer(null);
"""
OCTAVE = """
load record.mat
printf("%d %d %d %d\\n", size(t), size(signals));
printf("%.17g ", t(3), y1(3), yref2(3), u1(end), d1(end));
printf("\\n%s\\n", strtrim(signals(2, :)));
"""


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def run(plant):
    return cl.simulate(plant, None, [cl.step("pump_1", "200 mV", at="1 min")], duration="40 min")


@pytest.fixture(scope="module")
def recorded(plant, run):
    """The run, and what the page knows of its signals."""
    data = page_data(Rig(plant.linear, [cl.design.simc(plant)]))
    values = {name: run.values[name].tolist() for name in
              (*data["controlled"], *data["inputs"], *data["disturbances"])}  # fmt: skip
    values |= {f"{name}.setpoint": values[name] for name in data["controlled"]}
    names = ("signals", "controlled", "inputs", "disturbances", "period")
    return {name: data[name] for name in names} | {"values": values, "first": 7}


@pytest.fixture(scope="module")
def folder(recorded, tmp_path_factory):
    found = tmp_path_factory.mktemp("record")
    answered(SCRIPT, recorded, found)
    return found


def test_the_command_line_identifies_what_was_saved_as_csv(folder, run):
    run.save(folder / "run.csv")
    pair = ("pump_1", "level_1")
    wanted = cl.identify(folder / "run.csv", *pair).models[0]
    command = (sys.executable, "-m", "clepsydra", "identify", "record.csv", "--manipulated",
               pair[0], "--measured", pair[1], "--json")  # fmt: skip
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)["models"][0]
    assert found["name"] == wanted.name
    values = [each["value"] for each in found["estimates"]]
    assert values == pytest.approx([each.value for each in wanted.estimates], rel=1e-6)


def test_csv_has_each_value_as_it_was(folder, recorded):
    head, *rows = (folder / "record.csv").read_text("utf-8").splitlines()
    units = {"inflow_1": ("cm³/s", 1e6), "inflow_2": ("cm³/s", 1e6)}
    table = np.array([row.split(",") for row in rows], dtype=float)
    np.testing.assert_array_equal(table[:, 0], 7.0 + np.arange(len(rows)))
    columns = dict(zip(head.split(","), table.T, strict=True))
    assert len(columns) == 1 + len(recorded["values"])
    for name, values in recorded["values"].items():
        unit, factor = units.get(name, ("V", 1.0))
        np.testing.assert_allclose(
            columns[f"{name} [{unit}]"], factor * np.array(values), rtol=1e-12
        )


def test_scipy_reads_what_was_saved_as_mat(folder, recorded):
    found = loadmat(folder / "record.mat")
    values, samples = recorded["values"], len(recorded["values"]["level_1"])
    np.testing.assert_array_equal(found["t"][:, 0], 7.0 + np.arange(samples))
    for name, key in (("y2", "level_2"), ("yref1", "level_1.setpoint"), ("u2", "pump_2")):
        np.testing.assert_array_equal(found[name][:, 0], values[key])
    np.testing.assert_allclose(found["d1"][:, 0], 1e6 * np.array(values["inflow_1"]), rtol=1e-12)
    signals = [line.rstrip() for line in found["signals"]]
    assert signals[0] == "t = time [s]"
    assert {"y1 = level_1 [V]", "yref2 = level_2.setpoint [V]", "d1 = inflow_1 [cm^3/s]"} <= {
        *signals
    }


def test_octave_reads_what_was_saved_as_mat(folder, recorded):
    octave = shutil.which("octave")
    if octave is None:
        without("octave is not installed", "CLEPSYDRA_REQUIRE_OCTAVE")
    command = (octave, "--norc", "--no-gui", "--eval", OCTAVE)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    sizes, numbers, words = done.stdout.splitlines()
    values = recorded["values"]
    assert sizes.split()[:3] == [str(len(values["level_1"])), "1", "9"]
    assert [float(each) for each in numbers.split()] == pytest.approx(
        [9.0, values["level_1"][2], values["level_2.setpoint"][2], values["pump_1"][-1],
         1e6 * values["inflow_1"][-1]], rel=1e-12,
    )  # fmt: skip
    assert words == "y1 = level_1 [V]"
