"""The alarms of a process made ready for a plant: a block beside the controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from clepsydra.base.words import listed
from clepsydra.controllers.alarms.law import INTERLOCK, alarm_controller
from clepsydra.controllers.blocks.ports import GOOD
from clepsydra.controllers.plant_shell.edge import in_shown_units
from clepsydra.deploy.exportable import Exportable, described, exportable_name
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.tagged import TaggedLaw
from clepsydra.deploy.target import Delivery, ExportedFiles, Options, Target
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.program.program import Program


@dataclass(frozen=True)
class AlarmDelivery(Delivery):
    """The alarms of a process that are to be exported beside a controller, without a shell."""

    @cached_property
    def ready(self) -> Exportable:
        """The alarms with names and sources."""
        return exportable_alarms(self.point)


def exportable_alarms(point: OperatingPoint) -> Exportable:
    """Return the alarms of a process as a program that every target is printed from.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import clepsydra as cl
    >>> from clepsydra.process.alarm import Alarm, AlarmKind
    >>> point = cl.load("quadruple-tank").point
    >>> alarms = (Alarm("level_1", AlarmKind.HIGH, 8.0),)
    >>> ready = exportable_alarms(replace(point, process=replace(point.process, alarms=alarms)))
    >>> ready.program.name, [signal.name for signal in ready.program.outputs]
    ('quadruple_tank_alarms', ['level_1.high.active', 'level_1.watched'])
    """
    process = point.process
    controller = alarm_controller(process)
    name = exportable_name(process, controller)
    at_edge = in_shown_units(controller)
    tagged = TaggedLaw(at_edge, process)
    origin = Origin(
        subject="Alarms and interlocks",
        process=described(process),
        design=controller.design,
        sampling_period=process.sampling_period,
        sources={entry.name: "at a cold start" for entry in controller.program().state},
        default_source="process file",
    )
    return Exportable(
        at_edge,
        point,
        tagged.program(_unwired(at_edge.program(), name)),
        tagged.program(_unwired(controller.program(), name)),
        origin,
    )


def _unwired(program: Program, name: str) -> Program:
    """Return alarms that look at nothing until their sensors are wired, and say so."""
    inputs = (replace(s, initial=0.0) if s.part == GOOD.name else s for s in program.inputs)
    return replace(program, name=name, inputs=tuple(inputs))


def with_alarms(
    exported: Sequence[ExportedFiles], targets: Sequence[tuple[Target, Options]], beside: Delivery
) -> list[ExportedFiles]:
    """Return exports with the files of the alarms of the process, and how these are wired.

    Parameters
    ----------
    exported : sequence of ExportedFiles
        Of a controller, by each of the targets.
    targets : sequence
        Of an export, each with its options.
    beside : Delivery
        Of the controller.
    """
    alarms = AlarmDelivery(beside.controller, beside.point, beside.scenario)
    ready, found = alarms.ready, []
    held = [signal for signal in ready.program.outputs if signal.part == INTERLOCK]
    step = f"Call {ready.program.name} before the controller, in the same task"
    if held:
        step += f", and give its {listed([each.identifier for each in held])} to the controller"
    said: tuple[str, ...] = (f"{step}.",)
    for each, (target, options) in zip(exported, targets, strict=True):
        if not target.shelled:  # settings of vendors' blocks
            found.append(each)
            continue
        files = {**each.files, **target.controller(alarms, options).files}
        found.append(replace(each, files=files, then=(*each.then, *said)))
        said = ()  # whatever it is printed as, it is called in the same way
    return found


def alarm_items(point: OperatingPoint) -> list[ProofItem]:
    """Return the item of the alarms of a process; none where it has none."""
    if not point.process.alarms:
        return []
    ready = exportable_alarms(point)
    return [
        ProofItem(
            f"Alarms of {point.process.title}",
            point.process.sampling_period,
            ready.program,
            origin=ready.origin,
            program_in_si=ready.program_in_si,
        )
    ]
