"""``clepsydra identify``: a model from a record."""

from __future__ import annotations

from pathlib import Path

import typer

from clepsydra.cli.options import JsonOption, OutputOption, all_option
from clepsydra.cli.verb import verb


@verb(90)
def identify(
    data: Path = typer.Argument(
        ...,
        metavar="DATA.csv|HISTORY.sqlite",
        help="A record, sampled regularly, whose head names time and signals with their units; or "
        "the history of a rig.",
    ),
    manipulated: str | None = typer.Option(
        None, metavar="NAME", help="The column that is moved by hand or by a controller."
    ),
    measured: str | None = typer.Option(None, metavar="NAME", help="The column that follows it."),
    process: str | None = typer.Option(
        None,
        metavar="PROCESS",
        help="Fit parameters of this process instead: of the catalogue, or a process file.",
    ),
    parameters: str | None = typer.Option(
        None, metavar="NAME,NAME", help="Those to fit, as in outlet_1.area,pump_1.gain."
    ),
    write: Path | None = typer.Option(
        None, metavar="FILE.toml", help="Write the process file with the fitted parameters."
    ),
    last: str | None = typer.Option(
        None, metavar="TIME", help="Of a history so much of its end, as in '2 h'; the whole run."
    ),
    every: bool = all_option("Show every parameter and remark."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Identify a model from a record: ARX, FOPDT, SOPDT, IPDT, or parameters of a process."""
    from clepsydra.base.errors import InputError
    from clepsydra.cli.output import named_options, results_folder, tell, written_files
    from clepsydra.interface.identify import FittedPlant, Identification
    from clepsydra.interface.identify import identify as identify_model
    from clepsydra.interface.plant import load

    place = results_folder(folder, as_json=as_json)
    files = written_files(place, f"{data.stem}-identification", page="html")
    for option, given in (("--parameters", parameters), ("--write", write)):
        if given is not None and process is None:
            raise InputError(
                option, str(given), "a process that has them", "name it, as in --process tank.toml"
            )
    for option, name in (("--manipulated", manipulated), ("--measured", measured)):
        if name is not None and process is not None:
            raise InputError(
                option, name, "no such option with --process",
                "leave it out: every input and measurement of the process that is recorded counts",
            )  # fmt: skip
    if write is not None and write.suffix.lower() != ".toml":
        raise InputError("--write", str(write), "a file that ends in .toml", "rename it")
    found: Identification | FittedPlant
    options = ("manipulated", "measured", "process", "parameters")
    with named_options(*options, **{"identify, last": "--last"}):
        if process is None:
            found = identify_model(data, manipulated, measured, last=last)
        else:
            names = [name.strip() for name in (parameters or "").split(",") if name.strip()]
            found = identify_model(data, plant=load(process), parameters=names, last=last)
    for page in files.values():
        found.report(page)
    if write is not None and isinstance(found, FittedPlant):
        found.write(write)
        files["process file"] = write
    tell(found, files, as_json=as_json, every=every)
