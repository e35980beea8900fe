"""The work of a browser while a slider of a report moves, in its worker and beside it."""

from __future__ import annotations

import shutil
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.measure import Spread

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome")
#: Writes down what the worker says.
_HEARD = """
const Plain = Worker;
window.said = [];
window.Worker = class extends Plain {
    constructor(...given) {
        super(...given);
        this.addEventListener("message", ({ data }) => said.push(
            { kind: data.kind, run: data.run, whole: data.whole, took: data.milliseconds }));
    }
};
"""
_RAN = "said.filter(each => each.kind === 'ran' && each.whole).length"
_DRAWN = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
#: Margins come after the curves, and are counted apart.
_QUIET = "new Promise(done => setTimeout(done, 400))"
#: Moves there and back before it counts, in which a browser compiles what it meets often.
_WARM = 3


@dataclass(frozen=True)
class Drags:
    """What the drags of one report took.

    Parameters
    ----------
    name : str
        Of the process.
    controller : str
    samples : int
        Of the scenario.
    worker, beside : Spread
        Work for the whole scenario in the worker, and on the page's own thread [ms].
    size : int
        Of the report [B].
    """

    name: str
    controller: str
    samples: int
    worker: Spread
    beside: Spread
    size: int


def processes() -> list[str]:
    """Return the processes of the catalogue, and those of docs/examples."""
    import clepsydra as cl

    files = (path for path in sorted(EXAMPLES.glob("*.toml")))
    return [*(each.name for each in cl.catalogue()), *map(str, files)]


def measure(rounds: int, folder: Path, tell: Callable[[str], None]) -> list[Drags]:
    """Drag a slider of the report of each process, alone.

    Raises
    ------
    RuntimeError
        There is no Chromium.
    """
    import clepsydra as cl

    found = []
    for process in processes():
        name = Path(process).stem
        tell(f"drags, {name}")
        result = cl.study(process)
        report = folder / f"{name}.html"
        result.report(report)
        dragged = _dragged(report, rounds)
        if dragged is not None:
            controller, times, beside = dragged
            spreads = Spread.of(times), Spread.of(beside)
            size = report.stat().st_size
            found.append(Drags(name, controller, result.scenario.samples, *spreads, size))
    return found


def _dragged(report: Path, rounds: int) -> tuple[str, list[float], list[float]] | None:
    """Return the controller, and for each move of a slider what both threads took [ms]."""
    from playwright.sync_api import sync_playwright

    path = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if path is None:
        raise RuntimeError(f"none of {', '.join(_BROWSERS)} is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.add_init_script(_HEARD)
        page.goto(report.as_uri())
        if not page.locator("#live").count():
            return None
        page.get_by_text("Try other settings", exact=True).last.click()
        panel = page.locator("#live")
        panel.get_by_role("row", name="max|S|").wait_for()
        panel.get_by_role("slider").first.focus()
        cost = _Cost(page)
        for key in ("ArrowRight", "ArrowLeft") * _WARM:
            _moved(page, cost, key)
        beside = [_moved(page, cost, "ArrowRight" if k % 2 else "ArrowLeft") for k in range(rounds)]
        took = page.evaluate("said.filter(each => each.kind === 'ran' && each.whole)"
                             ".map(each => each.took)")  # fmt: skip
        said = panel.locator(".choice label, .choice p").first.inner_text().splitlines()[0]
        name = said.removesuffix(" recommended")
        browser.close()
    return name, took[-rounds:], beside


def _moved(page: Any, cost: _Cost, key: str) -> float:
    """Press a key on a slider, and return what the page's own thread did for it [ms]."""
    before, ran = cost.so_far(), page.evaluate(_RAN)
    page.keyboard.press(key)
    # As a function: the page's policy lets no text be evaluated in it.
    page.wait_for_function(f"before => {_RAN} > before", arg=ran)
    page.evaluate(_DRAWN)
    took = cost.so_far() - before
    page.evaluate(_QUIET)
    return took


class _Cost:
    """What the thread of a page has computed since it was opened."""

    def __init__(self, page: Any) -> None:
        self._session = page.context.new_cdp_session(page)
        self._session.send("Performance.enable")

    def so_far(self) -> float:
        """Return it [ms]; scripts, layout and styles, without what the browser does beside."""
        told: Sequence[dict[str, Any]] = self._session.send("Performance.getMetrics")["metrics"]
        named = {each["name"]: each["value"] for each in told}
        parts = ("ScriptDuration", "LayoutDuration", "RecalcStyleDuration")
        return 1e3 * sum(named[part] for part in parts)


def median_of(found: Sequence[Drags]) -> float:
    """Return the median over the reports of the work from slider to curves [ms]."""
    return statistics.median(each.worker.median + each.beside.median for each in found)
