"""The tuning of a controller's PID loops for every vendor's block, each checked by simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.markdown import markdown
from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.controllers.controller import Controller
from clepsydra.deploy.tagged import process_tagging
from clepsydra.deploy.vendor_tuning.beside_blocks import beside_blocks
from clepsydra.deploy.vendor_tuning.check import Check
from clepsydra.deploy.vendor_tuning.filling import Applied, Filled, filled
from clepsydra.deploy.vendor_tuning.printed_gain import (
    engineering_unit,
    gain_words,
    printed_number,
)
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning, standard_tunings
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK, VendorBlock
from clepsydra.designs.gain_units import gain_factor
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

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


@dataclass(frozen=True)
class TranslatedLoop:
    """One loop in one vendor's block.

    Parameters
    ----------
    tuning : StandardTuning
    block : VendorBlock
    filled : Filled
    by_numbers : float
        Largest difference of the manipulated variable between the controller and the loop with
        the printed numbers in the block's form, as a share of its range: rounding. Of a loop
        that moves no output itself, the largest of all outputs.
    by_block : float
        The same with what the block lacks: its filter, setpoint weight and derivative.
    """

    tuning: StandardTuning
    block: VendorBlock
    filled: Filled
    by_numbers: float
    by_block: float


@dataclass(frozen=True)
class Translation:
    """The tuning of a controller in the terms of every vendor.

    Parameters
    ----------
    controller, process : str
        Their names.
    tunings : tuple of StandardTuning
        One for each loop.
    rows : tuple of TranslatedLoop
    beside : tuple of str
        What decoupling and feedforward add to the outputs of the blocks.
    refused : tuple of (str, str, str)
        Loop, block and the reason; the block is empty where the loop has no tuning at all.
    saturated : float
        Share of the samples of the check in which an output is at a limit.
    """

    controller: str
    process: str
    tunings: tuple[StandardTuning, ...]
    rows: tuple[TranslatedLoop, ...]
    beside: tuple[str, ...]
    refused: tuple[tuple[str, str, str], ...]
    saturated: float

    def answer(self, *, every: bool = False) -> Section:
        """Return the loops and the blocks, and on request all numbers and what stands behind."""
        title = f"{self.controller} on {self.process}: tuning for vendors' PID blocks"
        refused = list(dict.fromkeys(why for _, _, why in self.refused))
        return Section(title, (_whole if every else _glance)(self, refused))

    def as_markdown(self) -> str:
        """Return all of it as Markdown."""
        return markdown(self.answer(every=True), 1) + "\n"

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain values, for JSON."""
        return {
            "controller": self.controller,
            "process": self.process,
            "saturated_share": self.saturated,
            "loops": [_loop_dict(self, tuning) for tuning in self.tunings],
            "beside": list(self.beside),
            "refused": [
                {"loop": loop, "block": block, "reason": why} for loop, block, why in self.refused
            ],
        }


def translate(
    controller: Controller, process: Process | str, scenario: Scenario | None = None
) -> Translation:
    """Translate the tuning of a controller's PID loops for the vendors' own blocks.

    Every block is filled in from the exact algebra between the forms, its numbers rounded to
    what is printed, and the closed loop simulated with what the printed numbers mean, in the
    form of the block and with what it lacks, but with the controller's own anti-windup.

    Parameters
    ----------
    controller : Controller
        With PID loops of constant gains, alone or in a scheme.
    process : Process or str
        Or its name or path; the controller rests at its operating point.
    scenario : Scenario, optional
        Of the check; the default one if omitted.

    Returns
    -------
    Translation

    Raises
    ------
    InputError
        The controller has no PID loop that can be translated, or the process or scenario cannot
        be used.

    Examples
    --------
    >>> import clepsydra as cl
    >>> found = translate(cl.design.simc(cl.load("quadruple-tank")), "quadruple-tank")
    >>> {row.block.name: row.filled.settings[1].words for row in found.rows[4:8:2]}
    {'PIDE, dependent gains': 'TI = 0.53387 min', 'PIDE, independent gains': 'KI = 5.6194 1/min'}
    """
    plant = process if isinstance(process, Process) else load_process(process)
    tunings, without = standard_tunings(controller, plant)
    refused = [(loop, "", why) for loop, why in without]
    model = analyse(plant).model
    check = Check(controller, model, scenario if scenario is not None else default_scenario(model))
    tagged = process_tagging(plant)

    def largest(applied: Mapping[str, Applied]) -> dict[str, float]:
        return {tagged(name): value for name, value in check.differences(applied).items()}

    rows: list[TranslatedLoop] = []
    for block in EVERY_BLOCK:
        found: dict[str, Filled] = {}
        for tuning in tunings:
            try:
                found[tuning.loop] = filled(block, tuning)
            except InputError as error:
                refused.append((tuning.title, block.title, str(error)))
        if not found:
            continue
        numbers = largest({loop: each.numbers for loop, each in found.items()})
        blocks = largest({loop: each.applied for loop, each in found.items()})
        rows += [
            TranslatedLoop(
                tuning, block, found[tuning.loop], _of(tuning, numbers), _of(tuning, blocks)
            )
            for tuning in tunings
            if tuning.loop in found
        ]
    return Translation(
        controller.title,
        plant.name,
        tuple(tunings),
        tuple(rows),
        beside_blocks(controller, plant),
        tuple(refused),
        check.saturated(),
    )


def _of(tuning: StandardTuning, differences: dict[str, float]) -> float:
    if not tuning.direct:
        return max(differences.values())
    return differences[tuning.moved.name]


def _loop_dict(translation: Translation, tuning: StandardTuning) -> dict[str, Any]:
    numbers, signals = tuning.settings, (tuning.measurement, tuning.moved)
    return {
        "loop": tuning.title,
        "action": tuning.action,
        "gain": numbers.gain * gain_factor(*signals),
        "gain_unit": engineering_unit(*signals),
        "integral_time_s": numbers.integral_time if tuning.has_integral else None,
        "derivative_time_s": numbers.derivative_time,
        "filter_time_s": numbers.filter_time,
        "setpoint_weight": numbers.setpoint_weight,
        "derivative_on": tuning.form.derivative_on if tuning.has_derivative else None,
        "blocks": [
            {
                "key": row.block.key,
                "block": row.block.title,
                "settings": [
                    {"name": each.name, "value": each.value, "unit": each.unit}
                    for each in row.filled.settings
                ],
                "choices": dict(row.filled.choices),
                "scaling": row.block.scaling,
                "differs": list(row.filled.differs),
                "notes": list(row.filled.notes),
                "anti_windup": row.block.anti_windup,
                "largest_difference_by_numbers": row.by_numbers,
                "largest_difference_by_block": row.by_block,
                "sources": list(row.block.sources),
            }
            for row in translation.rows
            if row.tuning.loop == tuning.loop
        ],
    }


def _glance(translation: Translation, refused: list[str]) -> tuple[Line, ...]:
    def first(mark: Mark, words: list[str], which: str) -> tuple[Line, ...]:
        more = len(words) - _LOOPS
        rest = (Line(f"{more} more {which}: in the file."),) if more > 0 else ()
        return (*marked(mark, words[:_LOOPS]), *rest)

    titles = dict.fromkeys(row.block.title for row in translation.rows)
    vendors = ", ".join(dict.fromkeys(title.split()[0] for title in titles))
    return (
        *first(Mark.POINT, [_loop_words(each) for each in translation.tunings], "loops"),
        *first(Mark.POINT, list(translation.beside), "that are added"),
        *((Line(f"Filled in for {len(titles)} blocks: {vendors}."),) if titles else ()),
        *first(Mark.REFUSED, refused, "that are not translated"),
    )


def _whole(translation: Translation, refused: list[str]) -> tuple[Line | Section, ...]:
    notes, marks = _footnotes(translation.rows)
    share = translation.saturated
    limits = f"{100.0 * share:.2g} % of its samples have an output at a limit"
    checked = Line(f"{_CHECK}; {limits if share else 'no output reaches a limit in it'}.")
    loops = [_loop(translation, tuning, marks) for tuning in translation.tunings]
    if translation.beside:
        loops.append(Section("Beside the blocks", marked(Mark.POINT, translation.beside)))
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
    shown = [f"K = {gain_words(numbers.gain, *signals)}"]
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
