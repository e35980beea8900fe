"""Section 5's last advice: the exported controllers behind a PLC's cards, scan by scan.

In real time, in soft PLCs and on real wires, that is `clepsydra hil averaging-tank`; here no clock
runs, so that everything is the same every time and takes seconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from clepsydra.base.signal import path
from clepsydra.deploy.exportable import Exportable, exportable
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.hil.ideal import ideal_run
from clepsydra.hil.wire_check import Through, as_it_is
from clepsydra.hil.wiring import wiring_of
from clepsydra.laboratory.rig import Station
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.closed_loop import TRUE
from clepsydra.loop.loop import Loop
from clepsydra.papers.averaging_tank.operating_range import CYCLE
from clepsydra.papers.averaging_tank.range_controllers import controller_of
from clepsydra.papers.averaging_tank.step_run import MEASURED, STEPS, model_of
from clepsydra.papers.averaging_tank.symbols import Variant, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.plant import PlantSettings, RigPlant
from clepsydra.rig.tag import Tag
from clepsydra.rig.tags import tags_of

#: The step of the document's tables, until it has settled [s].
_HORIZON = 10.0
_LAWS = ("PI", "LQI")
_CONSTANT: Variant = "outflow"
#: Of a rig whose controller writes in every sample.
_SILENCE = 1.0


def run() -> Found:
    """Return a picture of what the cards change; the advice is no claim and has no row."""
    panels = []
    for output, (name, factor) in MEASURED.items():
        away = {}
        for law in _LAWS:
            cards = scanned(law, counted)
            change = cards.true[name] - cards.simulated[name]
            away[f"{law} by hand"] = 100.0 * change / (factor * STEPS[output])
        time = CYCLE * np.arange(len(change))
        panels.append(Panel(output, f"change of {output} [% of its step]", curves(time, away)))
    return (
        Figure(
            "", f"What cards of 27648 counts change, {constant_flow(_CONSTANT)}", panels,
            "Without cards nothing changes, to the last bit.",
        ),
    )  # fmt: skip


def counted(tag: Tag, value: float) -> float:
    """Return a value [SI] as a card of 27648 counts over its range passes it on [SI]."""
    if tag.signal.kind != "real":
        return value
    card = Encoding.COUNTS_27648
    return tag.in_cell(card.decode(card.encode(tag.on_wire(value), tag), tag))


@dataclass(frozen=True)
class Scanned:
    """A run scan by scan, and its simulation [SI]."""

    true: Mapping[str, np.ndarray]  # measurement, without its sensor
    simulated: Mapping[str, np.ndarray]

    def largest(self, name: str) -> float:
        """Return how far a measurement goes from the simulation [SI]."""
        return float(np.max(np.abs(self.true[name] - self.simulated[name])))


@cache
def _rig(law: str) -> tuple[PlantSettings, Exportable]:
    """Return the plant of a rig, and what is exported for it."""
    model = model_of(_CONSTANT, CYCLE, high=True)
    controller, point = controller_of(_CONSTANT, law, CYCLE), operating_point_of(model)
    loop, safe = Loop(controller, model), {u.name: u.low for u in point.process.inputs}
    settings = PlantSettings(Station(loop, loop.substeps), {}, safe, _SILENCE)
    return settings, exportable(controller, point)


@cache
def scanned(law: str, through: Through = as_it_is) -> Scanned:
    """Let an exported controller drive the plant of a rig, as a PLC that is never late."""
    samples = round(_HORIZON / CYCLE) + 1
    settings, ready = _rig(law)
    tags = {tag.name: tag for tag in tags_of(settings.station.loop.point)}
    wiring = wiring_of(ready, tags.values())
    plc = SteppedKernel(Kernel(ready.program_in_si, fuse=False))
    true: dict[str, list[float]] = {name: [] for name, _ in MEASURED.values()}
    with TemporaryDirectory() as folder:
        image = ProcessImage(Path(folder, "image"), settings.layout, new=True)
        plant = RigPlant(settings, image)
        plant.tell(0.0)
        targets = {}
        for output, (name, factor) in MEASURED.items():
            cell = tags[path(name, "sp")].cell
            target = image.read(cell) + factor * STEPS[output]
            image.write(cell, target)
            targets[cell] = np.full(samples, target)
        for sample in range(samples):
            given = {"time_step": CYCLE, "start": 0.0 if sample else 2.0}
            for port, name in wiring.reads.items():
                given[port] = through(tags[name], image.read(tags[name].cell))
            found = plc.step(given)
            for port, name in wiring.writes.items():
                image.write(tags[name].cell, through(tags[name], found[port]))
            for name, column in true.items():
                column.append(image.read(path(name, TRUE)))
            plant.step(heard=True, time=sample * CYCLE)
    if through is not as_it_is:
        # Of the same plant and setpoints, without cards.
        simulated = scanned(law).simulated
    else:
        ideal = ideal_run(settings, ready, samples, targets)
        simulated = {name: ideal[path(name, TRUE)] for name in true}
    return Scanned({name: np.array(column) for name, column in true.items()}, simulated)
