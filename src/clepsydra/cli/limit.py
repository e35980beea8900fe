"""``clepsydra limit``: how good control of a process could possibly be."""

from __future__ import annotations

import typer

from clepsydra.cli.options import JsonOption, SubjectArgument, named_values
from clepsydra.cli.verb import verb


@verb(35)
def limit(
    process: SubjectArgument,
    inputs: list[str] | None = typer.Option(
        None,
        "--input",
        metavar="NAME=VALUE[@TIME[..TIME]]",
        help="A setpoint or a load that moves, as in level_1=60%@60s; several in order of time. "
        "Without one it is the scenario of the study.",
    ),
    duration: str | None = typer.Option(
        None, metavar="TIME", help="As in '20 min': when the last event is at rest at the latest."
    ),
    within: list[str] | None = typer.Option(
        None,
        metavar="INPUT=LOW..HIGH",
        help="Between which ends an input may move, as in pump_1='0 V..8 V'; its range.",
    ),
    overshoot: bool = typer.Option(
        True,
        "--overshoot/--no-overshoot",
        help="Whether the output that steps may go beyond its setpoint.",
    ),
    as_json: JsonOption = False,
) -> None:
    """Find the least error that any controller could leave, as a measure for those that do."""
    from clepsydra.cli.output import named_options, tell
    from clepsydra.cli.progress import shown_progress
    from clepsydra.interface.events import event_in_words
    from clepsydra.interface.limit import limit as limit_of
    from clepsydra.interface.subject import read_subject

    request = read_subject(process)
    events = [event_in_words(text, f"--input {text[:60]}") for text in inputs or []]
    remedy = "write as in --within pump_1='0 V..8 V'"
    given = named_values(within, "input", "--within {}", remedy)
    bounds = {name: _ends(text, remedy) for name, text in given.items()}
    options = {"simulation, duration": "--duration", "limit, within": "--within"}
    with named_options("duration", **options), shown_progress(quiet=as_json) as say:
        found = limit_of(
            request, events or None, duration=duration, within=bounds,
            overshoot=overshoot, progress=say,
        )  # fmt: skip
    tell(found, {}, as_json=as_json)


def _ends(text: str, remedy: str) -> tuple[str, str]:
    from clepsydra.base.errors import InputError

    low, dots, high = text.partition("..")
    if not dots:
        raise InputError("--within", text, "a lower end, '..' and an upper one", remedy)
    return low.strip(), high.strip()
