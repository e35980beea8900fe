"""A process under some controllers, as a page moves it and as a session of it is run again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.wiring import controller_name
from clepsydra.deploy.printing.heading import digest
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.laboratory.free_laws import FreeLaw, free_laws
from clepsydra.laboratory.hands import HandsOnTank, hands_on, with_hands
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.alarms import acknowledging_inputs
from clepsydra.loop.begin import begin_from
from clepsydra.loop.closed_loop import closed_loop, loop_inputs
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.faults import HELD, fault_inputs
from clepsydra.loop.law_begin import cold_state, loop_begin
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario, scenario_of_changes
from clepsydra.process.process import Process
from clepsydra.program.delay_ring import DelayRing
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


@dataclass(frozen=True)
class Numbers:
    """The numbers of a controller and its process in a rig, all SI.

    Parameters
    ----------
    parameters : dict
        Parameter of the program to its value.
    at_rest : dict
        Input of the program to its value at rest, in automatic and without a fault.
    starts : dict
        Where it begins: all at rest, or with empty tanks and in automatic without a bump.
    cold : Standing
        Its law with nothing in its memory.
    """

    parameters: dict[str, float]
    at_rest: dict[str, float]
    starts: dict[Start, Standing]
    cold: Standing


class Station:
    """One controller of a rig, with the whole process that it moves.

    Nothing is folded into its program: setpoints, disturbances, modes, manual values, sensors,
    noise, faults and what acknowledges alarms are inputs. What comes over the rim of an open tank
    without a weir is spilt.

    Parameters
    ----------
    loop : Loop
    substeps : int
        RK4 steps in a sampling period.
    numbers : Numbers, optional
        Other ones than those of the loop, as of the page of which a session is.
    """

    def __init__(self, loop: Loop, substeps: int, numbers: Numbers | None = None) -> None:
        self.loop, self.controller, self.substeps = loop, loop.controller, substeps
        self.program: Program = closed_loop(
            loop.process, loop.controller, substeps=substeps, readings=True, faults=True,
            alarms=True, operated=True, rims=True,
        )  # fmt: skip
        self._given = numbers

    @cached_property
    def numbers(self) -> Numbers:
        """Its numbers."""
        if self._given is not None:
            return self._given
        own, resting = self.loop.law_parameters(), self.loop.at_rest()
        at_rest = {s.name: resting.get(s.name, s.initial) for s in self.program.inputs}
        return Numbers(
            parameters={p.name: own.get(p.name, p.initial) for p in self.program.parameters},
            at_rest=at_rest,
            starts={start: self._standing(start, at_rest) for start in STARTS},
            cold=self._cold(),
        )

    def _standing(self, start: Start, at_rest: dict[str, float]) -> Standing:
        point = self.loop.point
        scenario = scenario_of_changes(point, [], 2, begin=begin_from(point, start))
        given, held = loop_begin(self.loop, scenario, self.substeps)
        given |= {path(u.name, HELD): at_rest[f"{u.name}.manual"] for u in self.loop.process.inputs}
        signals = map(signal_of, self.program.state)
        state = {each.name: given.get(each.name, each.initial) for each in signals}
        rings = {
            ring.name: held.get(
                ring.name, np.full(ring.length, given.get(ring.name, ring.signal.initial))
            )
            for ring, _ in rings_and_turns(self.program)
        }
        return Standing(state, rings)

    def _cold(self) -> Standing:
        state = {controller_name(name): x for name, x in cold_state(self.controller).items()}
        rings = {
            controller_name(entry.name): np.full(entry.length, entry.signal.initial)
            for entry in self.controller.law.state
            if isinstance(entry, DelayRing)
        }
        return Standing(state, rings)

    @property
    def settings(self) -> list[str]:
        """The parameters of its law, as the program calls them."""
        return [controller_name(each.name) for each in self.controller.law.parameters]

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
    the one moves that has it, so that each can take over without a bump. Behind them stand the laws
    that take a reader's numbers.

    Parameters
    ----------
    model : LinearModel
        Of the process at the point where it rests.
    controllers : sequence of Controller
    numbers : mapping, optional
        Controller to other numbers than its own, as a page has them.

    Raises
    ------
    InputError
        There is no controller, two have one name, or one is a function in Python.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> rig = Rig(plant.linear, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> [station.controller.title for station in rig.stations][:2], len(rig.digest)
    (['PI, SIMC', 'PI, AMIGO'], 16)
    """

    model: LinearModel
    controllers: Sequence[Controller]
    numbers: Mapping[str, Numbers] = field(default_factory=dict)

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

    @cached_property
    def handled(self) -> LinearModel:
        """That of the process that hands can pour into and drill."""
        return with_hands(self.model)

    @property
    def process(self) -> Process:
        """The process, with what hands can do to it."""
        return operating_point_of(self.handled).process

    @cached_property
    def tanks(self) -> list[HandsOnTank]:
        """What hands can do to its tanks."""
        return hands_on(operating_point_of(self.handled))

    @property
    def point(self) -> OperatingPoint:
        """Where the process rests, as its file has it."""
        return operating_point_of(self.model)

    @cached_property
    def inputs(self) -> dict[str, float]:
        """The inputs that all controllers share, at rest, in automatic and without a fault [SI]."""
        at_rest = self.stations[0].numbers.at_rest
        process = self.process
        shared = (
            *loop_inputs(process), *fault_inputs(process), *acknowledging_inputs(process)
        )  # fmt: skip
        return {signal.name: at_rest[signal.name] for signal in shared}

    @cached_property
    def scenario(self) -> Scenario:
        """The default one, of which the integration steps and the noise of the sensors are."""
        return default_scenario(self.model)

    @cached_property
    def noises(self) -> dict[str, float]:
        """Measurement or disturbance to the standard deviation of its noise [SI]."""
        return {each.signal: each.deviation for each in self.scenario.noises}

    @cached_property
    def stations(self) -> list[Station]:
        """One for each controller, all with the same integration steps."""
        loops = [Loop(each, self.model) for each in self.controllers]
        substeps = max(loop.run_checked(self.scenario).substeps for loop in loops)
        every = [*self.controllers, *(each.controller for each in self.free)]
        return [
            Station(Loop(each, self.handled), substeps, self.numbers.get(each.name))
            for each in every
        ]

    @cached_property
    def free(self) -> list[FreeLaw]:
        """The laws that take numbers of a reader's; their stations follow those of the others."""
        return free_laws(self.model)

    @cached_property
    def digest(self) -> str:
        """What tells it from every other: programs, numbers, noise, and where it begins."""
        said: list[object] = [self.noises]
        said += [
            (
                digest(each.program), own.parameters, own.at_rest,
                [(s.state, {n: r.tolist() for n, r in s.rings.items()})
                 for s in (*own.starts.values(), own.cold)],
            )
            for each in self.stations
            for own in [each.numbers]
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(said).encode()).hexdigest()[:16]
