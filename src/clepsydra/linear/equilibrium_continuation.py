"""Ways to an equilibrium where Newton's method fails from every start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clepsydra.linear.equilibrium_search import EquilibriumSearch, Iterate

_STEPS = 2000
_SHORTEST = 1e-12
# The time step grows by no more than this from one step to the next.
_GROWTH = 2.0
# A level is not brought nearer to its floor than this share of its range on the way.
_FLOOR = 1e-9
# At first no state moves by more than this share of its range.
_FAR = 0.1
# A time step is at most this share of the time in which a growing mode grows by e.
_OF_GROWTH = 0.5
# Beyond this many ranges it comes to rest nowhere.
_AWAY = 100.0
_SMALLEST_ADVANCE = 1e-4


def by_pseudo_transient(search: EquilibriumSearch, share: float | None) -> Iterate | None:
    """Follow the motion from a start in ever longer implicit steps, then search from its end.

    (I/Δt - ∂f/∂x) Δx = f(x), with Δt growing as the rates fall (switched evolution
    relaxation). It ends where the process would, so only at an equilibrium that attracts.

    Parameters
    ----------
    search : EquilibriumSearch
        Without free inputs.
    share : float or None
        Of the heights, to start from; the initial levels where None.

    Returns
    -------
    Iterate or None
        None where it does not come to rest.

    References
    ----------
    C. T. Kelley and D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM
    Journal on Numerical Analysis 35(2), 1998, 508-523, doi 10.1137/S0036142996304796.
    """
    state, inputs = search.values(search.start(share))
    forced, n = search.request.disturbances, len(state)
    floors = search.floors + _FLOOR * search.spans[:n]
    state = np.maximum(state, np.where(search.floored[:n], floors, -np.inf))
    local = search.derivatives.at(state, inputs, forced)
    step, before = None, np.inf
    for _ in range(_STEPS):
        finite = np.isfinite(local.rates).all() and np.isfinite(local.rates_by_state).all()
        if not finite or np.any(np.abs(state) > _AWAY * search.spans[:n]):
            return None
        size = float(np.linalg.norm(local.rates / search.spans[:n]))
        if size == 0.0:
            break
        growth = min(_GROWTH, before / size)
        step = _FAR / size if step is None else step * growth
        growing = float(np.linalg.eigvals(local.rates_by_state).real.max())
        if growing > 0.0:  # a longer step would turn round, to where the mode grows from
            step = min(step, _OF_GROWTH / growing)
        if step < _SHORTEST:
            return None
        moved = np.linalg.solve(np.eye(n) / step - local.rates_by_state, local.rates)
        following = np.maximum(state + moved, np.where(search.floored[:n], floors, -np.inf))
        still = np.all(np.abs(following - state) <= 1e-9 * search.spans[:n])
        state, before = following, size
        local = search.derivatives.at(state, inputs, forced)
        if still and step * size > 1e-12:
            break
    found = search.run_from(search.unknowns_at(state, inputs))
    return found if found.solved and not search.below_floor(found.unknowns).any() else None


def by_homotopy(search: EquilibriumSearch) -> Iterate | None:
    """Go from the equilibrium of the nominal inputs to the asked outputs in small steps.

    The targets move in a straight line from what the sensors show there; each solution is the
    start of the next search, and a step that fails is halved.

    Parameters
    ----------
    search : EquilibriumSearch
        With free inputs.

    Returns
    -------
    Iterate or None
        None where there is no equilibrium to start from, or the way ends.
    """
    request, process = search.request, search.process
    given = replace(request, free_inputs=(), outputs=(), targets=np.zeros(0))
    easy = EquilibriumSearch(process, given)
    start = next(
        (
            found
            for found in (easy.run(None), by_pseudo_transient(easy, None))
            if found is not None and found.solved and not easy.below_floor(found.unknowns).any()
        ),
        None,
    )
    if start is None:
        return None
    state, inputs = easy.values(start.unknowns)
    shown = search.derivatives.at(state, inputs, request.disturbances).measured
    origin = shown[list(request.outputs)]
    unknowns, gone, advance = search.unknowns_at(state, inputs), 0.0, 0.25
    while gone < 1.0:
        share = min(1.0, gone + advance)
        targets = origin + share * (request.targets - origin)
        part = EquilibriumSearch(process, replace(request, targets=targets))
        found = part.run_from(unknowns)
        if found.solved and not part.below_floor(found.unknowns).any():
            unknowns, gone, advance = found.unknowns, share, 2.0 * advance
        else:
            advance /= 2.0
            while gone + advance >= share:  # the same step to the end again
                advance /= 2.0
            if advance < _SMALLEST_ADVANCE:
                return None
    return search.run_from(unknowns)
