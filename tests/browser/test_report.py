import pytest

pytestmark = pytest.mark.browser
PROCESS = "quadruple-tank"


def test_a_report_opens_offline_at_each_width_light_and_dark(report, opened, look):
    page = opened(report(PROCESS), **look)
    assert page.locator(".verdict").inner_text().startswith("Use ")


def test_the_cursor_reads_both_charts_at_one_time(report, opened):
    page = opened(report(PROCESS))
    charts = page.locator(".uplot")
    assert charts.count() == 2
    charts.first.locator(".u-over").hover()
    first, second = charts.locator(".u-series:first-child .u-value").all_inner_texts()
    # The middle of a run of 71 min.
    assert first == second
    assert 30.0 < float(first) < 41.0


def test_without_script_the_picture_is_still(report, opened):
    page = opened(report(PROCESS), script=False)
    assert page.locator("[data-interactive] svg").is_visible()
    assert page.locator(".uplot").count() == 0
