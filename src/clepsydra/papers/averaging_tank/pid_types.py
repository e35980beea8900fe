"""Section 3.1.3: P, PI and PID, each tuned by minimax over each index, in both variants."""

from __future__ import annotations

from clepsydra.controllers.pid_form import Actions
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.continuous_pi import continuous_run
from clepsydra.papers.averaging_tank.pi import OPTIMAL, minimax_tuned, tuned
from clepsydra.papers.averaging_tank.printed_tables import PI_INDICES, printed_indices
from clepsydra.papers.averaging_tank.symbols import VARIANTS, Variant, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row

#: Smaller by less is not smaller: tuning ends within that.
_SAME = 0.01
#: Steps of the solver that leave every digit of the indices as it is [s].
_STEP = 1e-2
_TYPES: tuple[Actions, ...] = ("P", "PI", "PID")
_INDICES = ("IAE", "ISE", "ITAE")


def best_values() -> Row:
    """Judge Table 6 as a whole: the larger index of C and V, tuned again for each column."""
    pairs = []
    for index in ("IAE", "ISE", "ITAE"):
        for variant in VARIANTS:
            found = continuous_run(tuned(variant, index), free=True, longest_step=_STEP).indices
            ours = max(found[index, "C"], found[index, "V"])
            column = constant_flow(variant)
            printed = printed_indices("Table 6", column)
            theirs = max(printed[index, output] for output in ("C", "V"))
            pairs.append((f"{index}, {column}", ours, theirs))
    lower = [f"{ours:.2e} against {theirs:.2e} ({name})" for name, ours, theirs in pairs
             if ours < theirs * (1.0 - _SAME)]  # fmt: skip
    by_error = continuous_run(OPTIMAL["outflow"], free=True).indices
    own = max(by_error["ISE", output] for output in ("C", "V"))
    least = PI_INDICES["ISE", "C"]
    return PRINTED["Table 6", "best values of the indices"].claimed(
        not lower and own >= least, "; ".join(lower) or "no smaller ones", own=own, least=least
    )


def run() -> Found:
    """Return what tuning each type anew says of Table 6, and of which type is best."""
    shown = []
    for variant in VARIANTS:
        for index in _INDICES:
            found = {actions: best_index(variant, index, actions) for actions in _TYPES}
            values = ", ".join(f"{actions} {value:.3e}" for actions, value in found.items())
            shown.append(f"{index}, {constant_flow(variant)}: {values}")
    return (
        best_values(),
        PRINTED["section 3.1.3", "best type of controller"].remark("; ".join(shown)),
    )


def best_index(variant: Variant, index: str, actions: Actions) -> float:
    """Return the smallest larger index of C and V that a type of controller reaches.

    Examples
    --------
    V cannot rise faster than 0.8 m³/s, so that its ISE is at least 0.1³/(3 · 0.8) = 4.167e-4:

    >>> round(best_index("outflow", "ISE", "P"), 6)
    0.000417
    """
    return minimax_tuned(variant, index, actions).objective
