"""How well the inputs reach each mode, the outputs show it, and which modes matter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from clepsydra.linear.compared import compared
from clepsydra.linear.controllability import (
    ModeMargin,
    controllability_margins,
    observability_margins,
    words_on_reach,
)
from clepsydra.linear.distance_to_uncontrollability import distance_to_uncontrollability
from clepsydra.linear.hankel_singular_values import HankelSingularValues, hankel_singular_values
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.pade import at_rest, without_dead_time
from clepsydra.linear.roots import PADE_ORDER


@dataclass(frozen=True, eq=False)
class Reach:
    """Controllability and observability of each mode, with every signal in its range.

    With dead time the modes are those of the process with the dead times at zero: what is late
    is reached and shown all the same. Hankel singular values do count the dead time, by a Padé
    approximation.

    Parameters
    ----------
    controllability, observability : list of ModeMargin
    distance_to_uncontrollability, distance_to_unobservability : float or None
        [1/s], the smallest change of the matrices that cuts some mode off; None without states.
    hankel : HankelSingularValues
        [1]

    Examples
    --------
    >>> import clepsydra as cl
    >>> len(cl.load("wet-well").analysis.reach.controllability)
    3
    """

    controllability: list[ModeMargin]
    observability: list[ModeMargin]
    distance_to_uncontrollability: float | None
    distance_to_unobservability: float | None
    hankel: HankelSingularValues

    def as_dict(self) -> dict[str, Any]:
        """Return it as values for JSON, a mode as its pole, shares and main state."""
        return {
            "controllability": [_mode(mode) for mode in self.controllability],
            "observability": [_mode(mode) for mode in self.observability],
            "distance_to_uncontrollability": self.distance_to_uncontrollability,
            "distance_to_unobservability": self.distance_to_unobservability,
            "hankel_singular_values": self.hankel.values.tolist(),
            "poles_without_hankel_singular_value": [
                {"re": float(pole.real), "im": float(pole.imag)} for pole in self.hankel.split_off
            ],
        }


def reach_of(model: LinearModel) -> Reach | None:
    """Return how well the modes are reached and shown; None where a signal has no range.

    Parameters
    ----------
    model : LinearModel

    Examples
    --------
    >>> import numpy as np
    >>> one = np.eye(1)
    >>> reach_of(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                      ("tank.level",), ("pump",), (), ("level",))) is None
    True
    """
    shares = compared(model)
    if shares is None:
        return None
    resting = at_rest(shares)
    moved = shown = None
    if resting.states:
        moved = distance_to_uncontrollability(resting.A, resting.B).value
        shown = distance_to_uncontrollability(resting.A.T, resting.C.T).value
    return Reach(
        controllability_margins(resting),
        observability_margins(resting),
        moved,
        shown,
        hankel_singular_values(without_dead_time(shares, PADE_ORDER)),
    )


def words_about_reach(model: LinearModel) -> list[str]:
    """Return sentences on modes that are hardly reached or shown; none without ranges.

    Examples
    --------
    >>> import numpy as np
    >>> one = np.eye(1)
    >>> words_about_reach(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                               ("tank.level",), ("pump",), (), ("level",)))
    []
    """
    shares = compared(model)
    # Two modes alike, as of two equal pumps, are one sentence.
    return [] if shares is None else list(dict.fromkeys(words_on_reach(at_rest(shares))))


def _mode(mode: ModeMargin) -> dict[str, Any]:
    return {
        "pole": {"re": mode.pole.real, "im": mode.pole.imag},
        "margin": mode.margin,
        "share": mode.share,
        "state": mode.state,
    }
