"""Where a simulation begins, as a caller says it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, get_args

from clepsydra.base.arguments import require_known, require_signal, require_type
from clepsydra.controllers.wiring import controller_name
from clepsydra.interface.plant import Plant
from clepsydra.interface.quantities import Quantity, check_within, read_signal
from clepsydra.loop.begin import Begin, ControllerStart, begin_from
from clepsydra.loop.loop_state import LoopState
from clepsydra.loop.open_loop_plan import Start
from clepsydra.program.entries import signal_of

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.operating_point import OperatingPoint

#: Where a simulation begins: at rest, with empty tanks, at rest at another operating point of the
#: plant, or where another run ended, its `final_state`.
AnyStart = Start | Plant | LoopState


def begin_of(
    plant: Plant,
    controller: Controller,
    start: AnyStart,
    state: Mapping[str, Quantity],
    controller_start: ControllerStart | None,
) -> Begin | None:
    """Return where a closed loop begins; None where that is at rest at its operating point.

    Parameters
    ----------
    state : mapping
        States of the process, inputs and states of the controller that stand elsewhere, text with
        a unit or a number in the unit that is shown.
    controller_start : {"bumpless", "cold"}, optional
        How the controller starts; if left out bumpless, or as it was after a run of it.

    Raises
    ------
    InputError
        A name is unknown, a quantity is none of its signal, or a start is of another process.
    """
    found = known_start(start)
    if controller_start is not None:
        ways = get_args(ControllerStart)
        require_known("controller_start", controller_start, ways, remedy="choose one")
    process = plant.process
    of_law = [
        replace(signal_of(entry), name=controller_name(entry.name))
        for entry in controller.law.state
    ]
    words = f"a state or an input of {process.name}, or a state of its controller"
    given = read_states(state, (*process.state, *process.inputs, *of_law), words)
    own = {signal.name for signal in of_law}
    return begin_from(
        plant.point,
        found,
        given={name: value for name, value in given.items() if name not in own},
        law={n.removeprefix(controller_name("")): v for n, v in given.items() if n in own},
        controller_start=controller_start,
    )


def known_start(start: Any) -> Start | OperatingPoint | LoopState:
    """Return where a simulation begins; refuse what is no such place, with the nearest name."""
    if isinstance(start, Plant):
        return start.point
    if isinstance(start, str):
        require_known("start", start, get_args(Start), remedy="choose one")
    remedy = 'write "rest", "empty", a plant, or the final_state of a run'
    require_type(start, (str, LoopState), "start", "where it begins", remedy)
    known: Start | LoopState = start
    return known


def read_states(
    given: Mapping[str, Quantity], signals: Iterable[Signal], words: str
) -> dict[str, float]:
    """Return values at which a simulation begins by name [SI].

    Parameters
    ----------
    words : str
        What the signals are, for a refusal.
    """
    remedy = 'write as in {"tank_1.level": "5 cm"}'
    require_type(given, Mapping, "state", "states with their values", remedy)
    known, found = tuple(signals), {}
    for name, value in given.items():
        signal = require_signal("state", name, known, words)
        found[name] = read_signal("state", name, value, signal, "a value")
        check_within("state", name, signal, found[name], value, "a value")
    return found
