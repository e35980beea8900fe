"""Engine, C and Structured Text of fuzzy controllers, equal in every bit."""

import re

import numpy as np
import pytest
from deployed import all_bits, no_output_lay_idle, run_alike, run_both, spoilt
from plants import designed, plant

import clepsydra as cl
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.defaults import with_defaults

SCANS, HELD = 1_500, 20

#: Gaussians, upright edges, OR, a rate limit: one input, one output.
ONE_INPUT = """
points = 37
[inputs.e]
of = "level_1"
quantity = "measurement"
unit = "V"
gain = 0.31
dead_zone = 0.07
[inputs.e.sets]
N = { gaussian = [-1, 0.3] }
B = { trapezoid = [-0.5, -0.5, 0.1, 0.1] }
P = { gaussian = [0.7, 0.41] }
[outputs.u]
moves = "pump_1"
action = "increment"
unit = "V/s"
range = [-1, 1]
gain = 1.3
rate_limit = "0.9 V/s"
[outputs.u.sets]
S = { triangle = [-1, -1, 0.3] }
M = { gaussian = [0, 0.2] }
L = { right_shoulder = [0, 0.7] }
[rules]
R1 = "if e is N then u is S"
R2 = "if e is B or e is P and e is N then u is M"
R3 = "if e is P then u is L"
"""
#: One range, and sets that differ.
TWO_OUTPUTS = """
[inputs.e]
of = "level_1"
quantity = "measurement"
unit = "V"
gain = 0.31
[inputs.e.sets]
N = { left_shoulder = [-1, 1] }
P = { right_shoulder = [-1, 1] }
[outputs.u]
moves = "pump_1"
action = "increment"
unit = "V/s"
range = [-1, 1]
[outputs.u.sets]
S = { left_shoulder = [-1, 0.5] }
L = { right_shoulder = [-0.5, 1] }
[outputs.v]
moves = "pump_2"
action = "increment"
unit = "V/s"
range = [-1, 1]
[outputs.v.sets]
S = { left_shoulder = [-1, 0] }
L = { right_shoulder = [0, 1] }
[rules]
R1 = "if e is N then u is S and v is L"
R2 = "if e is P then u is L and v is S"
"""
#: Filtered rates, a dead zone, positions: four inputs, three outputs, 27 rules.
WIDE = """
[inputs.e_C]
of = "concentration"
unit = "kmol/m^3"
gain = 14
[inputs.e_C.sets]
N = { left_shoulder = [-0.2, 0] }
ZO = { triangle = [-0.08, 0, 0.08] }
P = { right_shoulder = [0, 0.2] }
[inputs.de_C]
of = "concentration"
quantity = "error_rate"
unit = "kmol/m^3/s"
gain = 0.025
filter_time = "0.13 s"
[inputs.de_C.sets]
N = { left_shoulder = [-0.2, 0] }
ZO = { triangle = [-0.2, 0, 0.2] }
P = { right_shoulder = [0, 0.2] }
[inputs.e_V]
of = "volume"
unit = "m^3"
gain = 15
[inputs.e_V.sets]
NL = { left_shoulder = [-0.45, 0] }
NS = { triangle = [-0.1, -0.05, 0] }
ZO = { triangle = [-0.01, 0, 0.01] }
PS = { triangle = [0, 0.05, 0.1] }
PL = { right_shoulder = [0, 0.45] }
[inputs.de_V]
of = "volume"
quantity = "error_rate"
unit = "m^3/s"
gain = 0.1
dead_zone = 1e-3
filter_time = "0.07 s"
[inputs.de_V.sets]
N = { left_shoulder = [-1, 0] }
ZO = { triangle = [-0.02, 0, 0.02] }
P = { right_shoulder = [0, 1] }
[outputs.f_in]
moves = "inflow"
unit = "m^3/s"
range = [0, 1]
[outputs.f_in.sets]
ZO = { left_shoulder = [0.05, 0.2] }
S = { triangle = [0.14, 0.2, 0.26] }
M = { triangle = [0.2, 0.35, 0.6] }
LM = { triangle = [0.5, 0.6, 0.8] }
LL = { right_shoulder = [0.6, 0.8] }
[outputs.f_out]
moves = "outflow"
unit = "m^3/s"
range = [0, 1]
[outputs.f_out.sets]
ZO = { left_shoulder = [0.05, 0.2] }
S = { triangle = [0.14, 0.2, 0.26] }
M = { triangle = [0.2, 0.35, 0.6] }
LM = { triangle = [0.5, 0.6, 0.8] }
LL = { right_shoulder = [0.6, 0.8] }
[outputs.C_in]
moves = "inflow.impurity"
unit = "kmol/m^3"
range = [0, 25]
[outputs.C_in.sets]
ZO = { left_shoulder = [0, 4.9] }
S = { triangle = [4.5, 5, 5.5] }
L = { right_shoulder = [5.1, 10] }
[rules]
"""
FLOWS, ERRORS = ("ZO", "S", "M", "LM", "LL"), ("N", "ZO", "P")


def wide_rules():
    """Fill where the volume is low, empty where it is high; both where only the quality is off."""
    for e, far in enumerate(("NL", "NS", "ZO", "PS", "PL")):
        for d, rate in enumerate(ERRORS):
            filled = FLOWS[min(max(e + d - 1, 0), 4)]
            emptied = FLOWS[4 - min(max(e + d - 1, 0), 4)]
            yield f"e_V is {far} and de_V is {rate} then f_in is {filled} and f_out is {emptied}"
    for e, off in enumerate(ERRORS):
        for d, rate in enumerate(ERRORS):
            entered = ("ZO", "S", "L")[min(max(e + d - 1, 0), 2)]
            yield f"e_C is {off} and de_C is {rate} then C_in is {entered}"
        both = ("LL", "M", "LL")[e]
        still = f"e_C is {off} and e_V is ZO and de_V is ZO"
        yield f"{still} then f_in is {both} and f_out is {both}"


def of_a_file(folder, process, text):
    path = folder / "rules.toml"
    path.write_text(text)
    return cl.design.fuzzy(plant(process), path)


def wide(folder):
    rules = [f'R{k} = "if {rule}"' for k, rule in enumerate(wide_rules(), start=1)]
    assert len(rules) == 27
    return of_a_file(folder, "averaging-tank:all-inputs", WIDE + "\n".join(rules))


def of_the_design(folder):
    return designed("fuzzy_pi", "quadruple-tank")


def one_input(folder):
    return of_a_file(folder, "quadruple-tank", ONE_INPUT)


def scans(program, seed):
    random = np.random.default_rng(seed)
    at = {s.name: s.initial for s in program.inputs}
    inputs = {}
    for signal in program.inputs:
        name, base = signal.name, at[signal.name]
        size = max(abs(base), 1.0)
        if signal.part == "mode":
            inputs[name] = np.repeat(
                random.choice([0.0, 1.0, 2.0, 3.0], SCANS // HELD, p=[0.1, 0.75, 0.1, 0.05]), HELD
            )
        elif signal.part == "good":
            inputs[name] = (random.random(SCANS) < 0.97).astype(float)
        elif name == "time_step":
            steps = random.choice([1.0, 0.1, 1 / 3], SCANS)
            bad = random.choice([0.0, -1.0, np.nan, np.inf], SCANS)
            inputs[name] = np.where(random.random(SCANS) < 0.97, steps, bad)
        elif signal.part == "pv":
            walk = np.cumsum(random.normal(scale=0.003, size=SCANS))
            inputs[name] = spoilt(
                random, base + size * np.sin(walk) * 0.1 + 0.3 * (base == 0), 0.02
            )
        else:
            levels = base + size * random.uniform(-0.05, 0.05, SCANS // HELD)
            inputs[name] = spoilt(random, np.repeat(levels, HELD), 0.01)
    return inputs


def at_rest(controller):
    """The program with the inputs that its plant has at rest."""
    at = controller.plant.point.as_dict()
    wires = controller.input_wires
    rest = {n: at[w.rpartition(".")[0]] if w.endswith((".setpoint", ".manual", ".tracking"))
            else at.get(w) for n, w in wires.items()}  # fmt: skip
    return with_defaults(controller.program(), {n: v for n, v in rest.items() if v is not None})


@pytest.mark.thorough
@pytest.mark.parametrize("make", [wide, of_the_design, one_input])
def test_engine_c_and_structured_text_are_equal_in_every_bit(make, tmp_path):
    controller = make(tmp_path)
    # The level of the law of one input is drawn round that of its sets.
    program = controller.program() if make is one_input else at_rest(controller)
    inputs = scans(program, seed=4)
    engine = run_alike(program, tmp_path, inputs)
    no_output_lay_idle(program, engine, (1, 2, 16, 32, 64), 300)


def test_the_points_are_a_for_in_both_languages(tmp_path):
    program = wide(tmp_path).program()
    in_c, text = print_c(program).source, print_structured_text(program)
    assert in_c.count("for (") == text.count("FOR ") >= 10


def test_outputs_of_one_shape_share_a_block_and_others_have_none(tmp_path):
    (rules,) = (c.program for c in wide(tmp_path).program().calls if c.instance == "rules")
    assert {c.instance: c.program.name for c in rules.calls} == {
        "f_in": "f_in_centroid",
        "f_out": "f_in_centroid",
    }


def test_outputs_of_one_range_and_several_shapes_compute_their_degrees(tmp_path):
    """Their points are the same: neither has a list of numbers in its text."""
    program = of_a_file(tmp_path, "quadruple-tank", TWO_OUTPUTS).program()
    text = print_structured_text(program)
    loops = re.findall(r"FOR i := .* DO\n  u_point := 0\.02 \* DINT_TO_LREAL\(i\) - 1\.0;", text)
    assert len(loops) == text.count("FOR i := ") == 5
    assert "ARRAY" not in text
    inputs = scans(program, seed=4)
    bits = all_bits(engine_run(program, inputs))
    for found in run_both(program, tmp_path, inputs):
        assert np.array_equal(bits, all_bits(found))


@pytest.mark.parametrize("name", ["e", "double", "FOR", "u", "first try", "ä"])
def test_a_rule_may_have_any_name(tmp_path, name):
    text = ONE_INPUT.replace("R1 =", f'"{name}" =')
    assert text != ONE_INPUT
    program = of_a_file(tmp_path, "quadruple-tank", text).program()
    inputs = scans(program, seed=4)
    bits = all_bits(engine_run(program, inputs))
    for found in run_both(program, tmp_path, inputs):
        assert np.array_equal(bits, all_bits(found))


@pytest.mark.parametrize("name", ["double", "centroid", "moment", "i", "END_IF"])
def test_a_set_may_have_the_name_of_a_word_of_a_language_or_of_a_port(tmp_path, name):
    text = ONE_INPUT.replace("M = {", f"{name} = {{").replace("u is M", f"u is {name}")
    # Two rules that conclude it are one, which is called by its name.
    program = of_a_file(
        tmp_path, "quadruple-tank", f'{text}R4 = "if e is B then u is {name}"'
    ).program()
    for printed in (print_c(program).source, print_structured_text(program)):
        assert f"u_degree_{name}" in printed
        assert re.search(rf"\bu_{name}\w* :?= ", printed)
    inputs = scans(program, seed=4)
    bits = all_bits(engine_run(program, inputs))
    for found in run_both(program, tmp_path, inputs):
        assert np.array_equal(bits, all_bits(found))
