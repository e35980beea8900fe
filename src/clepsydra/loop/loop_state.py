"""What lives in a loop from one sample to the next: levels, memories, delays and controller."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.errors import UnknownKey
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import from_si, unit_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import controller_name
from clepsydra.loop.reported_readings import held_names
from clepsydra.loop.shown_levels import shown_levels
from clepsydra.process.process import Process
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of


@dataclass(frozen=True, eq=False, repr=False)
class LoopState(Mapping[str, float]):
    """The state of a process and of its controller between two samples.

    It reads as a mapping: a state of the process, "tank_1.level", an input, "pump_1", or a state
    of the controller, "controller.level_1.integral", to its value [SI]. Delays are in it too. What
    is counted from the start of a run, such as a volume spilt, is not.

    Parameters
    ----------
    process, controller : str
        Their names; that of the controller is empty where there was none.
    signals : tuple of Signal
        One for each value.
    numbers : dict
        Signal to its value [SI].
    contents : dict
        What is integrated or remembered of the process, as the integrator has it, and of what its
        sensors have told.
    rings : dict
        What each delay ring holds, the oldest first [length].
    substeps : int
        Integration steps in a sampling period of the run that ended there; 0 of the reference
        solver. A run that goes on from there takes as many at least.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> state = cl.simulate(plant, cl.design.simc(plant), [], duration="10 s").final_state
    >>> round(state["tank_1.level"], 4), round(state["controller.level_1.integral"], 2)
    (0.1226, 3.0)
    """

    process: str
    controller: str
    signals: tuple[Signal, ...]
    numbers: dict[str, float]
    contents: dict[str, float]
    rings: dict[str, np.ndarray]
    substeps: int

    def __getitem__(self, name: str) -> float:
        if name in self.numbers:
            return self.numbers[name]
        remedy = suggestion(name, self.numbers, "print the state, which lists them")
        expected = f"a state of {self.process} or its controller"
        raise UnknownKey("final_state", str(name)[:60], expected, remedy)

    def __iter__(self) -> Iterator[str]:
        return iter(self.numbers)

    def __len__(self) -> int:
        return len(self.numbers)

    def __repr__(self) -> str:
        under = f" under {self.controller}" if self.controller else ""
        lines = [f"State of {self.process}{under}"]
        for signal in self.signals:
            shown = from_si(self[signal.name], signal.unit, signal.shown_unit)
            lines.append(f"{signal.name} = {shown:.6g} {unit_text(signal.shown_unit)}".rstrip())
        return "\n".join(lines)

    def of_law(self) -> dict[str, float]:
        """Return the states of the controller by their names in its law."""
        return {s.name.removeprefix(controller_name("")): self[s.name] for s in self._of_law}

    @property
    def _of_law(self) -> tuple[Signal, ...]:
        return tuple(s for s in self.signals if s.name.startswith(controller_name("")))


def loop_state(
    process: Process,
    controller: Controller | None,
    found: Mapping[str, float],
    inputs: Mapping[str, float],
    rings: Mapping[str, np.ndarray],
    substeps: int,
) -> LoopState:
    """Return the state of a loop.

    Parameters
    ----------
    found : mapping
        Contents and memories of the process, and the states of the law by their names in the loop.
    inputs : mapping
        What was last applied at each input of the process.
    """
    motion = process.motion
    lived = [s.name for s in (*motion.contents, *motion.memories)] + held_names(process)
    contents = {name: float(found[name]) for name in lived}
    integrated = np.array([contents[signal.name] for signal in motion.contents])
    states = np.array(motion.to_state(integrated, process.parameter_values)).ravel()
    columns = {s.name: np.array([v]) for s, v in zip(process.state, states, strict=True)}
    columns |= shown_levels(process, columns)
    values = {name: float(column[0]) for name, column in columns.items()}
    law = [] if controller is None else [*controller.law.state]
    own = [signal_of(entry) for entry in law]
    names = {signal.name: controller_name(signal.name) for signal in own}
    values |= {signal.name: float(inputs[signal.name]) for signal in process.inputs}
    of_law = {
        names[entry.name]: float(rings[names[entry.name]][0])
        if isinstance(entry, DelayRing)
        else float(found[names[entry.name]])
        for entry in law
    }
    shown = [replace(signal, name=names[signal.name]) for signal in own]
    return LoopState(
        process.name,
        "" if controller is None else controller.name,
        (*process.state, *process.inputs, *shown),
        values | of_law,
        contents,
        {name: np.array(ring, float).ravel() for name, ring in rings.items()},
        substeps,
    )
