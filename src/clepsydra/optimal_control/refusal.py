"""Why a plant cannot be controlled optimally: what decides there is no course of inputs."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.words import listed
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.motion import Motion


def refusal(point: OperatingPoint, judged: tuple[str, ...]) -> str:
    """Return why there is no best course of inputs, in a sentence without its end; else nothing.

    Parameters
    ----------
    point : OperatingPoint
        Where it rests.
    judged : tuple of str
        Controlled measurements that are meant to follow setpoints.

    Examples
    --------
    >>> import clepsydra as cl
    >>> refusal(cl.load("equalisation-tank").point, ())
    'level averages the flow, and is meant to move, not to follow a setpoint'
    """
    process, motion = point.process, point.process.motion
    if not judged:
        names = listed(process.averaging)
        verb, are = ("averages", "is") if len(process.averaging) == 1 else ("average", "are")
        return f"{names} {verb} the flow, and {are} meant to move, not to follow a setpoint"
    held = _symbols(motion, point)
    for guard, event in zip(ca.vertsplit(motion.guards(*held)), motion.events, strict=True):
        if not (event.harm or guard.is_constant()):
            return f"a switch decides, and no input: {event.words}"
    after = ca.vertsplit(motion.updates(*held))
    for signal, value in zip(motion.memories, after, strict=True):
        if not (value.is_constant() and float(value) == signal.initial):
            return f"what it does depends on its past, by friction: {signal.description}"
    return ""


def _symbols(motion: Motion, point: OperatingPoint) -> list[ca.SX]:
    """Return (c, z, m, u, d, p) as symbols, but for memories and parameters."""
    held = motion.at_rest(
        point.state, point.inputs, point.disturbances, point.process.parameter_values
    )
    names = ("c", "z", "", "u", "d", "")
    return [
        ca.SX.sym(name, len(values)) if name else ca.SX(values)
        for name, values in zip(names, held, strict=True)
    ]
