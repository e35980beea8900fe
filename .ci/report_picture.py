"""Makes docs/report.png and docs/live-report.png with a headless Chromium, from the README's study.

The first is the first screen; the verdict goes into the file as its description, where a test
compares it with the program's. The second are its sliders, two of which were moved.
"""

import tempfile
from pathlib import Path

from PIL import Image, PngImagePlugin
from playwright.sync_api import Page, sync_playwright

import clepsydra as cl

DOCS = Path(__file__).parents[1] / "docs"
SIZE = {"width": 1400, "height": 880}


def main() -> None:
    """Run the study, photograph its report, and describe the pictures."""
    result = cl.study("quadruple-tank")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        report = Path(folder) / "report.html"
        result.report(report)
        browser = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=["--no-sandbox"]
        )
        page = browser.new_page(viewport=SIZE)
        page.goto(report.as_uri())
        taken(page, DOCS / "report.png", result.verdict)
        moved(page)
        taken(page, DOCS / "live-report.png", "Settings tried in the report of a study")
        browser.close()
    print(result.verdict)


def moved(page: Page) -> None:
    """Make the controller bolder, and bring its sliders into view."""
    page.get_by_text("Try other settings", exact=True).last.click()
    panel = page.locator("#live")
    panel.get_by_role("row", name="max|S|").wait_for()
    for slider in panel.get_by_role("slider").all()[:2]:
        slider.focus()
        page.keyboard.press("PageUp")
    page.evaluate("document.activeElement.blur(); document.querySelector('#live').scrollIntoView()")
    page.wait_for_timeout(500)


def taken(page: Page, path: Path, words: str) -> None:
    """Write what the page shows, in few colours."""
    page.wait_for_timeout(500)
    page.screenshot(path=path)
    described = PngImagePlugin.PngInfo()
    described.add_text("Description", words)
    with Image.open(path) as picture:
        picture.load()
    picture.convert("P", palette=Image.Palette.ADAPTIVE).save(
        path, pnginfo=described, optimize=True
    )


if __name__ == "__main__":
    main()
