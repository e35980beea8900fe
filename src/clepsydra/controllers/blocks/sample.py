"""One sample of a law while it is written, what it reads in it, and the law that is written so."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.validity import all_of, is_number, value_or_zero
from clepsydra.program.block import Block
from clepsydra.program.entries import Entry
from clepsydra.program.equations import Equations, Symbols, function_of
from clepsydra.program.step_law import StepLaw


class Sample:
    """The signals of a law in one sample, and what has been computed of its results so far.

    A law has the parameters and the state that its equations ask for, each declared where it is
    read.

    `symbols`: the signals of the law by their paths; `parameters`, `state`: for what it asks for
    that is not among them, as long as a law is written for the first time.

    Examples
    --------
    >>> same = Block("same", (Signal("pv"), Signal("gain")), (), (Signal("y"),),
    ...              lambda s: Equations({}, {"y": s["gain"] * s["pv"]}))
    >>> sample = Sample({"level.pv": ca.SX(3), "pump.gain": ca.SX(2), "gain": ca.SX(9)})
    >>> sample.call(same, "first", "level", "pump")
    {'y': SX(6)}
    """

    def __init__(
        self,
        symbols: MutableMapping[str, ca.SX],
        parameters: list[Signal] | None = None,
        state: list[Entry] | None = None,
    ) -> None:
        self.symbols = symbols
        self._parameters, self._state = parameters, state
        self.next_state: dict[str, ca.SX] = {}
        self.outputs: dict[str, ca.SX] = {}
        self.named: dict[str, ca.SX] = {}

    def __getitem__(self, name: str) -> ca.SX:
        """Return a signal of the law."""
        return self.symbols[name]

    def parameters(self, *signals: Signal) -> list[ca.SX]:
        """Return parameters of the law."""
        return [self._asked(signal, self._parameters) for signal in signals]

    def memory(self, *entries: Entry) -> list[ca.SX]:
        """Return parts of the state of the law."""
        return [self._asked(entry, self._state) for entry in entries]

    def _asked(self, entry: Entry, declared: list[Any] | None) -> ca.SX:
        if declared is not None and entry.name not in self.symbols:
            declared.append(entry)
            self.symbols[entry.name] = ca.SX.sym(entry.name)
        return self.symbols[entry.name]

    def of(self, owner: Signal | str, *parts: str) -> list[ca.SX]:
        """Return parts of something."""
        return [self[path(owner, part)] for part in parts]

    def call(
        self, block: Block, instance: str, /, *owners: Signal | str, **inputs: ca.SX
    ) -> dict[str, ca.SX]:
        """Call a block, keep its next state, and return its outputs.

        Its state, and inputs that are not given, are that part of the first owner that has it, or
        the signal of the port's own name; what it names belongs to the first owner.
        """
        given = {
            name: inputs[name] if name in inputs else self[self._named(name, owners)]
            for name in (port.name for port in block.inputs)
        }
        names = {entry.name: self._named(entry.name, owners) for entry in block.state}
        found = block(instance, given, {own: self.state(name) for own, name in names.items()})
        self.next_state |= {name: found.next_state[own] for own, name in names.items()}
        self.name(owners[0] if owners else "", found.intermediates)
        return dict(found.outputs)

    def state(self, name: str) -> ca.SX:
        """Return the value of a state that the sample goes on from."""
        return self.symbols[name]

    def name(self, owner: Signal | str, values: Mapping[str, ca.SX]) -> None:
        """Name values on the way, as parts of what they belong to."""
        self.named |= {path(owner, part) if owner else part: v for part, v in values.items()}

    def equations(self) -> Equations:
        """Return what the sample has come to."""
        return Equations(self.next_state, self.outputs, self.named)

    def _named(self, name: str, owners: Iterable[Signal | str]) -> str:
        return next((own for o in owners if (own := path(o, name)) in self.symbols), name)


@dataclass(frozen=True)
class Reading:
    """What a law reads of its measurements and setpoints.

    `measurements`, `setpoints`: by name; zero in the place of what is no number; `known`: whether
    all measurements are numbers from sound sensors; `numbers`, `sensors`: whether measurements and
    setpoints are numbers, and whether the sensors are sound.
    """

    measurements: dict[str, ca.SX]
    setpoints: dict[str, ca.SX]
    known: ca.SX
    numbers: ca.SX
    sensors: ca.SX

    @classmethod
    def of(cls, sample: Sample, measured: Iterable[str], controlled: Iterable[str]) -> Reading:
        """Read the measurements, and the setpoints of those that are controlled."""
        shown, measurements = _read(sample, measured, "pv")
        given, setpoints = _read(sample, controlled, "sp")
        sensors = all_of([sample[path(y, "good")] for y in measured])
        known = ca.logic_and(all_of(shown), sensors)
        return cls(measurements, setpoints, known, all_of([*shown, *given]), sensors)


def _read(sample: Sample, owners: Iterable[str], part: str) -> tuple[list[ca.SX], dict[str, ca.SX]]:
    """Return which of some signals are numbers, and their values or zero."""
    raw = {owner: sample[path(owner, part)] for owner in owners}
    valid = {owner: is_number(value) for owner, value in raw.items()}
    return [*valid.values()], {
        owner: value_or_zero(value, valid[owner]) for owner, value in raw.items()
    }


def inner_equations(law: StepLaw, symbols: Symbols) -> Equations:
    """Return what a law computes; the calls of its blocks are calls of the law around it.

    `symbols`: its state, inputs and parameters by name, among others.

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


def control_law(
    name: str,
    equations: Callable[[Sample], None],
    *,
    measured: Sequence[Signal],
    controlled: Sequence[Signal],
    manipulated: Sequence[Signal],
    description: tuple[str, ...] = (),
) -> StepLaw:
    """Write the step law of a control system.

    `name`: an identifier; `equations`: writes one `Sample`; `measured`, `controlled`,
    `manipulated`: the process signals, for sp of each controlled one, pv and good of each measured
    one, mode, manual, tracking, out and status of each manipulated one, and time_step.
    """
    inputs = (
        *signals.setpoint_inputs(controlled),
        *signals.measurement_inputs(measured),
        *signals.output_inputs(manipulated),
    )
    outputs = signals.output_results(manipulated)
    return written_law(name, equations, inputs, outputs, description)


def written_law(
    name: str,
    equations: Callable[[Sample], None],
    inputs: tuple[Signal, ...],
    outputs: tuple[Signal, ...],
    description: tuple[str, ...] = (),
    blocks: Sequence[Any] = (),
) -> StepLaw:
    """Write a step law, whose parameters and state are those that its equations ask for.

    `name`: an identifier; `equations`: writes one `Sample`; `blocks`: as in `StepLaw`.
    """
    parameters: list[Signal] = []
    state: list[Entry] = []

    def written(symbols: dict[str, ca.SX]) -> Equations:
        sample = Sample(symbols, parameters, state)
        equations(sample)
        return sample.equations()

    function, found = function_of(name, (state, inputs, parameters), outputs, written)
    named = tuple(map(Signal, found.intermediates))
    every = (inputs, tuple(parameters), tuple(state), outputs, named)
    return StepLaw(name, *every, function, description, tuple(blocks), written)
