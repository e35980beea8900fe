"""An interlock: an alarm moves an output, whoever else would."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.signals import signed
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

INTERLOCK = truth("interlock", "an alarm holds the output at its interlock value")
INTERLOCK_VALUE = signed("interlock_value", "{output}", "value of {output} while an alarm holds it")
#: What stands for every number that is no mode, from above.
_NO_MODE = float(max(Mode)) + 1.0


def _held(s: Symbols) -> Equations:
    acts = s["interlock"]
    # One that is none stays none.
    asked = ca.fmin(_NO_MODE, ca.fmax(-1, s["mode"]))
    return Equations(
        {},
        {
            "mode_given": ca.if_else(acts, float(Mode.TRACKING), asked),
            "tracking_given": ca.if_else(acts, s["interlock_value"], s["tracking"]),
        },
    )


#: Stands before all that moves an output: while an alarm holds it, the output tracks the interlock
#: value, so that its law follows and goes on from there without a bump.
OUTPUT_INTERLOCK = Block(
    "output_interlock",
    (INTERLOCK, INTERLOCK_VALUE.port, signals.MODE.port, signals.TRACKING.port),
    (),
    (
        Signal(
            "mode_given",
            low=-1.0,
            high=_NO_MODE,
            kind="integer",
            description="mode that the output is given",
        ),
        Signal("tracking_given", description="tracking value that the output is given"),
    ),
    _held,
    ("An alarm holds an output at its interlock value, in every mode.",),
)
