"""A controller made ready for a plant: in its shell, with a name, and with its origin."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.rounding import rounded
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.edge import at_port, in_shown_units
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import shell_sources, with_plant_shell
from clepsydra.controllers.plant_shell.status import FAIL_SAFE
from clepsydra.controllers.signals import owners
from clepsydra.deploy.printing.heading import digest, written_with
from clepsydra.deploy.printing.identifiers import identifier_of
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.tagged import TaggedLaw
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.alarm import interlocks
from clepsydra.process.process import Process
from clepsydra.program.defaults import with_defaults
from clepsydra.program.program import Program

#: Of the value that a setpoint has until it is given: what people write stays as it is.
_SETPOINT_DIGITS = 9


@dataclass(frozen=True, eq=False)
class Exportable:
    """A controller in its plant shell, and the program that every target is printed from.

    Parameters
    ----------
    controller : Controller
        In its shell, with ports in the units that the process file shows.
    point : OperatingPoint
        Where the process rests with the controller's initial state.
    program : Program
        Of this controller, with the tags of the process in its names.
    program_in_si : Program
        With ports in SI, for who converts by himself: the importer of an FMU.
    origin : Origin

    Examples
    --------
    See `exportable`.
    """

    controller: Controller
    point: OperatingPoint
    program: Program
    program_in_si: Program
    origin: Origin

    @property
    def process(self) -> Process:
        """The process that the controller was designed for."""
        return self.point.process

    @property
    def facts(self) -> dict[str, Any]:
        """What tells which program was exported."""
        return {
            "name": self.program.name,
            "digest": digest(self.program),
            "written_with": written_with(),
            "controller": self.controller.name,
            "process": self.process.address,
            "sampling_period": self.process.sampling_period,
        }

    @property
    def wires(self) -> dict[str, str]:
        """Signals of the program to those of the process's own export, and of a loop."""
        return TaggedLaw(self.controller, self.process).wires


def exportable(
    controller: Controller, point: OperatingPoint, settings: PlantShell | None = None
) -> Exportable:
    """Put a controller into its plant shell, name it, and say where its numbers come from.

    Parameters
    ----------
    controller : Controller
        As it was designed or tuned, without a shell.
    point : OperatingPoint
        Where it starts.
    settings : PlantShell, optional
        Ranges, delays, rates and fail-safe outputs other than the usual ones.

    Raises
    ------
    InputError
        The law is a Python function, so that there is nothing to print, or a setting is wrong.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> ready = exportable(cl.design.simc(plant), plant.point)
    >>> ready.program.name, ready.origin.source_of(ready.program.parameters[0])
    ('quadruple_tank_pi_simc', 'PI, SIMC')
    """
    process = point.process
    held = {n: v for n, v in interlocks(process.alarms).items() if n in controller.manipulated}
    settings = replace(settings or PlantShell(), interlock=held)
    shelled = with_plant_shell(controller, process.sampling_period, settings)
    in_si = replace(_at_rest(shelled, point), name=exportable_name(process, controller))
    at_edge = in_shown_units(shelled)
    tagged = TaggedLaw(at_edge, process)
    program = replace(
        at_edge.program(),
        name=in_si.name,
        inputs=tuple(_as_written(at_port(signal)) for signal in in_si.inputs),
        outputs=tuple(at_port(_before_first_call(s, shelled)) for s in in_si.outputs),
    )
    sources = _sources(controller, program) | shell_sources(shelled)
    origin = Origin(
        subject=controller.title,
        process=described(process),
        design=controller.design,
        sampling_period=process.sampling_period,
        sources={tagged.name(name): source for name, source in sources.items()},
        default_source=controller.name,
    )
    return Exportable(at_edge, point, tagged.program(program), tagged.program(in_si), origin)


def exportable_name(process: Process, controller: Controller) -> str:
    """Return what blocks and files of a controller are called.

    Examples
    --------
    See `exportable`.
    """
    identifier_of(controller.name)  # refuses a name of which nothing would be left
    return identifier_of(f"{process.file_stem} {controller.name}")


def described(process: Process) -> str:
    """Return title and file of a process, for the head of a printed text.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> described(load_process("quadruple-tank"))
    'Quadruple tank, minimum phase (quadruple-tank of the catalogue)'
    """
    variant = f", variant {', '.join(process.variant)}" if process.variant else ""
    file = process.path.name if process.path else f"{process.name} of the catalogue"
    return f"{process.title} ({file}{variant})"


def process_origin(point: OperatingPoint) -> Origin:
    """Return where the numbers of a printed process come from.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process_origin(find_equilibrium(load_process("quadruple-tank"))).default_source
    'process file'
    """
    process = point.process
    return Origin(
        "The process", described(process), "", process.sampling_period, {}, "process file"
    )


def _at_rest(controller: Controller, point: OperatingPoint) -> Program:
    """Return the program whose setpoints and outputs start where the process rests."""
    program = controller.program()
    at = point.as_dict()
    wires = controller.input_wires
    setpoints = {
        signal.name: at[Signal(wires[signal.name]).owner]
        for signal in program.inputs
        if signal.part == "sp" and signal.name not in controller.free_inputs
    }
    begins = controller.initial_state
    outputs = tuple(
        replace(signal, initial=begins.get(path(signal.owner, "last_output"), signal.initial))
        if signal.part == "out"
        else signal
        for signal in program.outputs
    )
    started = with_defaults(program, setpoints)
    return replace(started, inputs=tuple(map(_as_written, started.inputs)), outputs=outputs)


def _before_first_call(signal: Signal, shelled: Controller) -> Signal:
    """Return an output that stands at its fail-safe value until the block is called."""
    if signal.part != "out":
        return signal
    return replace(signal, initial=shelled.values[path(signal.owner, FAIL_SAFE.name)])


def _as_written(signal: Signal) -> Signal:
    """Return a setpoint with digits that people write; unlike a state it is only a default."""
    if signal.part != "sp":
        return signal
    return replace(signal, initial=rounded(signal.initial, _SETPOINT_DIGITS))


def _sources(controller: Controller, program: Program) -> dict[str, str]:
    """Return where the numbers come from that no designer chose."""
    sources = {entry.name: "at a cold start" for entry in program.state}
    sources |= dict.fromkeys(controller.initial_state, "at the operating point")
    outputs = owners(controller.law.outputs, "out")
    for output, name in zip(outputs, controller.manipulated, strict=True):
        for end in ("low", "high"):
            sources[path(output, f"{end}_limit")] = f"range of {name} in the process file"
    return sources
