"""The part of a process that acts on its outputs, with an unknown load on its inputs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.pickled_fields import PickledFields
from clepsydra.optimal_control.plant_model import PlantModel


@dataclass(frozen=True, eq=False)
class ActingModel(PickledFields):
    """ẋ = f(x, u + l), y(x) and the guards of what must not happen, of some inputs.

    Contents that do not act on the outputs, inputs that are not moved and disturbances stand where
    the plant rests. The load l is what is added to an input without being asked for.

    Parameters
    ----------
    plant : PlantModel
        Without dead time, at rest.
    moved : tuple of str
        The inputs u.

    Examples
    --------
    >>> import clepsydra as cl
    >>> point = cl.load("three-tanks").point
    >>> signals = point.process.inputs
    >>> ends = np.array([[u.low for u in signals], [u.high for u in signals]])
    >>> model = ActingModel(PlantModel(
    ...     point, point, point.process.controlled, np.ones(1), (ends[0], ends[1]),
    ...     point.disturbances[None, :]), ("feed",))
    >>> rates = model.rates(model.rest, model.inputs_at_rest, 0.0)
    >>> len(model.rest), bool(np.allclose(np.array(rates), 0.0, atol=1e-9))
    (3, True)
    """

    plant: PlantModel
    moved: tuple[str, ...]

    @cached_property
    def places(self) -> list[int]:
        """Of the moved inputs among those of the process."""
        names = [signal.name for signal in self.plant.process.inputs]
        return [names.index(name) for name in self.moved]

    @property
    def rest(self) -> np.ndarray:
        """The contents where the plant rests, scaled."""
        return self.plant.start[0][self.plant.acting]

    @property
    def scales(self) -> np.ndarray:
        """What the contents are divided by [SI]."""
        return self.plant.scales[0][self.plant.acting]

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Between which ends the contents may move, scaled."""
        low, high = self.plant.bounds
        return low[self.plant.acting], high[self.plant.acting]

    @property
    def inputs_at_rest(self) -> np.ndarray:
        """The inputs where the plant rests, shares of their range."""
        return self.plant.target_inputs[self.places]

    @property
    def input_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """The ends of the ranges of the inputs [SI]."""
        low, high = self.plant.input_bounds
        return low[self.places], high[self.places]

    @cached_property
    def rates(self) -> ca.Function:
        """(x, u, l) → dx/dt [scale/s]."""
        x, u, load, held = self._held
        return ca.Function("rates", [x, u, load], [self.plant.rates(*held)[self.plant.acting]])

    @cached_property
    def guards(self) -> ca.Function:
        """(x, u, l) → guards of what must not happen, at most 0 where it is far enough."""
        x, u, load, held = self._held
        return ca.Function("guards", [x, u, load], [self.plant.guards(*held)])

    @cached_property
    def errors(self) -> ca.Function:
        """(x, r) → (y - r)/size of the outputs."""
        x, _, _, held = self._held
        r = ca.SX.sym("r", len(self.plant.outputs))
        return ca.Function("errors", [x, r], [self.plant.errors_to(held[0], r)])

    @cached_property
    def _held(self) -> tuple[ca.SX, ca.SX, ca.SX, tuple[ca.SX, ca.SX, ca.SX, ca.SX]]:
        """Return x, u, l, and what the equations of the whole plant take."""
        plant = self.plant
        count = len(self.moved)
        x = ca.SX.sym("x", len(plant.acting))
        u, load = ca.SX.sym("u", count), ca.SX.sym("l", count)
        contents, inputs = ca.SX(plant.start[0]), ca.SX(plant.target_inputs)
        for row, place in enumerate(plant.acting):
            contents[place] = x[row]
        for row, place in enumerate(self.places):
            inputs[place] = u[row] + load[row]
        delayed = ca.SX(plant.start[1])
        return x, u, load, (contents, inputs, delayed, ca.SX(plant.before.disturbances))
