"""What a controller is to a plant: functions between its transmitters and its actuators."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class ControlFunction:
    """A controller, or a relay that computes something between controllers and actuators.

    Parameters
    ----------
    name : str
    sign : str
        Of a relay what it computes: "Σ", "×", "<", ">" or "÷" (a split range); else empty.
    at : str
        The measurement that a controller controls; empty for a relay, and where it has several.
    reads, gives : tuple of str
        Measurements and functions; manipulated variables.
    setpoint : str
        The input of the law by which an operator gives its setpoint; empty where none does.
    """

    name: str
    sign: str
    at: str
    reads: tuple[str, ...]
    gives: tuple[str, ...]
    setpoint: str = ""


def control_functions(controller: Controller) -> tuple[ControlFunction, ...]:
    """Return the functions of a controller, and which signals run between them.

    Of a scheme they are its blocks. Of any other law they follow from its equations: what moves an
    output, in this sample or by way of the state, belongs together; a law in Python is one whole.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> [(f.at, f.gives) for f in control_functions(cl.design.simc(plant))]
    [('level_1', ('pump_1',)), ('level_2', ('pump_2',))]
    >>> [(f.at, len(f.reads), f.gives) for f in control_functions(cl.design.lqi(plant))]
    [('', 4, ('pump_1', 'pump_2'))]
    """
    law = controller.law
    measured = dict(zip(owners(law.inputs, "pv"), controller.measurements, strict=True))
    moved = dict(zip(owners(law.outputs, "out"), controller.manipulated, strict=True))
    if law.blocks:
        return tuple(_of_blocks(law, measured, moved))
    return tuple(_of_equations(controller, measured, moved))


def _of_blocks(
    law: StepLaw, measured: dict[str, str], moved: dict[str, str]
) -> Iterable[ControlFunction]:
    giver = {port: block.name for block in law.blocks for port in block.ports}
    outputs = [block for block in law.blocks if isinstance(block, OutputBlock)]
    before = {block.name: giver[block.source] for block in outputs}
    for block in law.blocks:
        if isinstance(block, OutputBlock):
            continue
        reads, sign = [giver[source] for source in block.sources], "÷"
        if isinstance(block, PidBlock):
            reads, sign = [measured[block.measurement.name], *reads], ""
        elif isinstance(block, FeedforwardBlock):
            reads += [
                measured[term.signal.name] if term.measured else before[term.signal.name]
                for term in block.terms
            ]
            sign = "Σ"
        elif isinstance(block, RatioBlock):
            reads, sign = [measured[block.wild.name], *reads], "×"
        elif isinstance(block, SelectorBlock):
            sign = "<" if block.selection == "low" else ">"
        gives = tuple(moved[each.name] for each in outputs if before[each.name] == block.name)
        at = reads[0] if isinstance(block, PidBlock) else ""
        own = isinstance(block, PidBlock) and not block.inner
        setpoint = block.setpoint if own else ""
        yield ControlFunction(block.name, sign, at, tuple(reads), gives, setpoint)


def _of_equations(
    controller: Controller, measured: dict[str, str], moved: dict[str, str]
) -> Iterable[ControlFunction]:
    law = controller.law
    controlled = dict(zip(owners(law.inputs, "sp"), controller.setpoints, strict=True))
    acts = _dependence(law)
    groups: list[tuple[set[str], set[str], set[str]]] = []
    for output, actuator in moved.items():
        reads = {name for owner, name in measured.items() if acts(f"{owner}.pv", output)}
        aims = {name for owner, name in controlled.items() if acts(f"{owner}.sp", output)}
        gives, aims = {actuator}, aims or reads
        for group in [group for group in groups if group[0] & aims]:
            groups.remove(group)
            aims, reads, gives = aims | group[0], reads | group[1], gives | group[2]
        groups.append((aims, reads, gives))
    for number, (aims, reads, gives) in enumerate(groups, 1):
        yield ControlFunction(
            f"law {number}",
            "",
            next(iter(aims)) if len(aims) == 1 else "",
            tuple(name for name in measured.values() if name in reads),
            tuple(name for name in moved.values() if name in gives),
            next((f"{owner}.sp" for owner, name in controlled.items() if {name} == aims), ""),
        )


def _dependence(law: StepLaw) -> Callable[[str, str], bool]:
    """Return whether an input of a law acts on the value of an output, be it through the state."""
    next_state, from_input = law.depends(0, 0), law.depends(0, 1)
    result, at_once = law.depends(1, 0), law.depends(1, 1)
    reached = from_input
    for _ in law.state:
        reached = reached | (next_state @ reached)
    acts = at_once | (result @ reached)
    rows = {signal.name: place for place, signal in enumerate(law.outputs)}
    columns = {signal.name: place for place, signal in enumerate(law.inputs)}
    return lambda given, output: bool(acts[rows[f"{output}.out"], columns[given]])
