"""The plant in symbols: the linear model in both variants, and loops closed around it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Literal

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.exact_matrix import identity, inverse, jacobian, matrix, with_values
from clepsydra.papers.rational_function import RationalFunction, symbols

Variant = Literal["outflow", "inflow"]  # which flow is constant
VARIANTS: tuple[Variant, Variant] = ("outflow", "inflow")

(s,) = symbols("s")
#: C, V, f_in, C_in at the equilibrium, as (28) names them.
x1, x2, u1, u3 = symbols("x_10 x_20 u_10 u_30")
#: The equilibrium as printed.
AT_REST = {
    str(symbol): Fraction(PRINTED["section 2.2", name].text)
    for symbol, name in ((x1, "C0"), (x2, "V0"), (u1, "f_in0"), (u3, "C_in0"))
}
C0, V0, FLOW, INLET = map(float, AT_REST.values())
K1, K2, Ti1, Ti2, Td1, Td2 = symbols("K_p1 K_p2 T_i1 T_i2 T_d1 T_d2")


def constant_flow(variant: Variant) -> str:
    """Return which flow is constant, as the tables have it: "f_out constant"."""
    return f"f_{variant.removesuffix('flow')} constant"


@dataclass(frozen=True)
class Plant:
    """The linear model in symbols: states C and V, inputs one flow and C_in."""

    A: np.ndarray
    B: np.ndarray
    transfer: np.ndarray  # (sI - A)⁻¹ B


def balances() -> tuple[RationalFunction, RationalFunction]:
    """Return dC/dt and dV/dt by (6), in C, V, f_in, f_out and C_in."""
    C, V, inflow, outflow, inlet = symbols("C V f_in f_out C_in")
    return inflow / V * (inlet - C), inflow - outflow


@cache
def plant(constant: Variant) -> Plant:
    """Return the linear model, differentiated from the balances (6)."""
    C, V, inflow, outflow, inlet = symbols("C V f_in f_out C_in")
    inputs = [inflow if constant == "outflow" else outflow, inlet]
    rest = {"C": x1, "V": x2, "f_in": u1, "f_out": u1, "C_in": u3}
    A = with_values(jacobian(balances(), [C, V]), rest | {"C_in": x1})  # C0 = C_in0, (14)
    B = with_values(jacobian(balances(), inputs), rest)
    return Plant(A, B, inverse(identity(2) * s - A) @ B)


def controller(first: RationalFunction, second: RationalFunction) -> np.ndarray:
    """Return G_c of the pairing 1-2/2-1: C by the second input, V by the first."""
    return matrix([[0, second], [first, 0]])


def decoupler(constant: Variant) -> np.ndarray:
    """Return T of (50), by (49); the identity with constant inflow."""
    transfer = plant(constant).transfer
    return matrix([[1, 0], [-transfer[0, 0] / transfer[0, 1], 1]])


def closed_loop(constant: Variant, compensator: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return G_CL and G_E of (42) and (43), with the decoupler."""
    loop = plant(constant).transfer @ decoupler(constant) @ compensator
    error = inverse(identity(2) + loop)
    return loop @ error, error
