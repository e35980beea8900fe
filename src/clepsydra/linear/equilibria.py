"""The equilibria of many plants of one kind, found side by side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.signal import elements
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.many_points import at_many_points
from clepsydra.linear.equilibrium import OTHER_STARTS, NoEquilibrium, find_equilibrium
from clepsydra.linear.equilibrium_reasons import AT_LIMIT
from clepsydra.linear.equilibrium_request import EquilibriumRequest
from clepsydra.linear.equilibrium_search import EquilibriumSearch
from clepsydra.linear.motions_at_rest import motions_at_rest
from clepsydra.linear.newton_step import ENDED, UNKNOWN, newton_step
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.program.reader import program_of

Array = NDArray[np.float64]
Truths = NDArray[np.bool_]

#: With more unknowns the equations, solved in symbols, would be too long: plant by plant then.
MOST_UNKNOWNS = 24
#: Evaluations of the equations at most, and how many before those who are done are left out.
_EVALUATIONS, _TOGETHER = 200, 8
_NOT_FOUND = "no steady state was found"


@dataclass(frozen=True, eq=False)
class Equilibria:
    """Where many plants of one kind rest, in SI.

    Parameters
    ----------
    state : ndarray [n, draws]
    inputs : ndarray [m, draws]
    reason : ndarray of int [draws]
        Place in `reasons` of why a plant has no admissible steady state; -1 where it has one.
    reasons : tuple of str
        All that there are with plants of this kind.
    """

    state: Array
    inputs: Array
    reason: NDArray[np.int64]
    reasons: tuple[str, ...]

    @property
    def feasible(self) -> Truths:
        """Which have an admissible steady state [draws]."""
        return self.reason < 0

    @property
    def counts(self) -> dict[str, int]:
        """Why plants have no admissible steady state, and how many for each reason."""
        found = np.bincount(self.reason[~self.feasible], minlength=len(self.reasons)).tolist()
        return {each: count for each, count in zip(self.reasons, found, strict=True) if count}


class ManyEquilibria:
    """Newton's method for the equilibria of plants that differ from one in their numbers.

    What a controller holds stands where it stands at the given point, and the inputs that it moves
    are found together with the states; all other inputs stay where they are. The plants are
    scenarios of one kernel (`clepsydra.linear.newton_step`), so that what is found for one does
    not depend on the others. A plant that would have to leave a range is solved beyond it, which
    tells why it cannot rest. One whose search gets stuck is left to
    `clepsydra.linear.equilibrium.find_equilibrium`, and one whose numbers are those of the point
    rests there to the last digit.

    Parameters
    ----------
    point : OperatingPoint
        From which every search begins.
    outputs : sequence of str
        Measurements that stand where they are at the point.
    free : sequence of str
        The inputs that are found, as many as outputs.

    Examples
    --------
    With holes a tenth wider the pumps have to give more, and ten times as wide is too much:

    >>> import clepsydra as cl
    >>> point = cl.load("quadruple-tank").point
    >>> many = ManyEquilibria(point, ["level_1", "level_2"], ["pump_1", "pump_2"])
    >>> hole = point.process.signal("outlet_1.area").initial
    >>> found = many.find({"outlet_1.area": hole * np.array([1.0, 1.1, 10.0])})
    >>> found.inputs[0, :2].round(3), found.counts
    (array([3.   , 3.661]), {'pump_1 would leave its range': 1})
    """

    def __init__(self, point: OperatingPoint, outputs: Sequence[str], free: Sequence[str]) -> None:
        process = point.process
        rows = tuple(i for i, y in enumerate(process.measurements) if y.name in outputs)
        columns = tuple(i for i, u in enumerate(process.inputs) if u.name in free)
        targets = point.measurements[list(rows)]
        asked = EquilibriumRequest(point.inputs, columns, point.disturbances, rows, targets)
        self._point, self._search = point, EquilibriumSearch(process, asked)
        self._own = {s.name: s.initial for s in process.parameters}
        loads = zip(process.disturbances, point.disturbances.tolist(), strict=True)
        self._own |= {signal.name: value for signal, value in loads}

    def find(self, given: Mapping[str, ArrayLike], count: int = 1) -> Equilibria:
        """Return where the plants rest.

        Parameters
        ----------
        given : mapping
            Parameter or disturbance to its value in each plant [SI] [draws]; the others have the
            values of the point.
        count : int
            How many plants there are, where nothing is given.
        """
        point = self._point
        (count,) = np.broadcast_shapes(*(map(np.shape, given.values()) if given else [(count,)]))
        values = {n: np.broadcast_to(np.asarray(v, float), count) for n, v in given.items()}
        moved = np.zeros(count, bool)
        for name, column in values.items():
            moved |= column != self._own[name]
        state, inputs = (np.tile(each[:, None], (1, count)) for each in (point.state, point.inputs))
        found = np.flatnonzero(moved)
        chosen = {name: column[moved] for name, column in values.items()}
        unknowns, solved = self._solved(chosen, len(found))
        at, moves = self._search.values(unknowns)
        state[:, moved], inputs[:, moved] = at.T, moves.T
        why, names = np.full(count, -1), {_NOT_FOUND: 0}
        for words, holds in self._refusals(unknowns, at, moves, chosen):
            place = names.setdefault(words, len(names))
            refused = found[holds & solved]
            why[refused] = np.where(why[refused] < 0, place, why[refused])
        for draw in found[~solved].tolist():
            own = {name: float(column[draw]) for name, column in values.items()}
            rest = self._alone(own)
            if rest is None:
                why[draw] = names[_NOT_FOUND]
            else:
                state[:, draw], inputs[:, draw] = rest.state, rest.inputs
        return Equilibria(state, inputs, why, tuple(names))

    @cached_property
    def _kernel(self) -> Kernel:
        return Kernel(program_of(newton_step(self._search)), record=False, fuse=False)

    def _solved(self, values: Mapping[str, Array], count: int) -> tuple[Array, Truths]:
        """Return the unknowns [draws, n + f] where each search ended, and whether it is at rest."""
        search, point = self._search, self._point
        first = search.unknowns_at(point.state, point.inputs)
        unknowns, solved = np.tile(first, (count, 1)), np.zeros(count, bool)
        if len(first) > MOST_UNKNOWNS:
            return unknowns, solved
        for start in (first, *map(search.start, OTHER_STARTS)):
            left = np.flatnonzero(~solved)
            if not len(left):
                break
            rest = {name: column[left] for name, column in values.items()}
            unknowns[left], solved[left] = self._searched(start, rest, len(left))
        return unknowns, solved

    def _searched(
        self, start: Array, values: Mapping[str, Array], count: int
    ) -> tuple[Array, Truths]:
        """Return the same of searches from one start."""
        names = elements(UNKNOWN, len(start))
        unknowns, solved = np.tile(start, (count, 1)), np.zeros(count, bool)
        searching = np.arange(count)
        state: Mapping[str, ArrayLike] = dict(zip(names, unknowns.T, strict=True))
        for _ in range(0, _EVALUATIONS, _TOGETHER):
            chosen = {name: column[searching] for name, column in values.items()}
            result = self._kernel.run(_TOGETHER, parameters={**self._own, **chosen}, state=state)
            ended = result.state(ENDED)
            unknowns[searching] = np.array([result.state(name) for name in names]).T
            solved[searching] = ended > 0.0
            going = ended == 0.0
            searching = searching[going]
            if not len(searching):
                break
            of_state = (entry.name for entry in self._kernel.program.state)
            rows = result.final_state[:, going]
            state = dict(zip(of_state, rows, strict=True))
        solved &= np.isfinite(unknowns).all(axis=1)
        return unknowns, solved

    def _refusals(
        self, unknowns: Array, state: Array, inputs: Array, values: Mapping[str, Array]
    ) -> Iterator[tuple[str, Truths]]:
        """Yield why plants cannot rest, and which, in the order of `equilibrium_reasons`."""
        search, process = self._search, self._search.process
        moved = {signal.name for signal in process.inputs}
        for signal, column in zip(process.inputs, inputs.T, strict=True):
            slack = AT_LIMIT * (signal.span if np.isfinite(signal.span) else 0.0)
            outside = (column < signal.low - slack) | (column > signal.high + slack)
            yield f"{signal.name} would leave its range", outside
        for signal, column in zip(process.state, state.T, strict=True):
            if signal.owner in moved:  # an actuator follows its signal
                continue
            above = column > signal.high + AT_LIMIT * abs(signal.high)
            if signal.unit == "m":
                yield f"{signal.name} would stand above its rim", above
            else:
                slack = AT_LIMIT * (signal.span if np.isfinite(signal.span) else abs(signal.low))
                yield f"{signal.name} would leave its range", above | (column < signal.low - slack)
        below = search.below_floor(unknowns)
        for place, signal in enumerate(process.state):
            yield f"{signal.name} would have to fall below its floor", below[:, place]
        motion = process.motion
        if not any(event.harm for event in motion.events):
            return
        guards = at_many_points(motion.guards, self._at_rest(state, inputs, values))
        for event, guard in zip(motion.events, guards, strict=True):
            if event.harm:
                yield event.words, guard >= 0.0

    def _at_rest(self, state: Array, inputs: Array, values: Mapping[str, Array]) -> list[Array]:
        """Return what the motion is given at rest, as `Motion.at_rest`, of all plants."""
        process, known = self._search.process, dict[str, Array]()
        for name, own in self._own.items():
            known[name] = values.get(name, np.full(len(state), own))
        p, d = (
            np.array([known[s.name] for s in group]).reshape(len(group), len(state))
            for group in (process.parameters, process.disturbances)
        )
        return motions_at_rest(process.motion, state.T, inputs.T, d, p)

    def _alone(self, own: Mapping[str, float]) -> OperatingPoint | None:
        """Return where a plant rests that the search side by side did not find."""
        process, asked = self._search.process, self._search.request
        free = {process.inputs[place].name for place in asked.free_inputs}
        loads = (d.name for d in process.disturbances)
        try:
            return find_equilibrium(
                process.with_parameters(own),
                inputs={
                    u.name: self._point.as_dict()[u.name]
                    for u in process.inputs
                    if u.name not in free
                },
                outputs={
                    process.measurements[row].name: float(target)
                    for row, target in zip(asked.outputs, asked.targets, strict=True)
                },
                disturbances={name: own.get(name, self._own[name]) for name in loads},
            )
        except NoEquilibrium:
            return None
