"""A run: the named trajectories of one loop in one scenario."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process


@dataclass(frozen=True)
class Run:
    """What one closed loop did in one scenario.

    Parameters
    ----------
    process : Process
    controller : Controller
    scenario : Scenario
    time : ndarray [samples]
        Start of each sample [s].
    signals : tuple of Signal
        One for each trajectory.
    values : dict
        Name to trajectory [samples], in the signal's SI unit: every state "tank_1.level",
        measurement "level_1" (with its noise), setpoint "level_1.setpoint", manipulated
        variable "pump_1" (held during the sample), status "pump_1.status", disturbance
        "inflow_1".
    error_estimate : float or None
        Largest difference to a run with half the integration step, as a fraction of the
        state's range; None where it was not asked for.
    substeps : int
        RK4 steps in one sample; 0 for the reference solver.
    """

    process: Process
    controller: Controller
    scenario: Scenario
    time: np.ndarray
    signals: tuple[Signal, ...]
    values: dict[str, np.ndarray]
    error_estimate: float | None
    substeps: int
