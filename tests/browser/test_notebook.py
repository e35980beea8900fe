"""A study as a notebook shows it: its report in a frame of its own."""

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
    settles.wait_for()
    now, recommended = settles.get_by_role("cell").all_inner_texts()
    assert now == recommended
    panel.get_by_role("slider").first.focus()
    page.keyboard.press("PageUp")
    expect(settles.get_by_role("cell").first).not_to_have_text(now)


def test_a_link_in_a_notebook_leads_to_a_place_of_the_report(notebook, opened):
    page = opened(notebook)
    report = page.frames[1]
    report.click("nav a[href='#ranking']")
    report.wait_for_function("document.querySelector('#ranking').getBoundingClientRect().top < 200")
    assert report.title().endswith("control study")


def test_a_report_reaches_nothing_of_its_notebook(notebook, opened):
    page = opened(notebook)
    reached = page.frames[1].evaluate(
        "() => { try { return parent.document.title; } catch (refused) { return refused.name; } }"
    )
    assert reached == "SecurityError"
