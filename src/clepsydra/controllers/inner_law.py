"""A step law computed inside another one."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.errors import ClepsydraError
from clepsydra.program.step_law import Equations, StepLaw, Symbols


def inner_equations(law: StepLaw, symbols: Symbols) -> Equations:
    """Return what a law computes; the calls of its blocks are calls of the law around it.

    Parameters
    ----------
    symbols : mapping
        Its state, inputs and parameters by name, among others.

    Raises ClepsydraError: the law is Python.
    """
    if law.equations is None:
        raise ClepsydraError(f"{law.name}: a law in Python cannot stand in another one")
    names = [entry.name for entry in (*law.state, *law.inputs, *law.parameters)]
    found = law.equations({name: symbols[name] for name in names})
    following, outputs, between = (
        {name: ca.SX(value) for name, value in group.items()}
        for group in (found.next_state, found.outputs, found.intermediates)
    )
    return Equations(following, outputs, between)
