"""A controller: a step law with values for its parameters, wired to a process."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class Controller:
    """A step law, the values of its parameters, and the process signals it is wired to.

    Output i of the law is ``manipulated_i`` with ``mode_i``, ``manual_i``, ``tracking_i`` and
    ``status_i``; its measurements are ``measurement_1`` … with ``sensor_1`` …, its setpoints
    ``setpoint_1`` …, and ``time_step`` is common.

    Parameters
    ----------
    name : str
        What the reader sees: "PI, SIMC".
    family : str
        The kind of law: "multiloop PI".
    design : str
        How the parameters were found, in one sentence.
    law : StepLaw
    values : dict
        Parameter name to its value, in the law's units.
    initial_state : dict
        State name to its value at the operating point, so that the loop starts at rest.
    measurements : tuple of str
        Process measurement wired to measurement_1, measurement_2, …
    setpoints : tuple of str
        Controlled measurement whose setpoint is wired to setpoint_1, setpoint_2, …
    manipulated : tuple of str
        Process input wired to manipulated_1, manipulated_2, …
    notes : tuple of str
        What the designer must tell the reader.
    """

    name: str
    family: str
    design: str
    law: StepLaw
    values: dict[str, float]
    initial_state: dict[str, float]
    measurements: tuple[str, ...]
    setpoints: tuple[str, ...]
    manipulated: tuple[str, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class LinearController:
    """A controller's linear model, for margins: u = K(s) [setpoint - measurement …].

    ẋ = A x + B_setpoint r + B_measurement y,  u = C x + D_setpoint r + D_measurement y,
    in the order of the process's controlled measurements (r), measurements (y) and inputs (u).
    """

    A: np.ndarray
    B_setpoint: np.ndarray
    B_measurement: np.ndarray
    C: np.ndarray
    D_setpoint: np.ndarray
    D_measurement: np.ndarray
