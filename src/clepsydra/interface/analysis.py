"""The analysis of a plant, printed as the command line shows it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.interface.shown import Answered
from clepsydra.linear import analysis as inner

if TYPE_CHECKING:
    from clepsydra.base.section import Section


class Analysis(Answered, inner.Analysis):
    """What the linear model says about a plant: `poles`, `zeros`, `pairing`, `model`, `words`, …

    Printed, it shows operating point, tables and sentences; all fields are those of
    `clepsydra.linear.analysis.Analysis`.
    """

    def answer(self) -> Section:
        """Return its tables and sentences."""
        from clepsydra.report.analysis_answer import analysis_answer

        return analysis_answer(self)

    def report(self, path: str | Path) -> None:
        """Write a page with poles, Bode, Nyquist, step responses and relative gains."""
        from clepsydra.report.analysis_page import write_analysis_page

        write_analysis_page(self, Path(path))
