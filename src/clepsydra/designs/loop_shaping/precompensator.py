"""A pre-compensator: the linear controller that gives a loop its shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import StepLawDerivatives
from clepsydra.designs.sampled.sampled_loop import inputs_at_rest
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.linear.linear_model import LinearModel

_SAME = 1e-9
_SINGULAR = 1e12


@dataclass(frozen=True, eq=False)
class Precompensator:
    """From the control errors r − y to the deviations of the inputs, from sample to sample.

    Parameters
    ----------
    name : str
        For the reader: "PI, SIMC".
    system : SampledSystem
        W₁
    outputs, inputs : tuple of str
        Controlled measurements and manipulated variables, in the order of the system.
    slowed : float
        How many times slower than its method asked for it is.

    Raises
    ------
    InputError
        The system does not have as many signals.

    Examples
    --------
    >>> one = np.eye(1)
    >>> gain = Precompensator("P", SampledSystem(one[:0, :0], one[:0], one[:, :0], 2.0 * one),
    ...                       ("level",), ("pump",))
    >>> gain.inverse_direct
    array([[0.5]])
    """

    name: str
    system: SampledSystem
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    slowed: float = 1.0

    def __post_init__(self) -> None:
        (rows, columns), m, q = self.system.D.shape, len(self.inputs), len(self.outputs)
        if (rows, columns) != (m, q):
            given = f"{rows} outputs and {columns} inputs"
            expected = f"{m} and {q}, one for each input and output of the process"
            remedy = "name the signals of the pre-compensator"
            raise InputError("precompensator", given, expected, remedy)

    @property
    def inverse_direct(self) -> np.ndarray | None:
        """D⁻¹; None where there is none, or where the inverse of W₁ is unstable."""
        D = self.system.D
        if D.shape[0] != D.shape[1] or np.linalg.cond(D) > _SINGULAR:
            return None
        inverse = np.linalg.inv(D)
        unwound = self.system.A - self.system.B @ inverse @ self.system.C
        runs_away = np.max(np.abs(np.linalg.eigvals(unwound)), initial=0.0) > 1.0 - _SAME
        return None if runs_away else inverse


def precompensator_of(controller: Controller, model: LinearModel) -> Precompensator:
    """Return what a controller does in automatic, away from its limits, as a pre-compensator.

    It is exact from sample to sample: the derivatives of the step law itself.

    Parameters
    ----------
    controller : Controller
        Acting on the errors of its setpoints alone, at rest at the operating point.
    model : LinearModel
        Of the process at this point.

    Raises
    ------
    InputError
        The controller answers to setpoints and to measurements in different ways, or reads
        measurements that have no setpoint.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> found = precompensator_of(cl.design.simc(plant), plant.linear)
    >>> found.system.D.round(6).tolist()
    [[3.0, 0.0], [0.0, 3.0]]
    """
    given = inputs_at_rest(controller, model)
    law = StepLawDerivatives(controller.law).at(controller.values, controller.initial_state, given)
    place, name = "precompensator", controller.name
    if sorted(controller.measurements) != sorted(controller.setpoints):
        raise InputError(
            place,
            f"{name}, which reads {', '.join(controller.measurements)}",
            f"the measurements that have setpoints alone: {', '.join(controller.setpoints)}",
            "choose a controller of the control errors, as PI control",
        )
    columns = [controller.measurements.index(each) for each in controller.setpoints]
    for by_setpoint, by_measurement in (
        (law.B_setpoint, law.B_measurement),
        (law.D_setpoint, law.D_measurement),
    ):
        size = float(np.abs(by_setpoint).max(initial=0.0))
        if np.abs(by_setpoint + by_measurement[:, columns]).max(initial=0.0) > _SAME * size:
            wrong = f"{name}, which answers to setpoint and measurement differently"
            remedy = "give it setpoint weights of one, and derivative action on the error"
            raise InputError(place, wrong, "a controller of the control errors alone", remedy)
    system = SampledSystem(law.A, law.B_setpoint, law.C, law.D_setpoint)
    return Precompensator(
        name, system, controller.setpoints, controller.manipulated, controller.slowed
    )
