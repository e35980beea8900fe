"""The measurements that show the states of a model."""

from __future__ import annotations

import dataclasses
from functools import lru_cache

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.late_outputs import late_outputs, with_late_outputs
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.ways import in_any_steps, ways


def measurements_of_states(model: LinearModel) -> tuple[str, ...]:
    """Return a measurement for each state of a model, in the order of the states.

    Raises
    ------
    NotApplicable
        A state is not measured, or a controlled output shows one that another sensor shows.

    Examples
    --------
    >>> import clepsydra as cl
    >>> measurements_of_states(cl.load("quadruple-tank").linear)
    ('level_1', 'level_2', 'level_3', 'level_4')
    """
    process = operating_point_of(model).process
    chosen = []
    for state in model.states:
        # Where two sensors show a state, the one that is controlled is meant.
        showing = [name for name, shown in process.measured_state.items() if shown == state]
        if not showing:
            raise NotApplicable(f"{state} is not measured, and it needs every state")
        chosen.append(next((name for name in showing if name in model.outputs), showing[0]))
    for name in model.outputs:
        if name not in chosen:
            raise NotApplicable(f"{name} shows a state that another sensor shows too")
    return tuple(chosen)


def all_states_are_measured(model: LinearModel) -> bool:
    """Tell whether a sensor shows each state of a model without dead time.

    Examples
    --------
    >>> import clepsydra as cl
    >>> all_states_are_measured(cl.load("eight-tanks").linear)
    False
    """
    shown = operating_point_of(model).process.measured_state.values()
    return model.delays is None and all(state in shown for state in model.states)


@lru_cache(maxsize=16)
def with_outputs(model: LinearModel, measurements: tuple[str, ...]) -> LinearModel:
    """Return the model with other measurements of its process as outputs.

    Raises
    ------
    InputError
        The process has no such measurement.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> with_outputs(model, ("level_4",)).C
    array([[ 0.,  0.,  0., 50.]])
    """
    own = late_outputs(model).prompt
    whole = linearise(operating_point_of(model)).select(measurements, model.inputs)
    shown, ages = late_outputs(whole)
    columns = [shown.states.index(name) for name in model.states]
    delays = own.delays
    if delays is not None:
        assert shown.delays is not None
        delays = dataclasses.replace(delays, to_outputs=shown.delays.to_outputs)
    no_feedthrough = np.zeros((len(measurements), len(model.inputs)))
    found = dataclasses.replace(
        own, C=shown.C[:, columns], D=no_feedthrough, outputs=measurements, delays=delays
    )
    return with_late_outputs(found, ages)


def of_measurements(
    model: LinearModel, measurements: tuple[str, ...], feedback: np.ndarray
) -> np.ndarray:
    """Return the feedback of measurements that is one of states: F x = (F M⁻¹) y with y = M x.

    Parameters
    ----------
    measurements : tuple of str
        One for each state.
    feedback : ndarray [m, n]
        F

    Examples
    --------
    >>> import clepsydra as cl
    >>> levels = ("level_1", "level_2", "level_3")
    >>> of_measurements(cl.load("three-tanks").linear, levels, np.ones((1, 3)))
    array([[1., 1., 1.]])
    """
    shown = with_outputs(model, measurements).C
    found: np.ndarray = np.linalg.solve(shown.T, feedback.T).T
    return found


@lru_cache(maxsize=16)
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
    first, n, acts = len(model.inputs), len(model.states), ways(model)
    shows = in_any_steps(acts)[len(acts) - len(model.outputs) :, first : first + n].any(axis=0)
    return model.of_states(np.flatnonzero(shows).tolist())
