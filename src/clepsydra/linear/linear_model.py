"""The linear model of a process near an operating point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.linear.internal_delays import InternalDelays, refuse_delays

if TYPE_CHECKING:
    import control

    from clepsydra.linear.operating_point import OperatingPoint


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
        shapes = {"A": (n, n), "B": (n, m), "E": (n, k), "C": (q, n), "D": (q, m)}
        for name, shape in shapes.items():
            found = np.shape(getattr(self, name))
            if found != shape:
                raise ValueError(f"linear model: {name} is {found}, its names make {shape}")
        if self.delays is not None:
            self.delays.check_shapes(n, m, k, q)
            if not len(self.delays.times):
                object.__setattr__(self, "delays", None)

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
        return replace(
            self,
            B=self.B[:, columns],
            C=self.C[rows],
            D=self.D[np.ix_(rows, columns)],
            inputs=tuple(self.inputs[column] for column in columns),
            outputs=tuple(self.outputs[row] for row in rows),
            delays=None if self.delays is None else self.delays.select(rows, columns),
        )

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
            raise InputError(
                f"{place}, D",
                D[:, disturbed].tolist(),
                "zeros in the columns of the disturbances",
                "let the disturbance act through a state, or name it as an input",
            )
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


def _places(what: str, names: tuple[str, ...], wanted: Sequence[str] | None) -> list[int]:
    """Return where the wanted names stand among the names."""
    if wanted is None:
        return list(range(len(names)))
    places = []
    for name in wanted:
        if name not in names:
            expected = "one of " + ", ".join(names)
            remedy = suggestion(name, names, "use one of these names")
            raise InputError(f"linear model, {what}", name, expected, remedy)
        if names.index(name) in places:
            raise InputError(f"linear model, {what}", name, "each name once", "name it once")
        places.append(names.index(name))
    return places
