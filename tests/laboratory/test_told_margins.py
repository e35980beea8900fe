"""What a page tells of a law before it is switched on, beside what Python tells of the same law."""

import dataclasses
import math

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.free_laws import TypedLoops
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig

FIRST = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ lawParameters }} from "{source("lab/brought.ts")}";
import {{ loopMargins, metPlant, ratesOf }} from "{source("lab/loop_margins.ts")}";
import * as law from "{source("lab/linear_law.ts")}";
import * as typed from "{source("lab/typed_loops.ts")}";
const matrixOf = ([rows, columns, values]) =>
  ({{ rows, columns, values: Float64Array.from(values) }});
"""
MATRICES = (
    FIRST
    + """
const met = await metPlant(given.data.laws.plants[0]);
answer(given.regulators.map(({ matrices, sign, inputs, outputs }) => {
  const [A, B, C, D] = matrices.map(matrixOf);
  const { period } = given.data;
  const sampled = law.sampledAt(period, { name: "reg1.mat", A, B, C, D, period: null });
  const system = law.inSi(sampled, inputs, outputs, sign);
  const joined = new Set([...met.names.measurements, ...met.names.manipulated]);
  return loopMargins(met, system, joined, period);
}));
"""
)
TYPED = (
    FIRST
    + """
const { data } = given;
const modules = await Promise.all(
  data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
const found = [];
for (const free of data.laws.free.filter((each) => each.kind === "pid")) {
  const met = await metPlant(data.laws.plants[free.plant]);
  const own = lawParameters(data, free.controller).map(([, value]) => value);
  const loops = free.pairs.map(() => given.loops[free.form]);
  const values = typed.valuesOf(free, own, loops, data.period);
  const linear = new typed.LinearLoops(free, own, modules).at(values);
  const joined = new Set([...met.names.measurements, ...met.names.manipulated]);
  found.push({ values, ...loopMargins(met, linear, joined, data.period) });
}
answer(found);
"""
)


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def rig(plant):
    return Rig(plant.linear, [cl.design.simc(plant)])


def flat(matrix):
    matrix = np.atleast_2d(matrix)
    return [*matrix.shape, matrix.ravel().tolist()]


def same_margins(told, plant, controller):
    """Nine digits are those of a design's numbers, and a grid of frequencies is that of poles."""
    wanted = cl.margins(controller, plant)
    found = {each["name"]: each for each in told["margins"]}
    assert set(found) == set(wanted.index)
    for name, row in wanted.iterrows():
        assert found[name]["gain"] == pytest.approx(row["gain margin"], rel=1e-6)
        assert found[name]["phase"] == pytest.approx(row["phase margin [deg]"], rel=1e-6)
        assert found[name]["delay"] == pytest.approx(row["delay margin [s]"], rel=1e-6)


def test_margins_of_matrices_are_those_of_the_design(plant, rig, tmp_path):
    integral = np.zeros((2, 2)), np.diag([0.1, 0.0675]), np.eye(2), np.diag([3.0, 2.7])
    regulators = [
        {"matrices": [*map(flat, integral)], "sign": sign, "inputs": [1, 1], "outputs": [1, 1]}
        for sign in (-1, 1)
    ]
    given = {"data": page_data(rig), "regulators": regulators}
    right, wrong = answered(MATRICES, given, tmp_path)
    controller = cl.design.regulator(plant, integral)
    assert right["isStable"]
    assert f"sensitivity peak {right['peak']:.2f}" in controller.design
    same_margins(right, plant, controller)
    # The other sign is told to be unstable, and no margins of it.
    assert not wrong["isStable"] and wrong["margins"] == []


@pytest.mark.parametrize(("integral", "derivative"), [(30.0, 0.0), (40.0, 5.0)])
def test_margins_of_typed_loops_are_those_of_a_controller(
    plant, rig, integral, derivative, tmp_path
):
    """The settings of each form by hand, and those that follow: tracking times and filters."""
    tracking = math.sqrt(integral * derivative) if derivative else integral
    times = {
        "proportional_gain": 3.0, "integral_time": integral, "derivative_time": derivative,
        "derivative_filter": 10.0, "setpoint_weight": 0.5, "tracking_time": tracking,
    }  # fmt: skip
    gains = {
        "proportional_gain": 3.0, "integral_gain": 3.0 / integral,
        "derivative_gain": 3.0 * derivative, "filter_time": 0.5, "setpoint_weight": 0.5,
        "tracking_time": tracking,
    }  # fmt: skip
    loops = {
        "isa": {"gain": 3.0, "integral": integral, "derivative": derivative, "filter": 10.0},
        "parallel": {
            "gain": 3.0, "integral": 3.0 / integral, "derivative": 3.0 * derivative, "filter": 0.5,
        },
    }  # fmt: skip
    loops["series"] = loops["isa"]
    loops = {form: each | {"weight": 0.5} for form, each in loops.items()}
    found = answered(TYPED, {"data": page_data(rig), "loops": loops}, tmp_path)
    free = [each for each in rig.free if isinstance(each, TypedLoops)]
    for each, told in zip(free, found, strict=True):
        own = gains if each.form.algorithm == "parallel" else times
        values = {
            parameter.name: own.get(parameter.part, each.controller.values[parameter.name])
            for parameter in each.controller.law.parameters
        }
        assert told["values"] == pytest.approx(list(values.values()), rel=1e-12)
        # What remembers a setting begins with it.
        state = {
            name: value
            for name, value in each.controller.initial_state.items()
            if name.partition(".last_")[2] not in own
        }
        fields = [field.name for field in dataclasses.fields(each.controller)]
        kept = {name: getattr(each.controller, name) for name in fields}
        changed = {"values": values, "initial_state": state, "plant": plant}
        controller = cl.Controller(**(kept | changed))
        assert told["isStable"] == (each.pairs[0] == ("level_1", "pump_1"))
        if told["isStable"]:
            same_margins(told, plant, controller)


def test_poles_are_told_by_what_they_do(tmp_path):
    script = FIRST + "answer(given.map(([A, period]) => ratesOf(matrixOf(A), period)));"
    A = np.diag([1e-17, -0.2, 0.3, -2e-9])
    continuous, sampled = answered(
        script, [[flat(A), None], [flat(np.diag(np.exp(0.5 * np.diag(A)))), 0.5]], tmp_path
    )
    for found in (continuous, sampled):
        kinds = [each["kind"] for each in found]
        assert kinds == ["integrator", "dies out", "dies out", "grows"]
        assert [each["real"] for each in found[1:]] == pytest.approx([-2e-9, -0.2, 0.3], rel=1e-6)
