"""The process as the document prints it: parameters, levels, and the model they give."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

LEVELS = np.array(PRINTED.numbers("Table 1", "h1s", "h2s", "h3s"))  # [m]
FLOW = PRINTED["Table 1", "q2s at 0.40 m in tank 3"].value / 1e6  # [m³/s]
AREA = PRINTED["Table 1", "A"].value  # [m²]
#: Of the transfer function (3), and the coefficient of s³ is 1.
NUMERATOR, *_BELOW = PRINTED.numbers(
    "(3)", "numerator", "coefficient of s²", "coefficient of s", "constant coefficient"
)
DENOMINATOR = np.array([1.0, *_BELOW])


def companion() -> np.ndarray:
    """Return A [3, 3] of (4) from the denominator of (3)."""
    matrix = np.diag([1.0, 1.0], 1)
    matrix[2] = -DENOMINATOR[:0:-1]
    return matrix


@cache
def three_tanks() -> Process:
    """Return the process with the printed parameters."""
    return load_process("three-tanks")


def linear_model_at(levels: np.ndarray) -> LinearModel:
    """Return the linear model at some levels [3] and the printed flow, at rest there or not."""
    process = three_tanks()
    still = np.zeros(len(process.disturbances))
    return linearise(OperatingPoint.at(process, levels, np.array([FLOW]), still))


@cache
def printed_model() -> LinearModel:
    """Return the linear model (2): at the levels of Table 1 in metres, from the exact constants."""
    return linear_model_at(LEVELS)


@cache
def rounded_model() -> LinearModel:
    """Return (2) in three decimals, from which the authors computed their gains.

    Their closed-loop matrix has its rates, 0.026 and -0.058, and Qc its B.
    """
    model = printed_model()
    return dataclasses.replace(model, A=model.A.round(3), B=model.B.round(2))


def flows_at(levels: np.ndarray) -> np.ndarray:
    """Return q12, q23 and q2 [m³/s] at some levels [3], by the balances from tank 1 on.

    Examples
    --------
    >>> (1e6 * flows_at(LEVELS)).round(1).tolist()
    [49.5, 39.6, 140.1]
    """
    process = three_tanks()
    still = np.zeros(len(process.disturbances))
    rates = process.dynamics(levels, FLOW, still, process.parameter_values)
    return np.asarray(FLOW - AREA * np.cumsum(np.array(rates)))
