"""A translation of tunings: the numbers of every block, and on request what stands behind them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.deploy.vendor_tuning.words import (
    check_words,
    difference_texts,
    footnotes,
    loop_words,
    refused_words,
)

if TYPE_CHECKING:
    from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
    from clepsydra.deploy.vendor_tuning.translation import Translation

_HEAD = ("block", "settings", "switches", "by the numbers", "by the block", "see")


def tuning_answer(translation: Translation, *, every: bool = False) -> Section:
    """Return a table a loop.

    Parameters
    ----------
    translation : Translation
    every : bool
        Whether with switches, differences, notes, and equation, scaling and source of each block.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.vendor_tuning.translation import translate
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> loop, table, _ = tuning_answer(translate(controller, "quadruple-tank")).parts[0].parts
    >>> table.rows[0]
    ('Siemens PID_Compact', 'Gain = 3 %/%, Ti = 32.032 s, PWeighting = 1')
    """
    notes, marks = footnotes(translation.rows)
    loops = [_loop(translation, tuning, marks, every) for tuning in translation.tunings]
    title = f"{translation.controller} on {translation.process}: tuning for vendors' PID blocks"
    refused = marked(Mark.REFUSED, refused_words(translation))
    if not every:
        return Section(title, (*loops, *refused))
    numbered = (Line(f"({number}) {words}") for number, words in enumerate(notes, start=1))
    blocks = {row.block.key: row.block for row in translation.rows}
    about = (
        f"{block.title}: {block.equation}. Scaling: {block.scaling}. Anti-windup: "
        f"{block.anti_windup}. Source: {'; '.join(block.sources)}."
        for block in blocks.values()
    )
    further = [Section("The blocks", marked(Mark.POINT, about))]
    further += [Section("Not translated", refused)] if refused else []
    return Section(title, (Line(check_words(translation)), *loops, *numbered, *further))


def _loop(
    translation: Translation, tuning: StandardTuning, marks: list[str], every: bool
) -> Section:
    rows = []
    for row, seen in zip(translation.rows, marks, strict=True):
        if row.tuning.loop == tuning.loop:
            settings = ", ".join(setting.words for setting in row.filled.settings)
            switches = ", ".join(f"{name}: {value}" for name, value in row.filled.choices)
            rows.append((row.block.title, settings, switches, *difference_texts(row), seen))
    columns = len(_HEAD) if every else 2
    table = Table("", _HEAD[:columns], tuple(row[:columns] for row in rows), names=3, kept=2)
    return Section(tuning.title, (Line(loop_words(tuning)), table, Line("")))
