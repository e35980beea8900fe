"""A laboratory in a browser, in the hands of a test: `Hand(opened(page, first=KEPT))`."""

import json
import re

#: What is saved is kept beside, as a page without downloads has no file.
KEPT = """
window.saved = [];
const before = URL.createObjectURL;
URL.createObjectURL = (file) => (saved.push(file.text()), before(file));
"""
#: Pauses once the time that is told is later than so many minutes. A click from outside would
#: come when the machine has time for it, and the plant would have run on for as long.
PAUSED_AFTER = """least => new Promise(done => {
    const units = { s: 1 / 60, min: 1, h: 60, d: 1440 };
    const look = () => {
        const [number, unit] = document.querySelector(".told").textContent.split(/[ ,]/);
        if (number * units[unit] <= least) return requestAnimationFrame(look);
        document.querySelector(".go").click();
        done();
    };
    look();
})"""


class Hand:
    """Who has the laboratory open."""

    def __init__(self, page):
        self.page = page
        self.begun()

    def begun(self):
        """Wait until the rig runs: before, the page has its drawings, with nothing in them."""
        self.page.locator(".told").wait_for()

    def reload(self):
        self.page.reload()
        self.begun()

    def press(self, name):
        self.page.get_by_role("button", name=name, exact=True).click()

    def choose(self, what, option):
        self.page.get_by_label(what).select_option(option)

    def type(self, what, number, unit="V"):
        field = self.page.get_by_role("textbox", name=f"{what} in {unit}, typed")
        field.fill(number)
        field.press("Enter")

    def mode(self, name, mode):
        self.page.get_by_role("group", name=f"Mode of {name}").get_by_role(
            "button", name=mode
        ).click()

    def number(self, name):
        """Return what a faceplate tells of a signal."""
        row = self.page.locator(".signal", has=self.page.get_by_text(name, exact=True))
        return float(row.locator(".number").inner_text().split()[0])

    def water(self, tank):
        """Return how far the water of a tank stands above its floor [px]."""
        shift = self.page.locator(f'figure:visible [data-level="{tank}.level"]')
        return -float(re.search(r" (-?[\d.]+)\)", shift.get_attribute("transform"))[1])

    def time(self):
        """Return the time of the plant that is told [s]."""
        number, unit = self.page.locator(".told").inner_text().split(",")[0].split()
        return float(number) * {"s": 1, "min": 60, "h": 3600, "d": 86400}[unit]

    def run(self, minutes, speed="as fast as it goes"):
        """Let so much time pass in the plant, and what more has passed when that is told."""
        end = self.time() / 60 + minutes
        self.choose("Speed", speed)
        self.press("Run")
        self.page.evaluate(PAUSED_AFTER, end)

    def session(self):
        self.press("Save session")
        return json.loads(self.page.evaluate("saved.pop()"))
