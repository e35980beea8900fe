"""What is no run and no study is refused in words, with the way to get one."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.report.html import write_report
from clepsydra.report.trends import plot


def test_a_study_is_no_run_and_the_message_says_where_its_runs_are(result):
    with pytest.raises(InputError) as refusal:
        plot(result)
    assert str(refusal.value) == (
        "plot: got 'a Study', expected a Run or a Simulation; give result.ranking[0].run."
    )
    with refused(remedy="no controller of it has a run"):
        plot(replace(result, ranking=()))
    with refused(remedy="give candidate.run"):
        plot(result.ranking[0])


@pytest.mark.parametrize("value", [None, 3, "quadruple-tank", np.zeros(5), {}])
def test_what_is_nothing_of_the_kind_is_refused(value, result, tmp_path):
    with refused(remedy="Loop(controller, model)"):
        plot(value)
    with refused(remedy="give what run_study returned"):
        write_report(value, tmp_path / "report.html")
    assert list(tmp_path.iterdir()) == []


def test_a_run_is_no_study(run, tmp_path):
    with refused(value="a Run", expected="a StudyResult"):
        write_report(run, tmp_path / "report.html")


@pytest.mark.parametrize("path", [None, 3, b"report.html"])
def test_a_report_needs_a_file_name(path, result):
    with refused(place="report, path", expected="a file name"):
        write_report(result, path)


def test_a_report_is_written_to_a_name_given_as_text(result, tmp_path):
    write_report(result, str(tmp_path / "report.html"))
    assert (tmp_path / "report.html").read_text("utf-8").startswith("<!DOCTYPE html>")
