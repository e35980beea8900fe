"""The command with its verbs; loads nothing numeric, so that help is immediate."""

from __future__ import annotations

from typing import Annotated

import typer

from clepsydra import __version__
from clepsydra.cli.analyse import analyse
from clepsydra.cli.draw import draw
from clepsydra.cli.export import export
from clepsydra.cli.identify import identify
from clepsydra.cli.new import new
from clepsydra.cli.papers import papers
from clepsydra.cli.processes import processes
from clepsydra.cli.simulate import simulate
from clepsydra.cli.study import study
from clepsydra.cli.verify import verify

application = typer.Typer(
    name="clepsydra",
    help="From a liquid-tank process on paper to a proven controller in the PLC.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Start with: clepsydra study quadruple-tank",
)
application.command()(study)
application.command()(simulate)
application.command()(analyse)
application.command()(draw)
application.command()(processes)
application.command()(new)
application.command()(export)
application.command()(verify)
application.command()(identify)
application.command()(papers)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"clepsydra {__version__}")
        raise typer.Exit


@application.callback()
def clepsydra(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """From a liquid-tank process on paper to a proven controller in the PLC."""
