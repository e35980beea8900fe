"""The command with its verbs; loads nothing numeric, so that help is immediate."""

from __future__ import annotations

import typer

from clepsydra import __version__
from clepsydra.cli.verb import VERBS


def application() -> typer.Typer:
    """Return the command, with every verb that is registered by now, in the order of the help."""
    command = typer.Typer(
        name="clepsydra",
        help="From a liquid-tank process on paper to a proven controller in the PLC.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        epilog="Start with: clepsydra study quadruple-tank",
    )
    command.callback()(_clepsydra)
    for name, verb in VERBS.items():
        command.command(name)(verb.function)
    return command


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"clepsydra {__version__}")
        raise typer.Exit


def _clepsydra(
    version: bool = typer.Option(
        False, "--version", callback=_show_version, is_eager=True, help="Show the version."
    ),
) -> None:
    """From a liquid-tank process on paper to a proven controller in the PLC."""
