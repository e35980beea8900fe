"""The centroid of a Mamdani system by four routes, and what makes a system unfit."""

import casadi as ca
import numpy as np
import pytest
from fuzzy_rig import DOCUMENT, aggregated, exact_centroid, plain_heights, summed_centroid

from clepsydra import InputError, Kernel, Signal, program_of
from clepsydra.controllers.fuzzy.inference import rule_base, surface
from clepsydra.controllers.fuzzy.membership import (
    Gaussian,
    Trapezoid,
    left_shoulder,
    right_shoulder,
    triangle,
)
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.program import ForLoop
from clepsydra.program.step_law import Equations, step_law


def mixed_system(points=101):
    """Every shape, AND, OR and brackets, and an output whose range begins below zero."""
    e = LinguisticVariable(
        "e",
        -2.0,
        3.0,
        {
            "N": left_shoulder(-2, 0.5),
            "Z": Gaussian(0.5, 0.8),
            "M": Trapezoid(0, 0.5, 1, 2.5),
            "P": right_shoulder(0.5, 3),
        },
    )
    d = LinguisticVariable("d", -1.0, 1.0, {"N": Gaussian(-1, 0.5), "P": Gaussian(1, 0.5)})
    u = LinguisticVariable(
        "u",
        -3.0,
        7.0,
        {
            "S": left_shoulder(-2.5, 0.1),
            "M": Trapezoid(-1, 0.3, 0.3, 4),
            "B": Gaussian(3.0, 1.1),
            "L": right_shoulder(3, 6.5),
        },
    )
    rules = (
        "if e is N and d is N then u is S",
        "if e is Z or e is N and d is P then u is M",
        "if (e is M or e is P) and d is N then u is B",
        "if e is P and d is P then u is L",
    )
    numbered = tuple(parse_rule(f"R{i}", rule) for i, rule in enumerate(rules, 1))
    return FuzzySystem((e, d), (u,), numbered, points)


def law_of(system):
    names, rules = [variable.name for variable in system.inputs], rule_base(system, "rules")

    def equations(s):
        found = rules("inference", s, {}).outputs
        return Equations({}, {u.name: found[f"{u.name}.centroid"] for u in system.outputs})

    return step_law(
        "inference",
        inputs=[Signal(name) for name in names],
        parameters=[],
        state=[],
        outputs=[Signal(output.name) for output in system.outputs],
        equations=equations,
    )


def random_inputs(system, count, seed):
    """All over the ranges and somewhat beyond, with every tenth number at a corner of a set."""
    random = np.random.default_rng(seed)
    columns = {}
    for v in system.inputs:
        span = v.high - v.low
        column = random.uniform(v.low - 0.2 * span, v.high + 0.2 * span, count)
        small = random.random(count) < 0.5
        column[small] *= 0.1
        corners = [0.0, v.low, v.high, *(c for s in v.sets.values() for c in s.corners)]
        at = random.random(count) < 0.1
        column[at] = random.choice(corners, int(at.sum()))
        columns[v.name] = column
    return columns


@pytest.mark.parametrize("system", [DOCUMENT, mixed_system()], ids=["document", "mixed"])
def test_the_engine_agrees_with_plain_python_rule_by_rule(system):
    inputs = random_inputs(system, 400, seed=5)
    run = Kernel(program_of(law_of(system))).run(400, inputs=inputs)
    worst = 0.0
    for k in range(400):
        heights = plain_heights(system, {name: column[k] for name, column in inputs.items()})
        for output in system.outputs:
            points = np.linspace(output.low, output.high, system.points)
            expected = summed_centroid(output, heights[output.name], points)
            difference = abs(run.output(output.name)[0, k] - expected)
            worst = max(worst, difference / (output.high - output.low))
    assert worst < 1e-13


def test_all_points_in_one_loop_give_the_same_bits():
    """The stretches leave out what adds nothing: not a bit may change."""
    system, output = DOCUMENT, DOCUMENT.outputs[2]
    points = system.points_of(output)
    names = list(output.sets)
    row, sums, held = ca.SX.sym("row", 1 + len(names)), ca.SX.sym("s", 2), ca.SX.sym("h", 3)
    largest = ca.SX(0)
    for place in range(len(names)):
        largest = ca.fmax(largest, ca.fmin(held[place], row[1 + place]))
    turn = ca.Function(
        "turn", [row, sums, held], [ca.vertcat(sums[0] + row[0] * largest, sums[1] + largest)]
    )
    tables = [list(points), *(list(output.sets[name].degrees(points)) for name in names)]
    whole = counted_loop("whole", 101, turn, carried=ca.SX.zeros(2), tables=tables, invariants=held)
    by_one_loop = ca.Function("f", [held], [whole[0] / whole[1]])
    inputs = random_inputs(system, 300, seed=6)
    run = Kernel(program_of(law_of(system)), fuse=False).run(300, inputs=inputs)
    for k in range(300):
        heights = plain_heights(system, {name: column[k] for name, column in inputs.items()})
        expected = float(by_one_loop([heights["C_in"][name] for name in names]))
        assert run.output("C_in")[0, k] == expected


@pytest.mark.thorough
def test_the_sum_tends_to_the_centroid_of_the_area():
    """The exact centroid, fine integration, and 101 and 1,001 points: three routes to one end."""
    errors = {101: [], 1001: []}
    systems = {n: FuzzySystem(DOCUMENT.inputs, DOCUMENT.outputs, DOCUMENT.rules, n) for n in errors}
    functions = {n: surface(system) for n, system in systems.items()}
    inputs = random_inputs(DOCUMENT, 15, seed=7)
    for k in range(15):
        values = {name: column[k] for name, column in inputs.items()}
        heights = plain_heights(DOCUMENT, values)
        found = {n: np.array(f(list(values.values()))[0]).ravel() for n, f in functions.items()}
        for j, output in enumerate(DOCUMENT.outputs):
            span = output.high - output.low
            exact = exact_centroid(output, heights[output.name])
            edges = np.linspace(output.low, output.high, 200_001)
            middles = (edges[1:] + edges[:-1]) / 2
            fine = summed_centroid(output, heights[output.name], middles)
            assert abs(exact - fine) < 1e-8 * span
            for n in errors:
                errors[n].append(abs(found[n][j] - exact) / span)
    # Half a point too much at each end of the range: of first order in their distance.
    assert max(errors[101]) < 0.01 and max(errors[1001]) < 0.001
    assert 5 < np.mean(errors[101]) / np.mean(errors[1001]) < 20


def test_the_exact_centroid_is_right_where_it_is_known():
    """A triangle of height 1 over 0 to 1 that peaks at 0.2: its centroid is (0 + 0.2 + 1)/3."""
    u = LinguisticVariable("u", 0.0, 1.0, {"T": triangle(0.0, 0.2, 1.0)})
    assert exact_centroid(u, {"T": 1.0}) == pytest.approx(0.4, abs=1e-14)
    # Clipped at a half: a trapezoid over 0 … 1 with top from 0.1 to 0.6.
    area = 0.5 * (1 + 0.5) / 2
    moment = 0.5 * 0.1 / 2 * 0.2 / 3 + 0.25 * 0.35 + 0.5 * 0.4 / 2 * (0.6 + 0.4 / 3)
    assert exact_centroid(u, {"T": 0.5}) == pytest.approx(moment / area, abs=1e-14)


def test_the_loops_stay_loops():
    program = program_of(law_of(DOCUMENT))
    loops = [s for s in program.block.statements if isinstance(s, ForLoop)]
    assert sum(loop.count for loop in loops) == 3 * 101
    assert len(list(program.block.operations())) < 300


def test_inputs_are_clipped_to_their_ranges():
    f = surface(DOCUMENT)
    inside, beyond = f([1.0, -1.0, 1.0, -1.0])[0], f([7.0, -1e9, 30.0, -2.0])[0]
    assert np.array_equal(np.array(inside), np.array(beyond))


def test_derivatives_are_the_mean_slope_at_a_corner_and_the_slope_elsewhere():
    sets = {"N": left_shoulder(-1, 0), "Z": triangle(-1, 0, 1), "P": right_shoulder(0, 1)}
    e, u = (LinguisticVariable(name, -1.0, 1.0, sets) for name in "eu")
    rules = tuple(parse_rule(s, f"if e is {s} then u is {s}") for s in sets)
    f = surface(FuzzySystem((e,), (u,), rules))
    x = ca.SX.sym("x")
    slope = ca.Function("slope", [x], [ca.jacobian(2 * f(3 * x)[0], x)])
    for place in (0.0, 0.1, -0.07):
        ways = [(float(f(3 * place + h)[0]) - float(f(3 * place - h)[0])) / (2 * h)
                for h in (1e-4, 2e-5)]  # fmt: skip
        assert float(slope(place)) == pytest.approx(6 * ways[1], rel=1e-3)
        assert ways[1] > 0.01


def test_the_middle_and_no_fire_where_nothing_fires():
    """It cannot be read from a file, but a parameter may be changed to it at run time."""
    e = LinguisticVariable("e", -1.0, 1.0, {"N": left_shoulder(-1, 1), "P": right_shoulder(-1, 1)})
    u = LinguisticVariable("u", 0.0, 10.0, {"S": left_shoulder(0, 10)})
    rules = (parse_rule("R1", "if e is N then u is S"), parse_rule("R2", "if e is P then u is S"))
    system = FuzzySystem((e,), (u,), rules)
    object.__setattr__(system, "rules", rules[:1])
    value, fires = surface(system)([1.0])
    assert (float(value), bool(fires)) == (5.0, False)


HALVES = {"N": left_shoulder(-1, 1), "P": right_shoulder(-1, 1)}
E = LinguisticVariable("e", -1.0, 1.0, HALVES)
U = LinguisticVariable("u", -1.0, 1.0, HALVES)
BOTH = ("if e is N then u is N", "if e is P then u is P")


def rules(*texts):
    return tuple(parse_rule(f"R{i}", text) for i, text in enumerate(texts, 1))


@pytest.mark.parametrize(
    ("make", "place", "value"),
    [
        (lambda: FuzzySystem((E,), (U,), rules(*BOTH), 2), "points", 2),
        (lambda: FuzzySystem((E,), (U,), rules(*BOTH), 1002), "points", 1002),
        (lambda: FuzzySystem((E, E), (U,), rules(*BOTH)), "inputs.e", "e"),
        (
            lambda: FuzzySystem((E,), (LinguisticVariable("e", -1, 1, HALVES),), ()),
            "inputs.e",
            "e",
        ),
        (lambda: FuzzySystem((E,), (U,), ()), "outputs.u", "no rule about it"),
        (lambda: FuzzySystem((E,), (U,), rules("if f is N then u is N")), "rules.R1", "f"),
        (lambda: FuzzySystem((E,), (U,), rules("if e is Z then u is N")), "rules.R1", "Z"),
        (lambda: FuzzySystem((E,), (U,), rules("if e is N then v is N")), "rules.R1", "v"),
        (lambda: FuzzySystem((E,), (U,), rules("if e is N then u is Z")), "rules.R1", "Z"),
        (
            lambda: FuzzySystem((E,), (U,), rules(BOTH[0])),
            "outputs.u",
            "no rule that fires at e = 1",
        ),
        (
            lambda: FuzzySystem(
                (
                    LinguisticVariable(
                        "e", -1, 1, {"N": triangle(-2, -1, 0), "P": triangle(0, 1, 2)}
                    ),
                ),
                (U,),
                rules(*BOTH),
            ),
            "inputs.e.sets",
            "no rule that fires at e = 0 for u, since no set is above zero there",
        ),
        (
            lambda: FuzzySystem(
                (E,),
                (LinguisticVariable("u", -1, 1, HALVES | {"P": triangle(0.501, 0.505, 0.509)}),),
                rules(*BOTH),
            ),
            "outputs.u.sets.P",
            "a set between two points",
        ),
        (
            lambda: LinguisticVariable("e", -1, 1, {"N": triangle(2, 3, 4)}),
            "e.sets.N",
            "a set outside of the range",
        ),
        (lambda: LinguisticVariable("e", 1, 1, HALVES), "e.range", "1, 1"),
        (lambda: LinguisticVariable("e", -1, 1, {}), "e.sets", "no set"),
    ],
)
def test_an_unfit_system_is_refused(make, place, value):
    with pytest.raises(InputError) as found:
        make()
    assert (found.value.place, found.value.value) == (place, value)


def test_a_gap_between_two_inputs_is_found_and_a_point_of_it_told():
    d = LinguisticVariable("d", -1.0, 1.0, {"N": left_shoulder(-1, 0.2), "P": right_shoulder(0, 1)})
    texts = ("if e is N then u is N", "if e is P and d is P then u is P")
    with pytest.raises(InputError, match=r"outputs\.u: got no rule that fires at (.*), exp") as e:
        FuzzySystem((E, d), (U,), rules(*texts))
    assert "e = 1, d = -1" in str(e.value)  # at e = 1 not even N of e is above zero
    FuzzySystem((E, d), (U,), rules(*texts, "if e is P and d is N then u is N"))


def test_the_search_for_a_gap_agrees_with_trying_many_inputs():
    """Random rules: refused if and only if some input out of a fine grid fires none."""
    random = np.random.default_rng(11)
    names = ("N", "Z", "P")
    refused = 0
    for _ in range(40):
        variables = []
        for name in "ed":
            a, b = np.sort(random.integers(-3, 4, 2)) / 4
            sets = {"N": left_shoulder(-1.25, b), "Z": triangle(a - 0.5, a, a + 0.5),
                    "P": right_shoulder(a, 1.25)}  # fmt: skip
            variables.append(LinguisticVariable(name, -1.0, 1.0, sets))
        texts = [
            f"if e is {random.choice(names)} {random.choice(['and', 'or'])} "
            f"d is {random.choice(names)} then u is N"
            for _ in range(random.integers(2, 7))
        ]
        x, y = np.meshgrid(np.linspace(-1, 1, 65), np.linspace(-1, 1, 65))
        degrees = {("e", s): m.degrees(x) for s, m in variables[0].sets.items()}
        degrees |= {("d", s): m.degrees(y) for s, m in variables[1].sets.items()}
        total = np.zeros_like(x)
        for text in texts:
            words = text.split()
            joined = np.minimum if words[4] == "and" else np.maximum
            total = np.maximum(total, joined(degrees["e", words[3]], degrees["d", words[7]]))
        try:
            FuzzySystem(tuple(variables), (U,), rules(*texts))
            found = True
        except InputError:
            found = False
        refused += not found
        assert found == bool((total > 0).all()), texts
    assert 5 < refused < 35


def test_aggregation_of_the_rig_is_what_it_says():
    points = np.array([0.0, 0.5, 1.0])
    u = LinguisticVariable("u", 0.0, 1.0, {"S": left_shoulder(0, 1), "L": right_shoulder(0, 1)})
    assert aggregated(u, {"S": 0.3, "L": 0.6}, points).tolist() == [0.3, 0.5, 0.6]
