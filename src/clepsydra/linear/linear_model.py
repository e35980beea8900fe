"""The linear model of a process near an operating point, with the dead times inside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError
from clepsydra.linear.balance import unbalanced

if TYPE_CHECKING:
    import control

    from clepsydra.linear.operating_point import OperatingPoint


@dataclass(frozen=True, eq=False)
class InternalDelays:
    """r signals w that leave a linear model and come back as z_i(t) = w_i(t - τ_i).

    With them the model is ẋ = A x + B u + E d + to_states z, y = C x + D u + to_outputs z and
    w = from_states x + from_inputs u + from_disturbances d + through z. A dead time at an
    input, at an output, in a pipe between two tanks or inside a controller all have this form,
    and joining two such models gives another one.

    Parameters
    ----------
    times : ndarray [r]
        Dead times τ [s], above zero.
    to_states : ndarray [n, r]
    from_states : ndarray [r, n]
    from_inputs : ndarray [r, m]
    from_disturbances : ndarray [r, k]
    through : ndarray [r, r]
        From one delayed signal to another that leaves at once.
    to_outputs : ndarray [q, r]

    Raises
    ------
    InputError
        A dead time is not finite or not above zero.

    Examples
    --------
    A tank whose outflow is what entered it 5 s ago, as a model without an input:

    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> InternalDelays(np.array([5.0]), -one, one, none, none, 0.0 * one, 0.0 * one).times
    array([5.])
    """

    times: np.ndarray
    to_states: np.ndarray
    from_states: np.ndarray
    from_inputs: np.ndarray
    from_disturbances: np.ndarray
    through: np.ndarray
    to_outputs: np.ndarray

    def __post_init__(self) -> None:
        for time in np.ravel(self.times):
            if not (np.isfinite(time) and time > 0.0):
                expected = "dead times above 0 s"
                remedy = "leave out a signal that is not delayed"
                raise InputError("linear model, delays, times", float(time), expected, remedy)


def refuse_delays(delays: InternalDelays | None, what: str) -> None:
    """Raise InputError for a model with dead time, where only a rational one has an answer.

    Parameters
    ----------
    delays : InternalDelays or None
        Of the model.
    what : str
        What was asked for, a plural: "poles".
    """
    if delays is not None:
        got = f"dead times of {', '.join(f'{time:.6g}' for time in delays.times)} s"
        expected = f"a model without dead time, for {what}"
        remedy = "approximate it by clepsydra.linear.dead_time.without_dead_time(model, order)"
        raise InputError("linear model, delays", got, expected, remedy)


class Ports(NamedTuple):
    """Where signals stand in [ẋ; y; w] = M [x; u; d; z]: in columns x, u, d, z, in rows x, y, w."""

    x: slice
    u: slice
    d: slice
    z: slice
    y: slice
    w: slice

    @classmethod
    def of(cls, n: int, m: int, k: int, q: int, r: int) -> Ports:
        """Return those of n states, m inputs, k disturbances, q outputs and r delayed signals."""
        columns, rows = np.cumsum([0, n, m, k, r]).tolist(), np.cumsum([n, q, r]).tolist()
        return cls(*(slice(*ends) for ends in (*pairwise(columns), *pairwise(rows))))


@dataclass(frozen=True, eq=False)
class LinearModel:
    """Δẋ = A Δx + B Δu + E Δd,  Δy = C Δx + D Δu, deviations from `point`, in SI.

    Parameters
    ----------
    A : ndarray [n, n]
    B : ndarray [n, m]
        Manipulated inputs.
    E : ndarray [n, k]
        Disturbances.
    C : ndarray [q, n]
    D : ndarray [q, m]
    states, inputs, disturbances, outputs : tuple of str
        Names, in the order of the matrices.
    point : OperatingPoint or None
        None for a model that did not come from a process.
    delays : InternalDelays or None
        The signals that come back later, see there; None for a model without dead time.

    Raises
    ------
    ValueError
        The shapes of the matrices and the numbers of names disagree.

    Examples
    --------
    A tank with a time constant of 50 s, a gain of 2 V/V and an inflow:

    >>> tank = LinearModel(np.array([[-0.02]]), np.array([[0.04]]), np.array([[1.0]]),
    ...                    np.array([[1.0]]), np.array([[0.0]]),
    ...                    ("tank.level",), ("pump",), ("inflow",), ("level",))
    >>> tank.select(outputs=["level"], inputs=["pump"]).B
    array([[0.04]])
    """

    A: np.ndarray
    B: np.ndarray
    E: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    disturbances: tuple[str, ...]
    outputs: tuple[str, ...]
    point: OperatingPoint | None = None
    delays: InternalDelays | None = None

    def __post_init__(self) -> None:
        n, m = len(self.states), len(self.inputs)
        k, q = len(self.disturbances), len(self.outputs)
        shapes: dict[str, tuple[int, ...]]
        shapes = {"A": (n, n), "B": (n, m), "E": (n, k), "C": (q, n), "D": (q, m)}
        if self.delays is not None:
            r = len(self.delays.times)
            shapes |= {
                "delays.times": (r,),
                "delays.to_states": (n, r),
                "delays.from_states": (r, n),
                "delays.from_inputs": (r, m),
                "delays.from_disturbances": (r, k),
                "delays.through": (r, r),
                "delays.to_outputs": (q, r),
            }
        for name, shape in shapes.items():
            found = np.shape(attrgetter(name)(self))
            if found != shape:
                raise ValueError(f"linear model: {name} is {found}, its names make {shape}")
        if self.delays is not None and not len(self.delays.times):
            object.__setattr__(self, "delays", None)

    @property
    def times(self) -> np.ndarray:
        """Dead times of the delayed signals [r], [s]."""
        return np.zeros(0) if self.delays is None else self.delays.times

    @property
    def ports(self) -> Ports:
        """Where the signals stand in `matrix`."""
        groups = (self.states, self.inputs, self.disturbances, self.outputs, self.times)
        return Ports.of(*map(len, groups))

    @property
    def matrix(self) -> np.ndarray:
        """M of [ẋ; y; w] = M [x; u; d; z], in which the delayed signals are left open."""
        at, late = self.ports, self.delays
        matrix = np.zeros((at.w.stop, at.z.stop))
        matrix[at.x, at.x], matrix[at.x, at.u], matrix[at.x, at.d] = self.A, self.B, self.E
        matrix[at.y, at.x], matrix[at.y, at.u] = self.C, self.D
        if late is not None:
            matrix[at.x, at.z], matrix[at.y, at.z] = late.to_states, late.to_outputs
            matrix[at.w, at.x], matrix[at.w, at.u] = late.from_states, late.from_inputs
            matrix[at.w, at.d], matrix[at.w, at.z] = late.from_disturbances, late.through
        return matrix

    def with_matrix(self, M: np.ndarray, times: np.ndarray, **changes: Any) -> LinearModel:
        """Return the model of another `matrix` and its dead times, with other fields changed too.

        Parameters
        ----------
        M : ndarray [n + q + r, n + m + k + r]
            No disturbance may act on an output directly: [y, d] is left out.
        times : ndarray [r]
            [s]
        **changes
            Names of another number of signals, and `point`.
        """
        kinds = ("states", "inputs", "disturbances", "outputs")
        names = [changes.get(kind, getattr(self, kind)) for kind in kinds]
        x, u, d, z, y, w = Ports.of(*map(len, [*names, times]))
        late = InternalDelays(times, M[x, z], M[w, x], M[w, u], M[w, d], M[w, z], M[y, z])
        return replace(
            self, A=M[x, x], B=M[x, u], E=M[x, d], C=M[y, x], D=M[y, u], delays=late, **changes
        )

    def select(
        self, outputs: Sequence[str] | None = None, inputs: Sequence[str] | None = None
    ) -> LinearModel:
        """Return the model from some inputs to some outputs, in the order given.

        All states and disturbances stay, so the model may have states that the chosen signals
        neither move nor show.

        Parameters
        ----------
        outputs, inputs : sequence of str, optional
            Names; all where left out.

        Raises
        ------
        InputError
            A name is unknown or stands twice.
        """
        rows = _places("outputs", self.outputs, outputs)
        columns = _places("inputs", self.inputs, inputs)
        return _selected(self, tuple(rows), tuple(columns))

    def of_states(self, kept: Sequence[int]) -> LinearModel:
        """Return the model of the states at some places, in the order given; the others rest."""
        return self._part(kept, range(len(self.inputs)), range(len(self.outputs)))

    def _part(
        self, states: Sequence[int], inputs: Sequence[int], outputs: Sequence[int]
    ) -> LinearModel:
        at, chosen = self.ports, {"states": states, "inputs": inputs, "outputs": outputs}
        rows = [*states, *(at.y.start + i for i in outputs), *range(at.w.start, at.w.stop)]
        columns = [*states, *(at.u.start + i for i in inputs), *range(at.d.start, at.z.stop)]
        names = {
            kind: tuple(getattr(self, kind)[place] for place in places)
            for kind, places in chosen.items()
        }
        part = self.with_matrix(self.matrix[np.ix_(rows, columns)], self.times, **names)
        return part if part.delays is None else part._without_hidden(self.delays)

    def _without_hidden(self, before: InternalDelays | None) -> LinearModel:
        """Return the model without delayed signals that only outputs showed which are gone."""
        late, at = self.delays, self.ports
        if late is None or before is None:
            return self
        shown = before.to_outputs.any(axis=0) & ~late.to_outputs.any(axis=0)
        kept = np.flatnonzero(~shown | late.to_states.any(axis=0) | late.through.any(axis=0))
        if len(kept) == len(late.times):
            return self
        rows = [*range(at.w.start), *(at.w.start + i for i in kept)]
        columns = [*range(at.z.start), *(at.z.start + i for i in kept)]
        return self.with_matrix(self.matrix[np.ix_(rows, columns)], late.times[kept])

    def to_control(self) -> control.StateSpace:
        """Return python-control's continuous state space with the same names.

        Its inputs are the manipulated inputs followed by the disturbances, so nothing is lost;
        `from_control` tells them apart again.

        Raises
        ------
        InputError
            The model has dead time, which a state space of python-control cannot hold.
        """
        import control

        refuse_delays(self.delays, "state spaces of python-control")
        no_feedthrough = np.zeros((len(self.outputs), len(self.disturbances)))
        return control.StateSpace(
            self.A,
            np.hstack([self.B, self.E]),
            self.C,
            np.hstack([self.D, no_feedthrough]),
            0,
            states=list(self.states),
            inputs=[*self.inputs, *self.disturbances],
            outputs=list(self.outputs),
            remove_useless_states=False,
        )

    @classmethod
    def from_control(
        cls, system: control.StateSpace, disturbances: Sequence[str] = ()
    ) -> LinearModel:
        """Return the model of a python-control state space, names included.

        Parameters
        ----------
        system : control.StateSpace
            Continuous in time.
        disturbances : sequence of str
            Names of those inputs that nobody manipulates.

        Raises
        ------
        InputError
            The system is no state space, is sampled, lacks a named disturbance, or has a
            disturbance that acts on an output directly.
        """
        import control

        place = "python-control system"
        if not isinstance(system, control.StateSpace):
            expected = "a control.StateSpace"
            remedy = "convert it first, for example by control.ss(system)"
            raise InputError(place, type(system).__name__, expected, remedy)
        if system.dt not in (0, None):
            expected = "a continuous system, dt = 0"
            raise InputError(f"{place}, dt", system.dt, expected, "give the continuous model")
        names = tuple(system.input_labels)
        disturbed = _places("inputs", names, list(disturbances))
        manipulated = [place for place in range(len(names)) if place not in disturbed]
        matrices = [np.array(matrix, float) for matrix in (system.A, system.B, system.C, system.D)]
        A, B, C, D = matrices
        if np.any(D[:, disturbed] != 0.0):
            expected = "zeros in the columns of the disturbances"
            remedy = "let the disturbance act through a state, or name it as an input"
            raise InputError(f"{place}, D", D[:, disturbed].tolist(), expected, remedy)
        return cls(
            A=A,
            B=B[:, manipulated],
            E=B[:, disturbed],
            C=C,
            D=D[:, manipulated],
            states=tuple(system.state_labels),
            inputs=tuple(names[place] for place in manipulated),
            disturbances=tuple(disturbances),
            outputs=tuple(system.output_labels),
        )


@lru_cache(maxsize=16)
def _selected(model: LinearModel, rows: tuple[int, ...], columns: tuple[int, ...]) -> LinearModel:
    """Return the part of a model, one for all who ask: so its zeros, too, are found once.

    Every controller of a study looks at the same few parts.
    """
    found = model._part(range(len(model.states)), columns, rows)
    for matrix in (found.A, found.B, found.C, found.D, found.E):
        matrix.flags.writeable = False
    return found


def _places(what: str, names: tuple[str, ...], wanted: Sequence[str] | None) -> list[int]:
    """Return where the wanted names stand among the names."""
    if wanted is None:
        return list(range(len(names)))
    places = []
    for name in wanted:
        require_known(f"linear model, {what}", name, names, remedy="use one of these names")
        if names.index(name) in places:
            raise InputError(f"linear model, {what}", name, "each name once", "name it once")
        places.append(names.index(name))
    return places


def led_back(matrix: np.ndarray, columns: slice, rows: slice, gain: np.ndarray) -> np.ndarray:
    """Return M of a model whose rows are led back to some of its columns by a gain.

    The lower linear fractional transformation, with all rows and columns kept:
    M + M[:, u] K (I - M[y, u] K)⁻¹ M[y]. What leaves and comes back may balance to nothing.

    Examples
    --------
    An integrator of gain 3 under negative unity feedback:

    >>> led_back(np.array([[0.0, 3.0], [1.0, 0.0]]), slice(1, 2), slice(1, 2), np.array([[-1.0]]))
    array([[-3.,  3.],
           [ 1.,  0.]])
    """
    shown = matrix[rows]
    solved = np.linalg.solve(np.eye(len(shown)) - shown[:, columns] @ gain, shown)
    back = matrix[:, columns] @ gain
    return unbalanced(matrix + back @ solved, np.abs(matrix) + np.abs(back) @ np.abs(solved))
