"""Controllability and observability of each mode, and how nearly they fail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from clepsydra.base.json_values import json_values
from clepsydra.linear.dead_time import at_rest, without_dead_time
from clepsydra.linear.distance_to_uncontrollability import (
    MOST_STATES,
    distance_to_uncontrollability,
)
from clepsydra.linear.hankel_singular_values import HankelSingularValues, hankel_singular_values
from clepsydra.linear.linear_model import LinearModel, refuse_delays
from clepsydra.linear.poles import poles
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.roots import PADE_ORDER

#: Above so many states the margins of the modes would take minutes: each mode costs work with the
#: third power of the states.
MOST_MODES = 150
# Below this share a mode counts as not reached at all.
NOT_AT_ALL = 1e-10
# So much more weight has it to be an eigenvector than to be out of reach.
_EIGENVECTOR = 1e6
# Below this share of A a row of A - p I is the rounding of p.
_ROUNDING = 1e-12
# Below this share of A a singular value of A - p I counts as zero, and a part in a mode as none.
_NOTHING = 1e-9


class ModeMargin(NamedTuple):
    """How well the inputs reach one mode, or the outputs show it.

    Parameters
    ----------
    pole : complex
        [rad/s]
    margin : float
        σ_min of [A - p I, B] (or of [A - p I; C]): the smallest change of the matrices that
        cuts the mode off [1/s for states in one unit].
    share : float
        The same with every row (or column) first divided by its length [1]: zero where the mode
        is cut off, of the order of one where it is well reached, whatever the speeds.
    state : str
        The state that has the largest part in the mode: |q_i t_i| with the left and the right
        eigenvector q and t, whatever the units of the states (Perez-Arriaga, Verghese and
        Schweppe, Selective modal analysis with applications to electric power systems, IEEE
        Transactions on Power Apparatus and Systems 101(9), 1982, 3117-3125).
    """

    pole: complex
    margin: float
    share: float
    state: str


def controllability_margins(model: LinearModel) -> list[ModeMargin]:
    """Return how far each mode is from being uncontrollable, by Popov, Belevitch and Hautus.

    A mode p is uncontrollable when [A - p I, B] loses rank. The margins depend on units:
    those of `in_known_ranges(model)` compare.

    Returns
    -------
    list of ModeMargin
        One for each pole, the rightmost first; of a conjugate pair both.

    References
    ----------
    R. Eising, Between controllable and uncontrollable, Systems & Control Letters, 1984.

    Examples
    --------
    Two tanks side by side, the second without a pump:

    >>> A, B = np.diag([-0.02, -0.01]), np.array([[1.0], [0.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 1)),
    ...                     ("tank_1.level", "tank_2.level"), ("pump",), (), ("y", "z"))
    >>> [(mode.state, mode.margin) for mode in controllability_margins(model)]
    [('tank_2.level', 0.0), ('tank_1.level', 0.01)]
    """
    return _margins(model.A, model.B, model)


def observability_margins(model: LinearModel) -> list[ModeMargin]:
    """Return how far each mode is from being unobservable: when [A - p I; C] loses rank.

    Returns
    -------
    list of ModeMargin
        As for `controllability_margins`.
    """
    return _margins(model.A.T, model.C.T, model)


def _margins(A: np.ndarray, B: np.ndarray, model: LinearModel) -> list[ModeMargin]:
    refuse_delays(model.delays, "controllability and observability margins")
    size = (float(np.linalg.norm(A, 2)) if A.size else 0.0) or 1.0
    found = []
    for pole in poles(model):
        shifted = A - pole * np.eye(len(A))
        test = np.hstack([shifted, B])
        lengths = np.linalg.norm(test, axis=1, keepdims=True)
        # Divided by its own length, a row of nothing but rounding would look well reached.
        balanced = test / np.where(lengths > _ROUNDING * size, lengths, size)
        share = np.linalg.svd(balanced, compute_uv=False)[-1]
        margin = np.linalg.svd(test, compute_uv=False)[-1]
        state = model.states[_main_state(shifted, B)]
        found.append(ModeMargin(complex(pole), float(margin), float(share), state))
    return found


def _main_state(shifted: np.ndarray, B: np.ndarray) -> int:
    """Return the state with the largest part in a mode; of several modes, in that least along B."""
    size = np.linalg.norm(shifted) or 1.0
    weighted = np.hstack([_EIGENVECTOR * shifted / size, B / (np.linalg.norm(B) or 1.0)])
    left = np.abs(np.linalg.svd(weighted)[0][:, -1])
    _, sizes, rows = np.linalg.svd(shifted)
    sizes[-1] = 0.0  # p is an eigenvalue, but for rounding
    parts = left * np.linalg.norm(rows[sizes <= _NOTHING * size], axis=0)
    # Two equal modes in series have no state in common: what drives the others is meant.
    chosen = parts if parts.max() > _NOTHING else left
    return int(np.argmax(chosen > (1.0 - _NOTHING) * chosen.max()))


def words_on_reach(model: LinearModel, weak: float = 0.01) -> list[str]:
    """Return sentences on modes that the inputs hardly reach or the outputs hardly show.

    Parameters
    ----------
    model : LinearModel
        In ranges, so that the shares mean something.
    weak : float
        The share [1] below which a mode is worth a sentence.
    """
    words = []
    for margins, never, hardly in (
        (controllability_margins(model), "No input moves", "The inputs hardly reach"),
        (observability_margins(model), "No output shows", "The outputs hardly show"),
    ):
        for mode in margins:
            if mode.share >= weak or mode.pole.imag < 0.0:
                continue
            place = f"{mode.pole.real:.3g}"
            if mode.pole.imag > 0.0:
                place += f" ± {mode.pole.imag:.3g}j"
            where = f"the mode at {place} rad/s (mainly {mode.state}"
            if mode.share < NOT_AT_ALL:
                words.append(f"{never} {where}).")
            else:
                words.append(f"{hardly} {where}): a share of {mode.share:.1g}.")
    return words


@dataclass(frozen=True, eq=False)
class Reach:
    """Controllability and observability of each mode, with every signal in its range.

    With dead time the modes are those of the process with the dead times at zero: what is late
    is reached and shown all the same. Hankel singular values do count the dead time, by a Padé
    approximation.

    Parameters
    ----------
    distance_to_uncontrollability, distance_to_unobservability : float or None
        [1/s], the smallest change of the matrices that cuts some mode off; None without states,
        and where `note` says why.
    note : str
        What is left out of a model of many states, the distances or the margins too; else empty.
    hankel : HankelSingularValues
        [1]
    """

    controllability: list[ModeMargin]
    observability: list[ModeMargin]
    distance_to_uncontrollability: float | None
    distance_to_unobservability: float | None
    note: str
    hankel: HankelSingularValues

    def as_dict(self) -> dict[str, Any]:
        """Return it as values for JSON, a mode as its pole, shares and main state."""
        values = {
            **vars(self),
            "hankel_singular_values": self.hankel.values,
            "poles_without_hankel_singular_value": self.hankel.split_off,
        }
        del values["hankel"]
        found: dict[str, Any] = json_values(values)
        return found


def reach_of(model: LinearModel) -> Reach | None:
    """Return how well the modes are reached and shown; None where a signal has no range."""
    shares = in_known_ranges(model)
    if shares is None:
        return None
    resting = at_rest(shares)
    moved, shown, note = None, None, ""
    states = len(resting.states)
    if states > MOST_STATES:
        note = (
            f"The distances to uncontrollability and unobservability are left out, since the "
            f"model has {states} states, more than {MOST_STATES}, and their search takes long; "
            "the margin of each mode bounds them from above."
            if states <= MOST_MODES
            else _left_out(states)
        )
    elif states:
        moved = distance_to_uncontrollability(resting.A, resting.B).value
        shown = distance_to_uncontrollability(resting.A.T, resting.C.T).value
    return Reach(
        controllability_margins(resting) if states <= MOST_MODES else [],
        observability_margins(resting) if states <= MOST_MODES else [],
        moved,
        shown,
        note,
        hankel_singular_values(without_dead_time(shares, PADE_ORDER)),
    )


def words_about_reach(model: LinearModel) -> list[str]:
    """Return sentences on modes that are hardly reached or shown; none without ranges."""
    shares = in_known_ranges(model)
    if shares is not None and len(shares.states) > MOST_MODES:
        return [_left_out(len(shares.states))]
    # Two modes alike, as of two equal pumps, are one sentence.
    return [] if shares is None else list(dict.fromkeys(words_on_reach(at_rest(shares))))


def _left_out(states: int) -> str:
    return (
        f"How well inputs reach each mode and outputs show it is left out, since the model has "
        f"{states} states, more than {MOST_MODES}, and the search takes long."
    )
