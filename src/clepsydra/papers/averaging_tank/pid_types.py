"""Section 3.1.3: P, PI and PID, each tuned by minimax over each index, in both variants."""

from __future__ import annotations

from clepsydra.controllers.pid_form import Actions
from clepsydra.papers.averaging_tank.pi import minimax_tuned
from clepsydra.papers.averaging_tank.symbols import Variant
from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings

_TYPES: tuple[Actions, ...] = ("P", "PI", "PID")
_VARIANTS: tuple[Variant, ...] = ("outflow", "inflow")
_INDICES = ("IAE", "ISE", "ITAE")
#: Better by less is not better: the search ends within that.
_SAME = 0.01


def run() -> Findings:
    """Return the row on which type of controller is best."""
    shown, best = [], True
    for variant in _VARIANTS:
        for index in _INDICES:
            found = {actions: best_index(variant, index, actions) for actions in _TYPES}
            best &= found["PI"] <= (1.0 + _SAME) * min(found.values())
            values = ", ".join(f"{actions} {value:.3e}" for actions, value in found.items())
            shown.append(f"{index}, f_{variant[:-4]} constant: {values}")
    return Findings(
        (
            claimed(
                "section 3.1.3", "best type of controller", "best results were achieved with PI",
                best, "; ".join(shown),
                reason="Larger index of C and V after minimax tuning of each type, at 2 ms, C_in "
                "free, derivative on the error with a filter of Td/10. PI contains P; PID contains "
                "PI and brings less than 1 % more. The limit of the flow, 0 to 1 m³/s of section "
                "3.3, leaves it no room: by that alone IAE of V is at least 6.25e-3 with f_out "
                "constant and 2.50e-2 with f_in constant.",
            ),
        )
    )  # fmt: skip


def best_index(variant: Variant, index: str, actions: Actions) -> float:
    """Return the smallest larger index of C and V that a type of controller reaches.

    Examples
    --------
    V cannot rise faster than 0.8 m³/s, so that its ISE is at least 0.1³/(3 · 0.8) = 4.167e-4:

    >>> round(best_index("outflow", "ISE", "P"), 6)
    0.000417
    """
    return minimax_tuned(variant, index, actions).objective
