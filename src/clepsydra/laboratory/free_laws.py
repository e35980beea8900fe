"""The laws that a reader of a laboratory brings numbers for: typed loops and loaded matrices."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice, permutations

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.conditioned_linear import ConditionedMatrices, conditioned_linear_law
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.pid import family, multiloop_pid_law
from clepsydra.controllers.pid_form import Algorithm, PidForm
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.regulator import FAMILY
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.pairing import paired_gains

#: The matrices that can be loaded have room for so many states.
STATES = 12
#: Two, so that one is loaded while the other has the rig.
LOADED = 2
#: More are 300 programs of four loops in three forms.
MOST_PAIRINGS = 6
#: How the actions of a typed loop are joined.
ALGORITHMS: tuple[Algorithm, ...] = ("isa", "series", "parallel")


@dataclass(frozen=True, eq=False)
class TypedLoops:
    """PID loops of one pairing and form, whose settings a reader types.

    Parameters
    ----------
    controller : Controller
        With gains of zero.
    form : PidForm
    pairs : tuple of (str, str)
        Measurement and input of each loop.
    """

    controller: Controller
    form: PidForm
    pairs: tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class LoadedMatrices:
    """A linear law whose matrices are all zero until a reader loads others.

    Parameters
    ----------
    controller : Controller
        From the errors of all that is controlled to all inputs.
    """

    controller: Controller


FreeLaw = TypedLoops | LoadedMatrices


def free_laws(model: LinearModel) -> list[FreeLaw]:
    """Return the laws that a process has for numbers of a reader's.

    Each parameter of them is a setting: what a reader brings is a touch, which a session holds.

    Parameters
    ----------
    model : LinearModel
        Of the process at the point where it rests.

    Returns
    -------
    list
        Of loops one for each pairing and form, and of matrices two; none where a law of that kind
        does not fit the process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [each.controller.name for each in free_laws(cl.load("three-tanks").linear)][2:]
    ['PID typed in, parallel form, level_3 by feed', 'Loaded matrices 1', 'Loaded matrices 2']
    """
    found: list[FreeLaw] = []
    for pairs in islice(_pairings(model), MOST_PAIRINGS):
        for algorithm in ALGORITHMS:
            with suppress(NotApplicable, InputError):
                found.append(_typed(model, pairs, PidForm("PID", algorithm)))
    with suppress(NotApplicable, InputError):
        loaded = _loaded(model)
        numbers = range(1, LOADED + 1)
        found += [LoadedMatrices(replace(loaded, name=f"{loaded.name} {k}")) for k in numbers]
    return found


def _pairings(model: LinearModel) -> list[tuple[tuple[str, str], ...]]:
    """Return every pairing of as many loops as there can be, the suggested one first."""
    process = operating_point_of(model).process
    outputs, inputs = tuple(process.controlled), tuple(each.name for each in process.inputs)
    if len(outputs) > len(inputs):
        every = (zip(chosen, inputs, strict=True) for chosen in permutations(outputs, len(inputs)))
    else:
        every = (zip(outputs, chosen, strict=True) for chosen in permutations(inputs, len(outputs)))
    found = [tuple(pairs) for pairs in every]
    suggested: set[tuple[str, str]] = set()
    with suppress(InputError):
        suggested = {(each.output, each.input) for each in paired_gains(model)}
    return sorted(filter(None, found), key=lambda pairs: set(pairs) != suggested)


def _typed(model: LinearModel, pairs: tuple[tuple[str, str], ...], form: PidForm) -> TypedLoops:
    point = operating_point_of(model)
    measured, moved = (
        [point.process.signal(name) for name in each] for each in zip(*pairs, strict=True)
    )
    law = multiloop_pid_law(measured, moved, form)
    named = ", ".join(f"{y} by {u}" for y, u in pairs)
    controller = controller_at(
        point,
        f"PID typed in, {form.algorithm} form, {named}",
        family(form),
        law,
        numbers_at(point, law.parameters, proportional_gain=0.0),
        structure=Complexity.LOOPS,
        design="Settings that a reader types.",
    )
    return TypedLoops(controller, form, pairs)


def _loaded(model: LinearModel) -> Controller:
    point = operating_point_of(model)
    measured = [point.process.signal(name) for name in point.process.controlled]
    moved = list(point.process.inputs)
    n, p, m = STATES, len(measured), len(moved)
    shapes = (n, n), (n, p), (n, m), (m, n), (m, p)
    # Of all numbers of them a law has parameters, and these are zero at first.
    every = ConditionedMatrices(*map(np.ones, shapes))
    law = conditioned_linear_law(measured, moved, every)
    return controller_at(
        point,
        "Loaded matrices",
        FAMILY,
        law,
        numbers_at(point, law.parameters),
        numbers_at(point, law.state),
        design="Matrices that a reader loads.",
    )
