"""A translation of tunings: each loop's, and on request the numbers of every block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.deploy.vendor_tuning.block_units import printed_number
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.designs.gain_units import percent_gain

if TYPE_CHECKING:
    from clepsydra.deploy.vendor_tuning.translation import TranslatedLoop, Translation

_HEAD = ("block", "settings", "switches", "by the numbers", "by the block", "see")
#: Loops at a glance, and what is not translated.
_LOOPS = 3
#: A difference that nobody sees [% of range].
_NOTHING = 0.001
#: What the check of a translation stands for.
_CHECK = (
    "Each line was simulated in the block's form with the numbers as printed. Differences are the "
    "largest of the manipulated variable, in percent of its range: by the numbers, that is by "
    "rounding, and by the block, with what it does otherwise. Gains in %/% take the values in "
    "brackets for 0 and 100 %. The simulation keeps the controller's own anti-windup, where each "
    "block has its own"
)


def tuning_answer(translation: Translation, *, every: bool = False) -> Section:
    """Return each loop in ISA form and the blocks that it is translated for, or all numbers.

    Parameters
    ----------
    translation : Translation
    every : bool
        Whether with a table a loop: settings, switches, differences, notes, and equation, scaling
        and source of each block.
    """
    title = f"{translation.controller} on {translation.process}: tuning for vendors' PID blocks"
    refused = list(dict.fromkeys(why for _, _, why in translation.refused))
    return Section(title, (_whole if every else _glance)(translation, refused))


def _glance(translation: Translation, refused: list[str]) -> tuple[Line, ...]:
    def first(mark: Mark, words: list[str], which: str) -> tuple[Line, ...]:
        more = len(words) - _LOOPS
        rest = (Line(f"{more} more {which}: in the file."),) if more > 0 else ()
        return (*marked(mark, words[:_LOOPS]), *rest)

    titles = dict.fromkeys(row.block.title for row in translation.rows)
    vendors = ", ".join(dict.fromkeys(title.split()[0] for title in titles))
    return (
        *first(Mark.POINT, [_loop_words(each) for each in translation.tunings], "loops"),
        *((Line(f"Filled in for {len(titles)} blocks: {vendors}."),) if titles else ()),
        *first(Mark.REFUSED, refused, "that are not translated"),
    )


def _whole(translation: Translation, refused: list[str]) -> tuple[Line | Section, ...]:
    notes, marks = _footnotes(translation.rows)
    share = translation.saturated
    limits = f"{100.0 * share:.2g} % of its samples have an output at a limit"
    checked = Line(f"{_CHECK}; {limits if share else 'no output reaches a limit in it'}.")
    loops = [_loop(translation, tuning, marks) for tuning in translation.tunings]
    numbered = (Line(f"({number}) {words}") for number, words in enumerate(notes, start=1))
    blocks = {row.block.key: row.block for row in translation.rows}
    about = (
        f"{block.title}: {block.equation}. Scaling: {block.scaling}. Anti-windup: "
        f"{block.anti_windup}. Source: {'; '.join(block.sources)}."
        for block in blocks.values()
    )
    further = [Section("The blocks", marked(Mark.POINT, about))]
    further += [Section("Not translated", marked(Mark.REFUSED, refused))] if refused else []
    return (checked, *loops, *numbered, *further)


def _footnotes(rows: Sequence[TranslatedLoop]) -> tuple[list[str], list[str]]:
    """Return what the rows say beside their numbers, each once, and the marks of each row."""
    notes: list[str] = []
    marks = []
    for row in rows:
        said = [
            *(f"The block {words}." for words in row.filled.differs),
            *(f"{words[0].upper()}{words[1:]}." for words in row.filled.notes),
        ]
        notes += [words for words in dict.fromkeys(said) if words not in notes]
        marks.append(", ".join(str(notes.index(words) + 1) for words in dict.fromkeys(said)))
    return notes, marks


def _loop(translation: Translation, tuning: StandardTuning, marks: list[str]) -> Section:
    rows = []
    for row, seen in zip(translation.rows, marks, strict=True):
        if row.tuning.loop == tuning.loop:
            settings = ", ".join(setting.words for setting in row.filled.settings)
            switches = ", ".join(f"{name}: {value}" for name, value in row.filled.choices)
            by_block = _percent(row.by_block) if row.filled.differs else ""
            by_numbers = _percent(row.by_numbers)
            rows.append((row.block.title, settings, switches, by_numbers, by_block, seen))
    table = Table("", _HEAD, tuple(rows), names=3, kept=2)
    return Section(tuning.title, (Line(_loop_words(tuning)), table, Line("")))


def _percent(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.2g} %" if percent >= _NOTHING else f"< {_NOTHING:g} %"


def _loop_words(tuning: StandardTuning) -> str:
    """Return a loop and its tuning in ISA form, with the scales that percent are of."""
    numbers, signals = tuning.settings, (tuning.measurement, tuning.moved)
    gain = f"{printed_number(numbers.gain * tuning.engineering_factor)} {tuning.engineering_unit}"
    if all(signal.has_range for signal in signals) and tuning.engineering_unit != "%/%":
        gain += f" = {printed_number(percent_gain(numbers.gain, *signals))} %/%"
    shown = [f"K = {gain}"]
    if tuning.has_integral:
        shown.append(f"Ti = {printed_number(numbers.integral_time)} s")
    if tuning.has_derivative:
        shown.append(f"Td = {printed_number(numbers.derivative_time)} s")
        shown.append(f"Tf = {printed_number(numbers.filter_time)} s")
        shown.append(f"derivative on the {tuning.form.derivative_on}")
    shown.append(f"b = {printed_number(numbers.setpoint_weight)}")
    names = " by ".join(_scale_words(signal) for signal in signals)
    through = "" if tuning.direct else " Other blocks stand between it and the outputs."
    return f"{names}, {tuning.action} acting: {', '.join(shown)}.{through}"


def _scale_words(signal: Signal) -> str:
    """Return the name with what 0 and 100 % of the signal are."""
    if not signal.has_range:
        return signal.name
    ends = (from_si(end, signal.unit, signal.shown_unit) for end in signal.percent_scale)
    low, high = (f"{end:.5g}" for end in ends)
    unit = "" if signal.shown_unit == "1" else f" {signal.shown_unit}"
    return f"{signal.name} ({low} to {high}{unit})"
