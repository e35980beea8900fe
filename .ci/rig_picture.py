"""Makes docs/rig-page.png with a headless Chromium: the page of a rig, moved over its tags.

A PI controller of this file is the one on the wires: it reads levels and setpoints and writes
pumps, as a PLC does, while an operator steps a setpoint and an instructor stops a pump.
"""

import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, PngImagePlugin
from playwright.sync_api import Page, sync_playwright

import clepsydra as cl
from clepsydra.laboratory.rig import Rig
from clepsydra.rig.assembly import kept_signals, plant_settings
from clepsydra.rig.doors.page.opening import page_door
from clepsydra.rig.running import RigSettings, RunningRig
from clepsydra.rig.tag_table import TagTable
from clepsydra.rig.tags import tags_of

PICTURE = Path(__file__).parents[1] / "docs" / "rig-page.png"
WORDS = "The page of a running rig: a controller on the wires, a setpoint step, a pump that stopped"
SIZE = {"width": 1400, "height": 1180}
SPEED, PORT = 20.0, 8019
#: Of the PI controllers: gain [V/V] and integral time [s].
GAIN, TIME = 2.6, 30.0


@dataclass
class Loop:
    """One PI controller over tags, in its velocity form."""

    table: TagTable
    measured: str
    moved: str
    output: float = 3.0
    before: float = 0.0

    def scan(self, period: float) -> None:
        """Read, compute and write once."""
        read = self.table.read
        tags = self.table.tags
        error = read(tags[f"{self.measured}.sp"]).value - read(tags[f"{self.measured}.pv"]).value
        self.output += GAIN * (error - self.before + period / TIME * error)
        self.output, self.before = min(10.0, max(0.0, self.output)), error
        self.table.write(tags[f"{self.moved}.out"], self.output)


def main() -> None:
    """Run the rig with its controller, do what the picture tells, and take it."""
    plant = cl.load("quadruple-tank")
    bench = Rig(plant.linear, [cl.design.simc(plant)])
    settings = plant_settings(bench, speed=SPEED, fail_safe={})
    tags = tags_of(bench.point)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        door = page_door(bench, settings, tags, folder, speed=SPEED, port=PORT)
        rig = RigSettings(
            title=bench.process.title, plant=settings, tags=tags, process=bench.point.process,
            doors=(door,), folder=folder, kept=kept_signals(bench.point.process, settings),
            speed=SPEED,
        )  # fmt: skip
        with RunningRig(rig) as running, sync_playwright() as playwright:
            ended = threading.Event()
            period = bench.process.sampling_period
            controller = threading.Thread(target=controlled, args=(running.table, period, ended))
            controller.start()
            try:
                browser = playwright.chromium.launch(
                    executable_path="/usr/bin/chromium", args=["--no-sandbox"]
                )
                page = browser.new_page(viewport=SIZE)
                page.goto(door.address)
                operated(page)
                taken(page)
                browser.close()
            finally:
                ended.set()
                controller.join()


def controlled(table: TagTable, period: float, ended: threading.Event) -> None:
    """Scan both loops once a sample, as a PLC would."""
    loops = [Loop(table, f"level_{place}", f"pump_{place}") for place in (1, 2)]
    while not ended.wait(period / SPEED):
        for loop in loops:
            loop.scan(period)


def operated(page: Page) -> None:
    """Step a setpoint, and let a pump stop some minutes later."""
    page.wait_for_timeout(6000)
    setpoint = page.get_by_role("textbox", name="Setpoint of level_1 in V, typed")
    setpoint.fill("7")
    setpoint.press("Enter")
    page.get_by_role("checkbox", name="Noise").check()
    page.wait_for_timeout(15000)
    page.get_by_label("Fault of pump_2").select_option("stopped")
    page.wait_for_timeout(2500)
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")


def taken(page: Page) -> None:
    """Write what the page shows, in few colours."""
    page.screenshot(path=PICTURE)
    described = PngImagePlugin.PngInfo()
    described.add_text("Description", WORDS)
    with Image.open(PICTURE) as picture:
        picture.load()
    picture.convert("P", palette=Image.Palette.ADAPTIVE).save(
        PICTURE, pnginfo=described, optimize=True
    )


if __name__ == "__main__":
    main()
