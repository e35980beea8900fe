"""The controller that a plant gets where nobody names one."""

from __future__ import annotations

from clepsydra.base.errors import InputError
from clepsydra.interface.controller import Controller
from clepsydra.interface.every_design import designed, every_design
from clepsydra.interface.plant import Plant


def first_design(plant: Plant) -> Controller:
    """Return PI controllers by SIMC, or the first design that applies.

    Raises
    ------
    InputError
        None applies.

    Examples
    --------
    >>> import clepsydra as cl
    >>> first_design(cl.load("three-tanks")).name
    'PI, SIMC'
    """
    found = designed(plant, "PI, SIMC")
    if found is not None:
        return found
    designs, left_out = every_design(plant)
    if not designs:
        raise InputError(
            "controller", "none", "a controller: no design applies "
            f"({left_out[0][1] if left_out else 'there is none'})", "give one",
        )  # fmt: skip
    return designs[0]
