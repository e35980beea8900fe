"""IPOPT on a nonlinear programme, ended by a signal within an iteration."""

from __future__ import annotations

from typing import Any

import casadi as ca

from clepsydra.optimal_control.interruptible import Interruption

_OPTIONS = {
    "print_time": False,
    "record_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "mu_strategy": "adaptive",
        "tol": 1e-8,
        "max_iter": 100,
        "bound_relax_factor": 0.0,
    },
}
#: Answers of IPOPT that it has found an optimum, and that nothing satisfies the constraints.
_FOUND = ("Solve_Succeeded", "Solved_To_Acceptable_Level")
_IMPOSSIBLE = ("Infeasible_Problem_Detected", "Restoration_Failed")


class NoCourse(Exception):
    """The search found no course.

    Parameters
    ----------
    impossible : bool
        Whether there is none within the constraints; else nobody knows.
    """

    def __init__(self, impossible: bool) -> None:
        self.impossible = impossible
        super().__init__(impossible)


class Search:
    """The search for the optimum of one nonlinear programme.

    A. Wächter and L. T. Biegler, Mathematical Programming 106, 2006, doi 10.1007/s10107-004-0559-y.

    Parameters
    ----------
    problem : dict
        Unknowns x, objective f and constraints g, of parameters p where it has any.
    expand : bool
        Whether its functions are written out, which makes a small one faster.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> search = Search({"x": x, "f": (x - 2.0) ** 2, "g": x})
    >>> round(float(search(x0=0.0, ubg=1.0)["x"]), 6)
    1.0
    """

    def __init__(self, problem: dict[str, Any], *, expand: bool = False) -> None:
        sizes = (problem[name].numel() for name in ("x", "g", "p") if name in problem)
        self._interruption = Interruption(*sizes)
        options: dict[str, Any] = {**_OPTIONS, "expand": expand}
        options["iteration_callback"] = self._interruption
        self._solver = ca.nlpsol("search", "ipopt", problem, options)

    def __call__(self, **given: Any) -> dict[str, ca.DM]:
        """Return what is found from the arguments of the solver.

        Raises
        ------
        NoCourse
            Nothing was found.
        KeyboardInterrupt
            It was interrupted.
        """
        with self._interruption.heeded():
            found: dict[str, ca.DM] = self._solver(**given)
        status = self._solver.stats()["return_status"]
        if status not in _FOUND:
            raise NoCourse(status in _IMPOSSIBLE)
        return found
