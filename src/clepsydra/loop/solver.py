"""The two ways to carry a process through time."""

from __future__ import annotations

from typing import Literal, get_args

from clepsydra.base.arguments import check_choice

#: The compiled kernel with RK4, or CVODES with switches located by SciPy's DOP853.
Solver = Literal["kernel", "reference"]


def check_solver(solver: str) -> None:
    """Refuse a solver that there is not.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_solver("euler")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: solver: got 'euler', expected one of kernel, reference; \
correct the name.
    """
    check_choice("solver", solver, get_args(Solver))
