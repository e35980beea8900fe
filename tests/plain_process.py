"""Processes by their equations, without elements, for tests."""

from dataclasses import replace
from typing import Any

import casadi as ca

import clepsydra as cl


def plain_process(**given: Any) -> Any:
    """Return a process that is nothing but dx/dt = f(x, u, d, p) and y = h(x, p)."""
    process = cl.load("quadruple-tank").process  # of which all that has equations is replaced
    dynamics, none = given["dynamics"], ca.SX(0, 1)
    x, u, d, p = (ca.SX.sym(name, dynamics.numel_in(i)) for i, name in enumerate("xudp"))
    held = [x, none, none, u, d, p]
    motion = replace(
        process.motion,
        contents=given["state"],
        totals=(),
        memories=(),
        delays=(),
        events=(),
        to_contents=ca.Function("to_contents", [x, p], [x]),
        to_state=ca.Function("to_state", [x, p], [x]),
        rates=ca.Function("rates", held, [dynamics(x, u, d, p), none, none]),
        guards=ca.Function("guards", held, [none]),
        resets=ca.Function("resets", [none, *held], [none]),
        updates=ca.Function("updates", held, [none]),
        stored=ca.Function("stored", [x, p], [none]),
        stored_names=(),
        flows=ca.Function("flows", held, [none]),
        flow_paths=(),
    )
    y = ca.SX.sym("y", len(given["measurements"]))
    display = ca.Function("display", [y], [y], ["y"], ["shown"])
    return replace(process, **{"display": display, "motion": motion, "noise": {}, **given})
