"""The integral of one output or loop, from one sample to the next."""

from __future__ import annotations

import casadi as ca

from clepsydra.controllers.blocks.anti_windup import IN_WORDS, next_in_force
from clepsydra.controllers.blocks.handover import Applied
from clepsydra.controllers.blocks.mode import followed_integral
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.program.step_law import Symbols

#: What the integral of each way of anti-windup is called in the names of blocks.
WINDING_NAMES = {
    "back_calculation": "back_calculated",
    "conditional_integration": "conditional",
    "clamping": "clamped",
    "variable_structure": "variable_structure",
    "none": "free",
}


def next_integral(
    anti_windup: str,
    s: Symbols,
    applied: Applied,
    *,
    known: ca.SX,
    last_applied: ca.SX,
) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return the integral of the next sample under one way of anti-windup, and names for it.

    Where the output had its say the integral takes its increment under the anti-windup rule;
    where the actuator moved without it, it follows, so that automatic continues from there;
    else it stays. It is always a number.

    Parameters
    ----------
    s : mapping
        As for `next_in_force`.
    known : casadi.SX
        Whether the rest was computed from valid signals.
    last_applied : casadi.SX
        What was applied in the last sample.
    """
    before = s["integral_used"]
    followed = followed_integral(before, applied.applied, last_applied, s["proportional"], known)
    elsewhere = ca.if_else(applied.follows, followed, before)
    following = next_in_force(anti_windup, s, applied.applied)
    if anti_windup == "variable_structure":
        following = ca.if_else(is_number(following), following, before + s["increment"])
    following = ca.if_else(applied.in_force, following, elsewhere)
    # An increment beyond the range of numbers is not taken.
    kept = ca.if_else(is_number(following), following, before)
    return kept, {"integral_moved": following, "integral_kept": kept}


def integral_words(anti_windup: str) -> dict[str, str]:
    """Return what a reader is told above the steps of an integral."""
    return {
        "integral_used": "integral: it takes up what a change of settings would make jump",
        "integral_moved": f"anti-windup, {IN_WORDS[anti_windup]}; in manual it follows",
        "integral_kept": "what is no number is not taken",
    }
