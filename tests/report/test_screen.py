"""How answers stand on terminals that are too narrow for them."""

import io
import shlex
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

import clepsydra as cl


def shown(answer, width):
    stream = io.StringIO()
    Console(file=stream, width=width).print(answer)
    return [line.rstrip() for line in stream.getvalue().splitlines()]


def test_columns_of_a_matrix_without_room_continue_below_with_the_names_again():
    controller = cl.design.lqi_kalman(cl.load("eight-tanks"))
    wide = {word for line in shown(controller, 1000) for word in line.split() if "─" not in word}
    for width in range(60, 130, 5):
        lines = shown(controller, width)
        assert max(map(len, lines)) <= width
        assert wide <= {word for line in lines for word in line.split()}  # and none cut short
    titles = [line.strip() for line in shown(controller, 80) if "a sample later" in line]
    assert len(titles) == 3 and len(set(titles)) == 2  # a title of its own, then further columns


def test_a_table_that_may_lose_no_column_breaks_its_cells_and_loses_no_word():
    step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    wide, narrow = (shown(run.shown(every=True), width) for width in (120, 60))
    assert max(map(len, narrow)) <= 60 < max(map(len, wide))
    words = ({word for line in lines for word in line.split()} for lines in (wide, narrow))
    left, kept = ({word for word in each if "─" not in word} for each in words)
    assert left <= kept


@pytest.mark.parametrize("width", [60, 80, 120])
def test_a_command_can_be_copied_whatever_the_width(result, width):
    result = replace(result, path=Path("plants/a-plant-in-the-cellar.toml"))
    lines = shown(result.shown().on_command_line, width)
    start = next(place for place, line in enumerate(lines) if line.startswith("Next: "))
    copied = "\n".join(lines[start:]).removeprefix("Next: ").replace("\\\n", "")
    export, verify = (shlex.split(line) for line in copied.splitlines())
    words = ["plants/a-plant-in-the-cellar.toml", "--controller", result.best.controller.name]
    assert export == ["clepsydra", "export", *words, "--to", "st"]
    assert verify == ["clepsydra", "verify", *words]
    assert max(map(len, lines[start:])) <= width
