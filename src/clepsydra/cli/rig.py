"""``clepsydra rig``: a process in real time, on the wires of a plant."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clepsydra.cli.options import SubjectArgument, controller_option, named_values
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant
    from clepsydra.interface.rig import RunningRig
    from clepsydra.interface.rig_doors import Doors

_DOORS = "Its doors"
_OPTIONS = (
    "doors", "host", "encoding", "speed", "fail_safe", "silence", "script", "keep", "resume",
    "duration", "client", "client_map",
)  # fmt: skip
_NAMES = {
    name: f"--{each.replace('_', '-')}" for each in _OPTIONS for name in (each, f"rig, {each}")
} | {"rig, folder": "--output", "registers": "--registers", "peers": "--peer"}
#: How often the line of a rig is written anew [s].
_EVERY = 1.0


@verb(46)
def rig(
    subject: SubjectArgument,
    controller: str | None = controller_option(
        "Of the local panel, as the study calls it; PI controllers by SIMC if left out."
    ),
    speed: float = typer.Option(1.0, help="Times as fast as real time."),
    local: bool = typer.Option(
        False, "--local/--remote", help="Whether its local panel moves the plant at first."
    ),
    fail_safe: list[str] | None = typer.Option(
        None,
        metavar="SIGNAL=VALUE",
        help="Where an output goes while the controller is silent, as in pump_1='0 V'; its low "
        "limit.",
    ),
    silence: str | None = typer.Option(
        None,
        metavar="TIME",
        help="How long a controller may be silent before outputs go to their fail-safe values; "
        "three sampling periods, at least 1 s.",
    ),
    script: Path | None = typer.Option(
        None, metavar="FILE.toml", help="Faults, setpoints and disturbances at their times."
    ),
    folder: Path | None = typer.Option(
        None,
        "--output",
        "-o",
        metavar="FOLDER",
        help="Of its history and of what it remembers; clepsydra-rig/NAME if left out.",
    ),
    keep: str | None = typer.Option(
        None, metavar="TIME|SIZE", help="What of the history is kept, as in '7 d' or '500 MB'; all."
    ),
    resume: bool = typer.Option(False, "--resume", help="Go on where it stood in that folder."),
    duration: str | None = typer.Option(
        None, metavar="TIME", help="End after so long of the plant's time; else by control-C."
    ),
    seed: int = typer.Option(1, min=0, help="Of the noise, which is off at first."),
    doors: str | None = typer.Option(
        None,
        metavar="NAME,NAME",
        help="Which doors it has: modbus, opc-ua, page; all that are installed.",
        rich_help_panel=_DOORS,
    ),
    port: list[str] | None = typer.Option(
        None,
        metavar="DOOR=PORT",
        help="The port of a door, as in modbus=502.",
        rich_help_panel=_DOORS,
    ),
    host: str = typer.Option(
        "127.0.0.1",
        help="The address of this machine at which they listen.",
        rich_help_panel=_DOORS,
    ),
    registers: Path | None = typer.Option(
        None,
        metavar="FILE.csv",
        help="The register map of Modbus; made of the tags if left out.",
        rich_help_panel=_DOORS,
    ),
    encoding: str = typer.Option(
        "float32",
        help="Of values in registers: float32, float32-low-word-first, counts-27648, "
        "counts-32767, counts-65535 or microamperes of 4 to 20 mA.",
        rich_help_panel=_DOORS,
    ),
    read_only: bool = typer.Option(
        False, "--read-only", help="Let nothing be written through them.", rich_help_panel=_DOORS
    ),
    peer: list[str] | None = typer.Option(
        None,
        metavar="ADDRESS|NETWORK",
        help="Who may use Modbus; again for another. All.",
        rich_help_panel=_DOORS,
    ),
    anonymous: bool = typer.Option(
        False,
        "--anonymous",
        help="Let anybody read by OPC UA, without a name and without security.",
        rich_help_panel=_DOORS,
    ),
    client: str | None = typer.Option(
        None,
        metavar="ADDRESS",
        help="A PLC that is a server itself, as in modbus://192.168.0.10?unit=1 or "
        "opc.tcp://192.168.0.10:4840: the rig writes measurements there and reads commands.",
        rich_help_panel=_DOORS,
    ),
    client_map: Path | None = typer.Option(
        None,
        metavar="FILE.csv",
        help="Where that PLC has which tag.",
        rich_help_panel=_DOORS,
    ),
    show_map: bool = typer.Option(
        False,
        "--map",
        help="Print the register map, write it as CSV, and end.",
        rich_help_panel=_DOORS,
    ),
) -> None:
    """Run a process in real time, and offer it to controllers on its wires."""
    from clepsydra.cli.output import named_options
    from clepsydra.cli.subject import controller_of
    from clepsydra.interface.quantities import read_time
    from clepsydra.interface.rig import run_rig
    from clepsydra.interface.rig_doors import Doors, doors_without_package
    from clepsydra.interface.subject import plant_of, read_subject

    request = read_subject(subject)
    asked = Doors(
        None if doors is None else [name.strip() for name in doors.split(",") if name.strip()],
        ports=_ports(port), host=host, registers=registers, encoding=encoding,
        read_only=read_only, peers=peer, anonymous=anonymous, client=client, client_map=client_map,
    )  # fmt: skip
    if show_map:
        with named_options(**_NAMES):
            _show_map(plant_of(request), asked)
        return
    made = None if controller is None else controller_of(request, controller, folder, quiet=True)
    with named_options(**_NAMES):
        remedy = "write as in --fail-safe pump_1='0 V'"
        running = run_rig(
            plant_of(request), made, speed=speed, local=local, silence=silence, script=script,
            fail_safe=named_values(fail_safe, "signal", "--fail-safe", remedy), folder=folder,
            keep=keep, resume=resume, seed=seed, doors=asked,
        )  # fmt: skip
        ends = None if duration is None else read_time("rig", "duration", duration)
        with running:
            _show(running, ends, [] if doors is not None else doors_without_package())
        typer.echo(running.ending)


def _show(running: RunningRig, ends: float | None, lacking: list[str]) -> None:
    """Show how a rig stands until it ends, and which doors it lacks for want of their package."""
    for line in running.opening:
        typer.echo(line)
    if lacking:
        typer.echo(f"Without {' and '.join(lacking)}: pip install 'clepsydra[plant]' brings them.")
    in_place = sys.stdout.isatty()
    try:
        while (left := running.left_until(ends)) > 0.0:
            for report in running.watch(min(_EVERY, left)):
                typer.echo(("\r\033[K" if in_place else "") + str(report))
            if in_place:
                typer.echo(f"\r\033[K{running.standing}", nl=False)
    except KeyboardInterrupt:
        pass
    if in_place:
        typer.echo()


def _ports(given: list[str] | None) -> dict[str, int]:
    """Return doors with their ports from DOOR=PORT."""
    from clepsydra.base.errors import InputError

    remedy = "write as in --port modbus=502"
    found = {}
    for door, text in named_values(given, "door", "--port", remedy).items():
        if not text.isdecimal():
            raise InputError(f"--port, {door}", text, "the number of a port", remedy)
        found[door] = int(text)
    return found


def _show_map(plant: Plant, doors: Doors) -> None:
    """Print the register map of a plant, and write it."""
    from clepsydra.cli.output import output_file, show
    from clepsydra.interface.registers import registers as registers_of

    path = output_file(Path(f"{plant.file_stem}-registers.csv"))
    found = registers_of(plant, doors)
    found.write(path)
    show(found)
    typer.echo(f"Written: {path}")
