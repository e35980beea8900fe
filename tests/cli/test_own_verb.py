"""A new verb is one file: here a list of the values at rest, for who sets up a screen."""

import csv
import io
from typing import Annotated

import pytest
import typer
from refusals import refused

import clepsydra as cl
from clepsydra.cli.options import ProcessArgument
from clepsydra.cli.verb import VERBS, verb


def at_rest(
    process: ProcessArgument,
    only: Annotated[str | None, typer.Option(help="Signals whose name begins so.")] = None,
) -> None:
    """List the values of a process at rest as CSV: name, value, unit."""
    plant, table = cl.load(process), io.StringIO()
    shown = {name: v for name, v in plant.point.as_dict().items() if name.startswith(only or "")}
    if not shown:
        raise cl.InputError("--only", only, "how a signal's name begins", "leave it out to see all")
    writer = csv.writer(table)
    for name, value in shown.items():
        writer.writerow([name, f"{value:.6g}", plant.process.signal(name).shown_unit])
    typer.echo(table.getvalue().rstrip())


@pytest.fixture
def own(monkeypatch):
    """The verb as its file would add it; forgotten after the test."""
    monkeypatch.setattr(VERBS, "_things", dict(VERBS))
    verb(35)(at_rest)


def test_the_help_has_it_in_its_place(own, command):
    status, said, _ = command("--help")
    places = [said.index(f" {name} ") for name in ("analyse", "at-rest", "draw", "processes")]
    assert status == 0 and places == sorted(places)
    status, said, _ = command("at-rest", "--help")
    assert status == 0 and "--only" in said and "values of a process at rest" in said


def test_it_runs_and_refuses_as_every_verb_does(own, command):
    status, said, _ = command("at-rest", "quadruple-tank", "--only", "pump")
    assert (status, said.split()) == (0, ["pump_1,3,V", "pump_2,3,V"])
    status, said, error = command("at-rest", "quadruple-tank", "--only", "valv")
    assert (status, said) == (2, "") and error.startswith("clepsydra: --only: got 'valv'")


def test_no_second_one_is_taken_by_its_name(own):
    with refused(place="clepsydra.cli", value="at-rest"):
        verb(36)(at_rest)


def test_it_is_gone_where_nobody_registers_it(command):
    status, _, error = command("at-rest", "quadruple-tank")
    assert status == 2 and "No such command" in error
