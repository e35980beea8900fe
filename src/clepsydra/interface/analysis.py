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

    Printed, it shows what matters for control; all fields are those of
    `clepsydra.linear.analysis.Analysis`.
    """

    def answer(self, *, every: bool = False) -> Section:
        """Return what matters for control, or every signal, pole, zero, gain and sentence."""
        from clepsydra.report.analysis_page import analysis_answer

        return analysis_answer(self, every=every)

    def report(self, path: str | Path) -> None:
        """Write a page with poles, Bode, Nyquist, step responses and relative gains."""
        from clepsydra.report.analysis_page import analysis_page_text
        from clepsydra.report.page import write_page

        write_page(analysis_page_text(self), path)
