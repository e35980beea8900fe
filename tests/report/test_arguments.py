"""A report that is given no file name says so, and writes nothing."""

import pytest
from refusals import refused


@pytest.mark.parametrize("path", [None, 3, b"report.html"])
def test_a_report_needs_a_file_name(path, result):
    with refused(place="report, path", expected="a file name"):
        result.report(path)


def test_a_report_is_written_to_a_name_given_as_text(result, tmp_path):
    result.report(str(tmp_path / "report.html"))
    assert (tmp_path / "report.html").read_text("utf-8").startswith("<!DOCTYPE html>")
