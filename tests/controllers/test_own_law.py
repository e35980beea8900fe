"""A file that cannot be loaded as a law is named with the line at fault."""

import pytest
from refusals import refused

from clepsydra import InputError, load_law


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (b"a = 1\n\ndef step(state, inputs)\n", 3, "SyntaxError: expected ':'"),
        (b"a = 1\ndef step(s, i, p, t):\nreturn {}, {}\n", 3, "IndentationError"),
        (b"a = (1,\n", 1, "SyntaxError: '(' was never closed"),
        (b"a = 1\nb = 1 / 0\n", 2, "ZeroDivisionError"),
    ],
)
def test_an_error_of_the_file_names_its_line(tmp_path, text, line, words):
    (tmp_path / "law.py").write_bytes(text)
    with pytest.raises(InputError) as caught:
        load_law(tmp_path / "law.py")
    assert caught.value.place == f"law.py, line {line}"
    assert words in str(caught.value.value)


def test_a_syntax_error_elsewhere_is_told_at_the_line_that_leads_there(tmp_path, monkeypatch):
    """Line 1 of the other file is at fault, which is no line of the law to look at."""
    (tmp_path / "faulty_helper_of_a_law.py").write_text("x = (\n")
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "law.py").write_text("a = 1\nb = 2\nimport faulty_helper_of_a_law\n")
    with pytest.raises(InputError) as caught:
        load_law(tmp_path / "law.py")
    assert caught.value.place == "law.py, line 3"


def test_something_else_than_a_path_is_refused():
    with refused(place="law", value=3, expected="the path of a Python file"):
        load_law(3)
