"""``clepsydra analyse``: what the linear model says about a process."""

from __future__ import annotations

from clepsydra.cli.options import JsonOption, ProcessArgument


def analyse(process: ProcessArgument, as_json: JsonOption = False) -> None:
    """Show operating point, poles, zeros, static gain, RGA and pairing of a process."""
    from clepsydra.linear.analysis import analyse as analyse_process
    from clepsydra.process.reader import load_process

    analysis = analyse_process(load_process(process))
    if as_json:
        from clepsydra.cli.output import print_json

        print_json(analysis.as_dict())
        return
    from rich.console import Console

    from clepsydra.report.tables import analysis_table

    Console(width=100).print(analysis_table(analysis))
