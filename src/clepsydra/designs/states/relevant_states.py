"""The states of a linear model that its outputs depend on."""

from __future__ import annotations

import dataclasses

import numpy as np

from clepsydra.linear.linear_model import LinearModel


def without_idle_states(model: LinearModel) -> LinearModel:
    """Return the model without the states that act on no output, neither at once nor later.

    The concentration in a basin, say, whose level alone is controlled. What is left out could
    neither be estimated from the outputs, nor would it matter to them.

    Examples
    --------
    >>> A, B, C = np.diag([-0.1, -0.2]), np.ones((2, 1)), np.array([[1.0, 0.0]])
    >>> model = LinearModel(A, B, B[:, :0], C, np.zeros((1, 1)),
    ...                     ("tank.level", "tank.salt"), ("pump",), (), ("level",))
    >>> without_idle_states(model).states
    ('tank.level',)
    """
    acts, shows = model.A != 0.0, np.any(model.C != 0.0, axis=0)
    delays = model.delays
    if delays is not None:
        through = np.eye(len(delays.times)) + np.abs(delays.through)
        way = np.linalg.matrix_power(through, len(delays.times)) @ np.abs(delays.from_states)
        acts = acts | (np.abs(delays.to_states) @ way > 0.0)
        shows = shows | np.any(np.abs(delays.to_outputs) @ way > 0.0, axis=0)
    for _ in model.states:
        shows = shows | np.any(acts[shows], axis=0)
    kept = np.flatnonzero(shows)
    if delays is not None:
        delays = dataclasses.replace(
            delays,
            to_states=delays.to_states[kept],
            from_states=delays.from_states[:, kept],
        )
    return dataclasses.replace(
        model,
        A=model.A[np.ix_(kept, kept)],
        B=model.B[kept],
        E=model.E[kept],
        C=model.C[:, kept],
        states=tuple(model.states[place] for place in kept),
        delays=delays,
    )
