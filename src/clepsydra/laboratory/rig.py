"""A process under some controllers, as a page moves it and as a session of it is run again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.wiring import controller_name
from clepsydra.deploy.printing.heading import digest
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.begin import begin_from
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.law_begin import loop_begin
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario, scenario_of_changes
from clepsydra.process.process import Process
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program

Start = Literal["rest", "empty"]
STARTS: tuple[Start, ...] = ("rest", "empty")


@dataclass(frozen=True)
class Standing:
    """Where a loop begins.

    Parameters
    ----------
    state : dict
        State of its program to its value [SI].
    rings : dict
        Delay ring to what it holds, the oldest first [length].
    """

    state: dict[str, float]
    rings: dict[str, np.ndarray]


class Station:
    """One controller of a rig, with the whole process that it moves.

    Nothing is folded into its program: setpoints, disturbances, modes, manual values, sensors and
    noise are inputs.

    Parameters
    ----------
    loop : Loop
    substeps : int
        RK4 steps in a sampling period.
    """

    def __init__(self, loop: Loop, substeps: int) -> None:
        self.loop, self.controller, self.substeps = loop, loop.controller, substeps
        self.program: Program = closed_loop(
            loop.process, loop.controller, substeps=substeps, readings=True
        )
        own, at_rest = loop.law_parameters(), loop.at_rest()
        self.parameters = {p.name: own.get(p.name, p.initial) for p in self.program.parameters}
        self.at_rest = {signal.name: at_rest[signal.name] for signal in self.program.inputs}

    @cached_property
    def starts(self) -> dict[Start, Standing]:
        """Where it begins: all at rest, or with empty tanks and in automatic without a bump."""
        return {start: self._standing(start) for start in STARTS}

    def _standing(self, start: Start) -> Standing:
        point = self.loop.point
        scenario = scenario_of_changes(point, [], 2, begin=begin_from(point, start))
        given, held = loop_begin(self.loop, scenario, self.substeps)
        signals = map(signal_of, self.program.state)
        state = {each.name: given.get(each.name, each.initial) for each in signals}
        rings = {
            ring.name: held.get(
                ring.name, np.full(ring.length, given.get(ring.name, ring.signal.initial))
            )
            for ring, _ in rings_and_turns(self.program)
        }
        return Standing(state, rings)

    @property
    def moving(self) -> int:
        """How many of the first states belong to the process."""
        return len(self.program.state) - len(self.controller.law.state)

    @property
    def process_rings(self) -> list[str]:
        """The rings that hold what is in the delays of the process."""
        of_law = {controller_name(entry.name) for entry in self.controller.law.state}
        rings = (ring.name for ring, _ in rings_and_turns(self.program))
        return [name for name in rings if name not in of_law]


@dataclass(frozen=True)
class Rig:
    """A process under some controllers, of which one has it in its hands.

    Each controller moves a process of its own. Those that do not have the rig follow in manual what
    the one moves that has it, so that each can take over without a bump.

    Parameters
    ----------
    model : LinearModel
        Of the process at the point where it rests.
    controllers : sequence of Controller

    Raises
    ------
    InputError
        There is no controller, two have one name, or one is a function in Python.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> rig = Rig(plant.linear, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> [station.controller.title for station in rig.stations], len(rig.digest)
    (['PI, SIMC', 'PI, AMIGO'], 16)
    """

    model: LinearModel
    controllers: Sequence[Controller]

    def __post_init__(self) -> None:
        names = [each.name for each in self.controllers]
        if not names:
            raise InputError("lab, controllers", 0, "at least one controller", "give one")
        for name in names:
            if names.count(name) > 1:
                raise InputError(
                    "lab, controllers", name, "names of which each is one controller's",
                    "give each once, or rename one by named()",
                )  # fmt: skip
        for each in self.controllers:
            if isinstance(each.law, PythonLaw):
                raise InputError(
                    f"lab, {each.name}", "a function in Python", "a law of expressions, which a "
                    "page can run", "write it as a step law, or leave it out",
                )  # fmt: skip

    @property
    def process(self) -> Process:
        """The process."""
        return self.stations[0].loop.process

    @cached_property
    def scenario(self) -> Scenario:
        """The default one, of which the integration steps and the noise of the sensors are."""
        return default_scenario(self.model)

    @cached_property
    def noises(self) -> dict[str, float]:
        """Measurement to the standard deviation of its noise [SI]."""
        measured = {signal.name for signal in self.process.measurements}
        found = self.scenario.noises
        return {each.signal: each.deviation for each in found if each.signal in measured}

    @cached_property
    def stations(self) -> list[Station]:
        """One for each controller, all with the same integration steps."""
        loops = [Loop(each, self.model) for each in self.controllers]
        substeps = max(loop.run_checked(self.scenario).substeps for loop in loops)
        return [Station(loop, substeps) for loop in loops]

    @cached_property
    def digest(self) -> str:
        """What tells it from every other: programs, numbers, noise, and where it begins."""
        said: list[object] = [self.noises]
        said += [
            (
                digest(each.program), each.parameters, each.at_rest,
                [(s.state, {n: r.tolist() for n, r in s.rings.items()})
                 for s in each.starts.values()],
            )
            for each in self.stations
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(said).encode()).hexdigest()[:16]
