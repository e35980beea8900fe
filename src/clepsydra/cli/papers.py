"""``clepsydra papers``: the documents that Clepsydra was built from, number by number."""

from __future__ import annotations

import typer

from clepsydra.cli.options import JsonOption, OutputOption, all_option
from clepsydra.cli.verb import verb


@verb(100)
def papers(
    documents: list[str] | None = typer.Argument(
        None, metavar="[DOCUMENT]...", help="Keys of documents; all if left out."
    ),
    beside_limit: bool = typer.Option(
        False,
        "--limit",
        help="Run their controllers and ours beside the best that any could do instead.",
    ),
    every: bool = all_option("Show every row that is not as printed, or every controller."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Run the experiments of five published documents and judge every printed number."""
    import os

    from clepsydra.cli.output import print_json, results_folder, show, written_files
    from clepsydra.cli.progress import shown_progress
    from clepsydra.interface.papers import against_limit, audit

    work = against_limit if beside_limit else audit
    stem, ending = ("against-the-limit", "md") if beside_limit else ("papers", "html")
    told = (
        "the controllers of each experiment"
        if beside_limit
        else "the reasons and the redrawn figures"
    )
    place = results_folder(folder, as_json=as_json)
    files = written_files(place, stem, page=ending)
    with shown_progress(quiet=as_json) as tell:
        result = work(documents or (), workers=os.cpu_count() or 1, progress=tell)
    for page in files.values():
        result.report(page)
    if as_json:
        print_json(result.as_list())
        return
    show(result.shown(every=every))
    typer.echo(f"\nNext: open {files['page']} for {told}.")
