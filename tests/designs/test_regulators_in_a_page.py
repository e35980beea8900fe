"""What a page makes of a regulator: the numbers of Python's design, by another way to them."""

import numpy as np
import pytest
from page_in_node import answered, source

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loop_shaping.conditioning import told_by_own_observer
from clepsydra.designs.sampled.sampled_system import SampledSystem

#: Of the largest number of a matrix.
NINE_DIGITS = 1e-9
SCRIPT = f"""
import * as law from "{source("lab/linear_law.ts")}";
import {{ Refused }} from "{source("lab/refused.ts")}";
const matrixOf = ([rows, columns, values]) =>
  ({{ rows, columns, values: Float64Array.from(values) }});
answer(given.map(({{ matrices, period, own, inputs, outputs, sign, errors, spans }}) => {{
  const [A, B, C, D] = matrices.map(matrixOf);
  let sampled;
  try {{
    sampled = law.sampledAt(period, {{ name: "reg1.mat", A, B, C, D, period: own }});
  }} catch (error) {{
    if (!(error instanceof Refused)) throw error;
    return {{ place: error.place, given: error.given, remedy: error.remedy }};
  }}
  const system = law.inSi(sampled, inputs, outputs, sign);
  const told = law.toldByOwnObserver(system, errors, spans);
  return {{ system, told }};
}}));
"""


def regulator(states, inputs, outputs, draw, integrals=0):
    """Return a stable regulator with some integrals, in continuous time."""
    A = draw.normal(size=(states, states))
    A -= np.eye(states) * (0.1 + max(0.0, np.linalg.eigvals(A).real.max()))
    A[:, :integrals] = 0.0
    B, C = draw.normal(size=(states, inputs)), draw.normal(size=(outputs, states))
    return A, B, C, draw.normal(size=(outputs, inputs))


def flat(matrix):
    return [*matrix.shape, matrix.ravel().tolist()]


def near(found, wanted):
    assert found["values"] == pytest.approx(
        wanted.ravel(), rel=0.0, abs=NINE_DIGITS * max(np.abs(wanted).max(), 1e-300)
    )


def asked(matrices, period=1.0, own=None, sign=-1, seed=0):
    draw, (outputs, inputs) = np.random.default_rng(seed), matrices[3].shape
    sizes = {
        name: draw.uniform(0.01, 30.0, count).tolist()
        for name, count in (("inputs", inputs), ("outputs", outputs),
                            ("errors", inputs), ("spans", outputs))
    }  # fmt: skip
    given = {"matrices": [flat(each) for each in matrices], "period": period, "own": own}
    return given | {"sign": sign} | sizes


def test_a_regulator_is_what_python_makes_of_it(tmp_path):
    """From 1 to 12 states, with integrals, direct ways and none, in both signs."""
    draw = np.random.default_rng(1)
    given = []
    for states in range(1, 13):
        for inputs, outputs in ((1, 1), (2, 2), (1, 2), (2, 3)):
            matrices = list(regulator(states, inputs, outputs, draw, min(states, inputs) - 1))
            if states % 3 == 0:
                matrices[3] = np.zeros((outputs, inputs))
            sign = 1 if states % 2 else -1
            given.append(
                (matrices, asked(matrices, draw.choice([0.05, 1.0]), sign=sign, seed=states))
            )
    for (matrices, each), found in zip(
        given, answered(SCRIPT, [g for _, g in given], tmp_path), strict=True
    ):
        A, B, C, D = SampledSystem.by_tustins_rule(matrices, each["period"])
        ins, outs = np.array(each["inputs"]), np.array(each["outputs"])
        B, C = each["sign"] * B / ins, outs[:, None] * C
        D = each["sign"] * outs[:, None] * D / ins
        system = SampledSystem(A, B, C, D)
        for name in "ABCD":
            near(found["system"][name], getattr(system, name))
        wanted = told_by_own_observer(system, np.array(each["errors"]), np.array(each["spans"]))
        for name in ("transition", "entered", "told", "shown", "direct"):
            near(found["told"][name], getattr(wanted, name))


def test_one_that_is_sampled_already_is_taken_as_it_is(tmp_path):
    matrices = tuple(map(np.atleast_2d, (0.9, 0.1, 1.0, 2.0)))
    same, other = answered(
        SCRIPT, [asked(matrices, 0.05, own=0.05), asked(matrices, 0.05, own=0.1)], tmp_path
    )
    assert same["system"]["A"]["values"] == [0.9]
    assert (other["place"], other["given"]) == ("reg1.mat, Ts", "0.1 s")


def test_a_pole_where_tustins_rule_has_none_is_refused(tmp_path):
    matrices = tuple(map(np.atleast_2d, (2.0, 0.1, 1.0, 3.0)))
    (found,) = answered(SCRIPT, [asked(matrices)], tmp_path)
    assert found["place"] == "reg1.mat, A" and "sample faster" in found["remedy"]


@pytest.mark.parametrize(
    "matrices",
    [
        # An integral that no error reaches, and one that no output shows.
        (np.zeros((2, 2)), np.array([[0.1], [0.0]]), np.array([[1.0, 1.0]]), np.eye(1)),
        (np.zeros((2, 2)), np.array([[0.1], [0.3]]), np.array([[1.0, 0.0]]), np.eye(1)),
        # The same of what grows.
        (np.diag([0.0, 0.5]), np.array([[0.1], [0.0]]), np.array([[1.0, 1.0]]), np.eye(1)),
        (np.diag([0.0, 0.5]), np.array([[0.1], [0.3]]), np.array([[1.0, 0.0]]), np.eye(1)),
    ],
)
def test_what_has_no_observer_has_none_here_either(matrices, tmp_path):
    given = asked(matrices)
    (found,) = answered(SCRIPT, [given], tmp_path)
    assert found["told"] is None
    A, B, C, D = SampledSystem.by_tustins_rule(matrices, 1.0)
    ins, outs = np.array(given["inputs"]), np.array(given["outputs"])
    system = SampledSystem(A, -B / ins, outs[:, None] * C, -outs[:, None] * D / ins)
    with pytest.raises(NotApplicable):
        told_by_own_observer(system, np.array(given["errors"]), np.array(given["spans"]))
