"""A method that was slowed down says so wherever its controller is judged."""

import io
import re

import pytest
from rich.console import Console

from clepsydra.deploy.export import export_c
from clepsydra.deploy.exportable import exportable
from clepsydra.report.html import report_text
from clepsydra.report.tables import ranking_table
from clepsydra.studies.file.reader import read_study
from clepsydra.studies.study import run_study

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
    return run_study(read_study(path))


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
def test_table_report_and_json_have_the_title(result):
    title = controllers(result)["fast"].title
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(ranking_table(result))
    assert title in console.export_text()
    assert re.search(rf"<h2>\d+\. {title} ", report_text(result))
    found = {row["controller"]: row for row in result.as_dict()["ranking"]}
    assert found["fast"]["title"] == title
    assert found["fast"]["slowed"] == controllers(result)["fast"].slowed


def test_the_first_line_of_an_export_has_the_title(result):
    fast = controllers(result)["fast"]
    ready = exportable(fast, result.analysis.operating_point)
    source = next(text for name, text in export_c(ready).files.items() if name.endswith(".c"))
    about = next(line for line in source.decode().splitlines() if " for Three" in line)
    assert fast.title in about
    assert ready.program.name == "three_tanks_fast"
