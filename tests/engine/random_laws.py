"""Random step laws over every operation, and their evaluation by CasADi sample by sample."""

import casadi as ca
import numpy as np

from clepsydra import Signal, StepLaw
from clepsydra.program.step_law import Equations, step_law

UNARY = [
    lambda a: -a,
    lambda a: ca.sqrt(ca.fabs(a)),
    lambda a: ca.fabs(a),
    lambda a: ca.floor(a),
    lambda a: ca.ceil(a),
    lambda a: ca.sign(a),
    lambda a: a**2,
    lambda a: 2 * a,
    lambda a: 1 / a,
]
BINARY = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / b,
    lambda a, b: ca.fmin(a, b),
    lambda a, b: ca.fmax(a, b),
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: ca.logic_and(a > 0, b > 0),
    lambda a, b: ca.logic_or(a > 0.5, b < 0),
    lambda a, b: ca.if_else(a > b, a, 0.25 * b),
    lambda a, b: ca.if_else(ca.logic_not(ca.fabs(a) <= 1e300), b, a),
]
#: Functions that the engine prints itself, and so differ from CasADi's in the last digit.
PRINTED_UNARY = [
    lambda a: ca.exp(-ca.fabs(a)),
    lambda a: ca.log(1 + ca.fabs(a)),
    lambda a: ca.tanh(a),
    lambda a: ca.sin(a),
    lambda a: ca.asin(a / (1 + ca.fabs(a))),
]
PRINTED_BINARY = [
    lambda a, b: ca.fabs(a) ** (b / (1 + ca.fabs(b))),
    lambda a, b: ca.atan2(a, b),
]


def random_law(
    seed: int, states: int = 4, inputs: int = 3, parameters: int = 3, *, printed: bool = False
) -> StepLaw:
    """Return a law whose state stays in [-2, 2] and whose outputs are anything.

    `printed` says whether it may use exp, sin and others, which equal CasADi's only nearly.
    """
    random = np.random.default_rng(seed)
    unary = UNARY + (PRINTED_UNARY if printed else [])
    binary = BINARY + (PRINTED_BINARY if printed else [])

    def equations(symbols):
        pool = [*symbols.values(), ca.SX(0.3), ca.SX(-1.75)]
        for _ in range(60):
            first, second = (pool[i] for i in random.integers(len(pool), size=2))
            if random.random() < 0.35:
                pool.append(unary[random.integers(len(unary))](first))
            else:
                pool.append(binary[random.integers(len(binary))](first, second))
        late = pool[-20:]
        bounded = {f"x{i}": ca.if_else(ca.fabs(late[i]) <= 2, late[i], -1.5) for i in range(states)}
        return Equations(bounded, {f"y{i}": late[-1 - i] for i in range(6)})

    return step_law(
        f"law{seed}",
        inputs=[Signal(f"u{i}") for i in range(inputs)],
        parameters=[Signal(f"p{i}") for i in range(parameters)],
        state=[Signal(f"x{i}", initial=0.1 * (i + 1)) for i in range(states)],
        outputs=[Signal(f"y{i}") for i in range(6)],
        equations=equations,
    )


def evaluate(law: StepLaw, inputs: np.ndarray, parameters: np.ndarray, state: np.ndarray):
    """Return outputs [samples, q] and final state by CasADi's own evaluation."""
    rows = []
    for row in inputs:
        state, outputs, _ = law.function(state, row, parameters)
        rows.append(np.array(outputs).ravel())
    return np.array(rows), np.array(state).ravel()
