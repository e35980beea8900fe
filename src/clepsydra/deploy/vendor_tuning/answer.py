"""A translation of tunings: each loop's, and on request the numbers of every block."""

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
#: Loops at a glance, and what is not translated.
_LOOPS = 3


def tuning_answer(translation: Translation, *, every: bool = False) -> Section:
    """Return each loop in ISA form and the blocks that it is translated for, or all numbers.

    Parameters
    ----------
    translation : Translation
    every : bool
        Whether with a table a loop: settings, switches, differences, notes, and equation, scaling
        and source of each block.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.vendor_tuning.translation import translate
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> loop, table, _ = tuning_answer(
    ...     translate(controller, "quadruple-tank"), every=True).parts[1].parts
    >>> table.rows[0][:2]
    ('Siemens PID_Compact', 'Gain = 3 %/%, Ti = 32.032 s, PWeighting = 1')
    """
    title = f"{translation.controller} on {translation.process}: tuning for vendors' PID blocks"
    return Section(title, _whole(translation) if every else _glance(translation))


def _glance(translation: Translation) -> tuple[Line, ...]:
    said = marked(Mark.POINT, (loop_words(each) for each in translation.tunings[:_LOOPS]))
    more = len(translation.tunings) - _LOOPS
    said += (Line(f"{more} more loops: in the file."),) if more > 0 else ()
    titles = dict.fromkeys(row.block.title for row in translation.rows)
    vendors = ", ".join(dict.fromkeys(title.split()[0] for title in titles))
    blocks = (Line(f"Filled in for {len(titles)} blocks: {vendors}."),) if titles else ()
    refused = refused_words(translation)
    more = len(refused) - _LOOPS
    rest = (Line(f"{more} more that are not translated: in the file."),) if more > 0 else ()
    return (*said, *blocks, *marked(Mark.REFUSED, refused[:_LOOPS]), *rest)


def _whole(translation: Translation) -> tuple[Line | Section, ...]:
    notes, marks = footnotes(translation.rows)
    loops = [_loop(translation, tuning, marks) for tuning in translation.tunings]
    refused = marked(Mark.REFUSED, refused_words(translation))
    numbered = (Line(f"({number}) {words}") for number, words in enumerate(notes, start=1))
    blocks = {row.block.key: row.block for row in translation.rows}
    about = (
        f"{block.title}: {block.equation}. Scaling: {block.scaling}. Anti-windup: "
        f"{block.anti_windup}. Source: {'; '.join(block.sources)}."
        for block in blocks.values()
    )
    further = [Section("The blocks", marked(Mark.POINT, about))]
    further += [Section("Not translated", refused)] if refused else []
    return (Line(check_words(translation)), *loops, *numbered, *further)


def _loop(translation: Translation, tuning: StandardTuning, marks: list[str]) -> Section:
    rows = []
    for row, seen in zip(translation.rows, marks, strict=True):
        if row.tuning.loop == tuning.loop:
            settings = ", ".join(setting.words for setting in row.filled.settings)
            switches = ", ".join(f"{name}: {value}" for name, value in row.filled.choices)
            rows.append((row.block.title, settings, switches, *difference_texts(row), seen))
    table = Table("", _HEAD, tuple(rows), names=3, kept=2)
    return Section(tuning.title, (Line(loop_words(tuning)), table, Line("")))
