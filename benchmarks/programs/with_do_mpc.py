"""The predictive controller of the quadruple tank as a user of do-mpc writes it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.programs.problems import TankControl


def controller(control: TankControl) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return what takes levels and the voltages that are on to the next voltages.

    A linear model and IPOPT, as do-mpc brings them; it begins with the last solution.
    """
    with warnings.catch_warnings():
        # Of features that are not installed.
        warnings.simplefilter("ignore")
        import do_mpc

        a, b = control.model
        model = do_mpc.model.LinearModel("discrete")
        levels = model.set_variable("_x", "level", shape=(4, 1))
        model.set_variable("_u", "voltage", shape=(2, 1))
        model.setup(a, b)
        mpc: Any = do_mpc.controller.MPC(model)
        mpc.set_param(n_horizon=control.ahead, t_step=control.period, store_full_solution=False)
        mpc.settings.supress_ipopt_output()
        error = levels[:2] - np.array([control.setpoint]).T
        cost = error.T @ error
        mpc.set_objective(mterm=cost, lterm=cost)
        mpc.set_rterm(voltage=control.movement)
        for bound, sign in (("lower", -1), ("upper", 1)):
            mpc.bounds[bound, "_u", "voltage"] = sign * np.full((2, 1), control.highest_voltage)
            level = np.array([control.highest_level] * 2 + [np.inf] * 2)
            mpc.bounds[bound, "_x", "level"] = sign * level
        mpc.setup()
        mpc.x0, mpc.u0 = np.zeros((4, 1)), np.zeros((2, 1))
        mpc.set_initial_guess()

    def step(levels: np.ndarray, voltages: np.ndarray) -> np.ndarray:
        mpc.u0 = voltages.reshape(2, 1)
        return np.asarray(mpc.make_step(levels.reshape(4, 1))).ravel()

    return step
