"""A study as a notebook shows it: its report in a frame of its own."""

import re

import pytest

import clepsydra as cl

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def notebook(built, tmp_path_factory):
    """A page that shows a study as the result of a cell."""
    plant = cl.load("three-tanks")
    shown = cl.study(plant, controllers=[cl.design.simc(plant)])._repr_html_()
    path = tmp_path_factory.mktemp("notebook") / "notebook.html"
    page = f'<!DOCTYPE html><html lang="en"><title>Notebook</title><h1>Cells</h1>{shown}</html>'
    path.write_text(page, encoding="utf-8")
    return path


def test_settings_are_tried_in_a_notebook(notebook, opened):
    from playwright.sync_api import expect

    page = opened(notebook)
    report = page.frame_locator("iframe")
    report.get_by_text("Try other settings", exact=True).last.click()
    panel = report.locator("#live")
    settles = panel.get_by_role("row", name="settles")
    now, recommended = settles.get_by_role("cell").first, settles.get_by_role("cell").last
    settled = recommended.inner_text()
    # The recommended settings run once more, and the page shows dots until they are scored.
    expect(now).to_have_text(settled)
    panel.get_by_role("slider").first.focus()
    page.keyboard.press("PageUp")
    expect(now).to_have_text(re.compile(r"\d"))
    expect(now).not_to_have_text(settled)


def test_a_link_in_a_notebook_leads_to_a_place_of_the_report(notebook, opened):
    page = opened(notebook)
    report = page.frames[1]
    report.click("nav a[href='#ranking']")
    # A function, as the page's policy forbids to evaluate a text once more.
    top = "() => document.querySelector('#ranking').getBoundingClientRect().top"
    report.wait_for_function(f"{top} < 200")
    assert report.title().endswith("control study")


def test_a_report_reaches_nothing_of_its_notebook(notebook, opened):
    page = opened(notebook)
    reached = page.frames[1].evaluate(
        "() => { try { return parent.document.title; } catch (refused) { return refused.name; } }"
    )
    assert reached == "SecurityError"


def test_a_laboratory_runs_in_a_notebook(built, opened, tmp_path):
    from playwright.sync_api import expect

    plant = cl.load("three-tanks")
    shown = cl.lab(plant, cl.design.simc(plant), tmp_path / "lab.html")._repr_html_()
    path = tmp_path / "notebook.html"
    path.write_text(f'<!DOCTYPE html><html lang="en"><title>Cells</title>{shown}</html>', "utf-8")
    lab = opened(path).frame_locator("iframe")
    told = lab.locator(".told")
    before = told.inner_text()
    lab.get_by_role("button", name="One sample").click()
    expect(told).not_to_have_text(before)
    expect(told).to_contain_text("paused")
