"""What the terminal and the Markdown text of a translation say alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.deploy.vendor_tuning.block_units import printed_number
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.designs.gain_units import percent_gain

if TYPE_CHECKING:
    from clepsydra.deploy.vendor_tuning.translation import TranslatedLoop, Translation


#: A difference that nobody sees [% of range].
_NOTHING = 0.001


def loop_words(tuning: StandardTuning) -> str:
    """Return a loop and its tuning in ISA form, with the scales that percent are of.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid
    >>> volts = Signal("level", "V", low=0.0, high=10.0)
    >>> loop_words(StandardTuning("k", volts, volts, PidForm(), FilteredPid(3.0, 30.0), True))
    'level (0 to 10 V) by level (0 to 10 V), reverse acting: K = 3 V/V = 3 %/%, Ti = 30 s, b = 1.'
    """
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


def difference_texts(row: TranslatedLoop) -> tuple[str, str]:
    """Return the largest difference by the numbers, and by the block where it differs."""
    by_block = _percent(row.by_block) if row.filled.differs else ""
    return _percent(row.by_numbers), by_block


def _percent(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.2g} %" if percent >= _NOTHING else f"< {_NOTHING:g} %"


def footnotes(rows: Sequence[TranslatedLoop]) -> tuple[list[str], list[str]]:
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


def check_words(translation: Translation) -> str:
    """Return what the check stands for, and how far it says something about limits."""
    share = translation.saturated
    words = (
        "Each line was simulated in the block's form with the numbers as printed. Differences are "
        "the largest of the manipulated variable, in percent of its range: by the numbers, that "
        "is by rounding, and by the block, with what it does otherwise. Gains in %/% take the "
        "values in brackets for 0 and 100 %. The simulation keeps the controller's own "
        "anti-windup, where each block has its own"
    )
    if share == 0.0:
        return f"{words}; no output reaches a limit in it."
    return f"{words}; {100.0 * share:.2g} % of its samples have an output at a limit."


def refused_words(translation: Translation) -> list[str]:
    """Return what is not translated, with the reasons."""
    return list(dict.fromkeys(why for _, _, why in translation.refused))
