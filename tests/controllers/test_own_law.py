"""A file that cannot be loaded as a law is named with the line at fault."""

import pytest
from pages import blocks
from refusals import refused

import clepsydra as cl
from clepsydra import InputError, Signal, load_law
from clepsydra.program.step_law import Equations, step_law

#: The laws of the page, in Python and as expressions.
IN_PYTHON, AS_EXPRESSIONS = (
    block.text for block in blocks("docs/own-law.md", "python") if block.file
)
WIRES = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}
ERROR = 's["level.sp"] - s["level.pv"]'


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


def notes_of(tmp_path, text):
    (tmp_path / "law.py").write_text(text)
    return cl.design.own(cl.load("quadruple-tank"), load_law(tmp_path / "law.py"), **WIRES)


def test_an_idiom_that_vanishes_is_told_with_its_line_and_what_to_write(tmp_path):
    text = AS_EXPRESSIONS.replace(ERROR, f"{ERROR} + 0.0")
    line = text[: text.index("+ 0.0")].count("\n") + 1
    controller = notes_of(tmp_path, text)
    (note,) = controller.notes
    assert note.startswith(f"law.py, line {line}, ") and "write ca.if_else(x == 0, 0, x)" in note
    assert "law.py, line" in repr(controller)
    assert notes_of(tmp_path, AS_EXPRESSIONS).notes == ()


def test_a_law_in_python_computes_what_is_written(tmp_path):
    text = IN_PYTHON.replace('inputs["level.sp"] - inputs', '0.0 + inputs["level.sp"] - inputs')
    assert text != IN_PYTHON and notes_of(tmp_path, text).notes == ()


def test_a_law_of_no_file_is_looked_at_when_it_is_wired():
    def equations(s):
        good = s["level_1.pv"] == s["level_1.pv"]
        return Equations({}, {"pump_1.out": 3.0 * good})

    law = step_law(
        "mine", inputs=[Signal("level_1.pv")], parameters=[], state=[],
        outputs=[Signal("pump_1.out")], equations=equations,
    )  # fmt: skip
    wires = WIRES | {"setpoints": []}
    (note,) = cl.design.own(cl.load("quadruple-tank"), law, **wires).notes
    line = equations.__code__.co_firstlineno + 1
    assert note.startswith(f"test_own_law.py, line {line}, s['level_1.pv'] == ")
    assert "it becomes 1" in note and "ca.logic_not(ca.fabs(x) <= 1e300)" in note
