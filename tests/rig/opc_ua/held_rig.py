"""A door of OPC UA whose plant is in the hand of a test: it shows what it is told to show."""

import asyncio
import threading
from contextlib import contextmanager

import numpy as np
from waiting import wait_until

from clepsydra.base.signal import Signal
from clepsydra.rig.doors.opc_ua.door import OpcUaDoor
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.report import Kind, Reporter
from clepsydra.rig.tag import WIRE_CUT, WIRE_DELAY, WIRE_LOSS, Tag, Writer
from clepsydra.rig.tag_table import WRITES, TagTable

PLANT, CONTROLLER, OPERATOR = Writer


def _tag(name, writer, unit="1", low=0.0, high=1.0, kind="real", judged_by="", cell=""):
    signal = Signal(name, unit, low=low, high=high, kind=kind, description=f"words of {name}")
    label = name.replace(".", "_").upper()
    return Tag(name, label, signal, writer, cell or name, unit, judged_by)


TAGS = (
    _tag("level.pv", PLANT, "cm", 0.0, 100.0, judged_by="level.good"),
    _tag("flow.pv", PLANT, "m^3/h", 0.0, np.inf),
    _tag("level.good", PLANT, kind="boolean"),
    _tag("plant.watchdog", PLANT, high=65535.0, kind="integer"),
    _tag("pump.out", CONTROLLER, "%", 0.0, 100.0),
    _tag("pump.status", CONTROLLER, high=65535.0, kind="integer"),
    _tag("pump.bits", CONTROLLER, high=524287.0, kind="integer"),
    _tag("level.sp", OPERATOR, "cm", 0.0, 100.0),
    _tag("operator.remote", OPERATOR, kind="boolean"),
)


KNOWN_LEVEL = TAGS[0]


class HeldRig:
    """The rig with its door at an address."""

    def __init__(self, folder, tags=TAGS):
        self.folder, self.tags = folder, tags
        published = tuple(tag.cell for tag in tags if tag.writer is PLANT)
        wires = (WRITES, WIRE_CUT, WIRE_DELAY, WIRE_LOSS)
        written = (*(tag.cell for tag in tags if tag.writer is not PLANT), *wires)
        self.image = ProcessImage(folder / "image", ImageLayout(published, written, 1), new=True)
        self.table = TagTable(tags, self.image)
        self.shown = dict.fromkeys(published, 0.0) | {"level.good": 1.0}
        self.shown = {name: self.shown[name] for name in published}
        self.sample, self.time, self.address, self.reports = 0, 1.8e9, "", []

    def show(self, **values):
        """Let the plant show values, and go on by a sample."""
        self.shown |= {name.replace("__", "."): value for name, value in values.items()}
        self.image.publish(self.sample, self.time, np.array([*self.shown.values()]))
        self.sample, self.time = self.sample + 1, self.time + 1.0

    @property
    def certificates(self):
        return self.folder / "certificates"

    def words(self):
        return [report.words for report in self.reports if report.kind is Kind.EVENT]


@contextmanager
def held_rig(folder, tags=TAGS, **options):
    """Serve a rig in a thread of its own, until the block ends."""
    rig = HeldRig(folder, tags)
    door = OpcUaDoor(rig.certificates, tags, **{"port": 0} | options)
    door.check()
    loop, ended = asyncio.new_event_loop(), []

    def work():
        asyncio.set_event_loop(loop)
        task = loop.create_task(door.serve(rig.table, Reporter(door.title, rig.reports.append)))
        ended.append(task)
        try:
            loop.run_until_complete(task)
        except asyncio.CancelledError:
            loop.run_until_complete(loop.shutdown_asyncgens())
        finally:
            loop.close()

    def begun():
        rig.address = next((r.words for r in rig.reports if r.kind is Kind.READY), "")
        return bool(rig.address) or not thread.is_alive()

    thread = threading.Thread(target=work)
    thread.start()
    wait_until(begun)
    assert rig.address
    try:
        yield rig
    finally:
        loop.call_soon_threadsafe(ended[0].cancel)
        thread.join()
