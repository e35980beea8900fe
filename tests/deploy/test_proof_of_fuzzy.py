"""Engine, C and Structured Text of fuzzy controllers, equal in every bit."""

import dataclasses

import numpy as np
import pytest
from deployed import all_bits, run_both
from test_proof import simulated, spoilt

from clepsydra import Signal, program_of
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.kinds import FuzzyInput, FuzzyOutput
from clepsydra.controllers.fuzzy.law import fuzzy_law
from clepsydra.controllers.fuzzy.membership import Gaussian, Trapezoid, right_shoulder, triangle
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.controllers.fuzzy.wired import WiredFuzzy
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.designs.fuzzy_control import design_fuzzy_pi
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.averaging_tank.fuzzy import RULES
from clepsydra.process.reader import load_process
from clepsydra.program.defaults import with_defaults

SCANS, HELD = 1_500, 20

pytestmark = pytest.mark.thorough


def of_the_document():
    point = find_equilibrium(load_process("averaging-tank:all-inputs"))
    controller = WiredFuzzy(load_fuzzy(RULES), point.process).controller(point, "document")
    values = controller.values | {"filter_time_2": 0.13, "filter_time_4": 0.07, "dead_zone_4": 1e-3}
    return dataclasses.replace(controller, values=values).program(), controller


def of_the_design():
    analysis = analyse(load_process("quadruple-tank"))
    controller = design_fuzzy_pi(analysis.model, analysis.pairing)
    return controller.program(), controller


def of_all_shapes():
    """Gaussians, upright edges, OR, a rate limit: one input, one output."""
    e = LinguisticVariable(
        "e", -1.0, 1.0,
        {"N": Gaussian(-1.0, 0.3), "B": Trapezoid(-0.5, -0.5, 0.1, 0.1), "P": Gaussian(0.7, 0.41)},
    )  # fmt: skip
    u = LinguisticVariable(
        "u",
        -1.0,
        1.0,
        {"S": triangle(-1, -1, 0.3), "M": Gaussian(0, 0.2), "L": right_shoulder(0, 0.7)},
    )
    rules = tuple(
        parse_rule(f"R{k}", text)
        for k, text in enumerate(
            ("if e is N then u is S", "if e is B or e is P and e is N then u is M",
             "if e is P then u is L"), 1)
    )  # fmt: skip
    law = fuzzy_law(
        FuzzySystem((e,), (u,), rules, 37),
        [FuzzyInput("measurement", 1)],
        [FuzzyOutput("increment", rate_limited=True)],
        measured=[Signal("level", "V", low=0.0, high=10.0)],
        manipulated=[Signal("pump", "V", low=0.0, high=10.0)],
    )
    values = {"input_gain_1": 0.31, "dead_zone_1": 0.07, "output_gain_1": 1.3, "rate_limit_1": 0.9}
    return with_defaults(program_of(law), values), None


def scans(program, controller, seed):
    random = np.random.default_rng(seed)
    at = {s.name: s.initial for s in program.inputs}
    inputs = {}
    for signal in program.inputs:
        name, base = signal.name, at[signal.name]
        size = max(abs(base), 1.0)
        if name.startswith("mode_"):
            inputs[name] = np.repeat(
                random.choice([0.0, 1.0, 2.0, 3.0], SCANS // HELD, p=[0.1, 0.75, 0.1, 0.05]), HELD
            )
        elif name.startswith("sensor"):
            inputs[name] = (random.random(SCANS) < 0.97).astype(float)
        elif name == "time_step":
            steps = random.choice([1.0, 0.1, 1 / 3], SCANS)
            bad = random.choice([0.0, -1.0, np.nan, np.inf], SCANS)
            inputs[name] = np.where(random.random(SCANS) < 0.97, steps, bad)
        elif name.startswith("measurement"):
            walk = np.cumsum(random.normal(scale=0.003, size=SCANS))
            inputs[name] = spoilt(
                random, base + size * np.sin(walk) * 0.1 + 0.3 * (base == 0), 0.02
            )
        else:
            levels = base + size * random.uniform(-0.05, 0.05, SCANS // HELD)
            inputs[name] = spoilt(random, np.repeat(levels, HELD), 0.01)
    return inputs


@pytest.mark.parametrize("make", [of_the_document, of_the_design, of_all_shapes])
def test_engine_c_and_structured_text_are_equal_in_every_bit(make, tmp_path):
    program, controller = make()
    if controller is not None:
        name = "averaging-tank:all-inputs" if make is of_the_document else "quadruple-tank"
        point = find_equilibrium(load_process(name))
        at = point.as_dict()
        wires = controller.input_wires
        rest = {n: at[w.rpartition(".")[0]] if w.endswith((".setpoint", ".manual", ".tracking"))
                else at.get(w) for n, w in wires.items()}  # fmt: skip
        program = with_defaults(program, {n: v for n, v in rest.items() if v is not None})
    inputs = scans(program, controller, seed=4)
    engine = simulated(program, inputs)
    in_c, in_text = run_both(program, tmp_path, inputs)
    assert np.isfinite(engine).all()
    assert np.array_equal(all_bits(engine), all_bits(in_c))
    assert np.array_equal(all_bits(engine), all_bits(in_text))
    for column, output in enumerate(signal.name for signal in program.outputs):
        if output.startswith("status"):
            word = engine[:, column].astype(int)
            for bit in (1, 2, 16, 32, 64):
                assert np.any(word & bit) and not np.all(word & bit), (output, bit)
        else:
            assert len(np.unique(engine[:, column])) > 300, output


def test_the_points_are_a_for_in_both_languages():
    program, _ = of_the_document()
    in_c, text = print_c(program).source, print_structured_text(program)
    assert in_c.count("for (") == text.count("FOR ") >= 15
