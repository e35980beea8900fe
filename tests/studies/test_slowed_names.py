"""A method that was slowed down says so wherever its controller is judged."""

import re

import pytest

import clepsydra as cl

STUDY = """process = "three-tanks"
[controllers.fast]
design = "ziegler_nichols"
[controllers.slow]
design = "simc"
closed_loop_time_constant = "300 s"
[scenario]
duration = "1 min"
[[scenario.setpoint]]
signal = "level_3"
at = "10 s"
by = "1 cm"
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("slowed") / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return cl.study(path)


def controllers(result):
    return {each.controller.name: each.controller for each in result.ranking}


def test_its_title_has_the_factor_that_its_gain_was_divided_by(result):
    fast = controllers(result)["fast"]
    (factor,) = re.findall(r"^fast, slowed ([\d.]+) times$", fast.title)
    divided = " ".join(fast.notes)
    assert f"divided by {factor}" in divided
    assert float(factor) == pytest.approx(fast.slowed, rel=5e-3)
    assert fast.slowed > 1.0


def test_what_the_user_asked_for_is_not_slowed(result):
    slow = controllers(result)["slow"]
    assert (slow.title, slow.slowed) == ("slow", 1.0)


@pytest.mark.thorough
def test_table_report_and_json_have_the_title(result, tmp_path):
    title = controllers(result)["fast"].title
    (row,) = (line for line in str(result).splitlines() if line[2:].startswith(" fast "))
    assert f"{float(re.search('[0-9.]+', title)[0]):.3g}×" in row.split()
    result.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text("utf-8")
    assert f'<th scope="row">{title}</th>' in page
    assert re.search(rf"<summary>\d+\. {title}</summary>", page)
    found = {row["controller"]: row for row in result.as_dict()["ranking"]}
    assert found["fast"]["title"] == title
    assert found["fast"]["slowed"] == controllers(result)["fast"].slowed


def test_the_first_line_of_an_export_has_the_title(result, tmp_path):
    fast = controllers(result)["fast"]
    written = cl.export(fast, result.plant, tmp_path, to="c")
    (source,) = (path for path in written.files if path.name == "three_tanks_fast.c")
    about = next(line for line in source.read_text("utf-8").splitlines() if " for Three" in line)
    assert fast.title in about
