"""A rig and a PLC on its tags, both gone through scan by scan without a clock."""

import asyncio
from collections.abc import Iterable, Mapping
from pathlib import Path

from rig_bench import Bench
from table_bus import BusFault, TableBus

import clepsydra as cl
from clepsydra.deploy.exportable import exportable
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.scanner import Scanner
from clepsydra.hil.wiring import wiring_of


def ready_of(name, design="simc"):
    """A controller of a process, as it is exported."""
    plant = cl.load(name)
    return exportable(getattr(cl.design, design)(plant), plant.point)


READY = ready_of("quadruple-tank")
#: Counts of a card.
COUNTS = 27648


class PlcBench(Bench):
    """Before each sample of the plant the PLC scans."""

    def __init__(
        self, image, folder: Path, bus=TableBus, *, start=2, ready=READY, name="quadruple-tank"
    ) -> None:
        super().__init__(folder, name)
        self.ready = ready
        self.tags = tuple(self.table.tags.values())
        self.bus = bus(self.path, self.settings.layout, self.tags)
        self.wiring = wiring_of(ready, self.tags)
        self.log = ScanLog(tuple(image.inputs), image.outputs)
        self.rows = PlantRows(self.settings.layout)
        self.scanner = Scanner(image, self.wiring, self.bus)
        self._start, self._power = start, 1
        asyncio.run(self.bus.open())

    def scan(self, scans=1, time_step=1.0) -> dict[str, float]:
        """Scan, and step the plant, some times; returns the outputs of the last scan."""
        for _ in range(scans):
            scan = asyncio.run(self.scanner.scan(time_step, self._start))
            self.log.add(scan, began=0.0, lateness=0.0, took=0.0, power=self._power)
            self._start = self._power = 0
            self.step()
        self.rows.take(self.image)
        return dict(zip(self.log.outputs, scan.found, strict=True))

    def power_cycle(self, *, retained: bool) -> None:
        self.scanner.controller.power_cycle(retained=retained)
        self._start, self._power = 1, 2 if retained else 1

    def instruct(self, cell: str, value: float) -> None:
        """What no wire writes [SI]."""
        self.image.write(cell, value)


class FailingBus(TableBus):
    """A bus that does not answer while `fails` is set."""

    fails = False

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        self._check()
        return await super().read(names)

    async def write(self, values: Mapping[str, float]) -> None:
        self._check()
        await super().write(values)

    def _check(self) -> None:
        if self.fails:
            raise BusFault("process image", "", "the cable is pulled", answered=False)


class CardBus(TableBus):
    """A bus that rounds measured values and outputs to the counts of a card."""

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        return {name: self._rounded(name, x) for name, x in (await super().read(names)).items()}

    async def write(self, values: Mapping[str, float]) -> None:
        await super().write({name: self._rounded(name, x) for name, x in values.items()})

    def _rounded(self, name: str, value: float) -> float:
        tag = next(each for each in self.tags if each.name == name)
        return through_a_card(tag, value) if tag.signal.kind == "real" else value


def through_a_card(tag, value: float) -> float:
    """A value as a card of 27648 counts over its range shows it."""
    return round((value - tag.signal.low) / tag.signal.span * COUNTS) / COUNTS * tag.signal.span
