"""A translation of tunings as Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.deploy.vendor_tuning.words import (
    check_words,
    difference_texts,
    footnotes,
    loop_words,
    refused_words,
)

if TYPE_CHECKING:
    from clepsydra.deploy.vendor_tuning.translation import Translation


def tuning_markdown(translation: Translation) -> str:
    """Return the tables of a translation with scaling, differences and sources.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.vendor_tuning.translation import translate
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> text = translate(controller, "quadruple-tank").as_markdown()
    >>> "| Honeywell HC900 PID | Prop Band = 33.333 %, Gain = 3 %/%" in text
    True
    """
    lines = [
        f"# {translation.controller} on {translation.process}: tuning for vendors' PID blocks",
        "",
        check_words(translation),
    ]
    notes, marks = footnotes(translation.rows)
    for tuning in translation.tunings:
        lines += ["", f"## {tuning.title}", "", loop_words(tuning), ""]
        lines.append("| block | settings | switches | by the numbers | by the block | see |")
        lines.append("|---|---|---|---|---|---|")
        for row, seen in zip(translation.rows, marks, strict=True):
            if row.tuning.loop != tuning.loop:
                continue
            settings = ", ".join(setting.words for setting in row.filled.settings)
            switches = ", ".join(f"{name}: {value}" for name, value in row.filled.choices)
            cells = (row.block.title, settings, switches, *difference_texts(row), seen)
            lines.append(f"| {' | '.join(cells)} |")
    lines += ["", *(f"{number}. {words}" for number, words in enumerate(notes, start=1))]
    blocks = {row.block.key: row.block for row in translation.rows}
    lines += ["", "## The blocks", ""]
    for block in blocks.values():
        lines.append(f"- **{block.title}**: {block.equation}. Scaling: {block.scaling}.")
        lines.append(f"  Anti-windup: {block.anti_windup}. Source: {'; '.join(block.sources)}.")
    refused = refused_words(translation)
    if refused:
        lines += ["", "## Not translated", "", *(f"- {words}" for words in refused)]
    return "\n".join(lines) + "\n"
