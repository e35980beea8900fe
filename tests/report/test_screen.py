"""How sections stand on terminals that are too narrow for them."""

import io
import shlex

import pytest
from rich.console import Console

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.report.screen import Screen


def shown(part, width):
    stream = io.StringIO()
    Console(file=stream, width=width).print(Screen(Section("", (part,))))
    return [line.rstrip() for line in stream.getvalue().splitlines()]


def test_a_table_that_may_lose_no_column_breaks_its_cells_and_loses_no_word():
    rows = (("tank_1.level", "12.26 cm at 17 s", "15.00 cm at 12 min"),)
    lines = shown(Table("", ("signal", "smallest", "largest"), rows), 40)
    assert max(map(len, lines)) <= 40
    words = {word for line in lines for word in line.split()}
    assert words >= {word for cell in rows[0] for word in cell.split()}


@pytest.mark.parametrize("width", [60, 80, 120])
def test_a_command_can_be_copied_whatever_the_width(width):
    command = (
        'Next: clepsydra export plants/a-plant-in-the-cellar.toml --controller "PI, SIMC" --to st'
    )
    lines = shown(Line(command, Mark.COMMAND), width)
    assert max(map(len, lines)) <= width
    assert all(line.endswith(" \\") for line in lines[:-1])
    assert shlex.split("\n".join(lines).replace("\\\n", "")) == shlex.split(command)
