"""The tuning of a controller's PID loops for every vendor's block, each checked by simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.markdown import markdown
from clepsydra.controllers.controller import Controller
from clepsydra.deploy.tagged import process_tagging
from clepsydra.deploy.vendor_tuning.answer import tuning_answer
from clepsydra.deploy.vendor_tuning.check import Check
from clepsydra.deploy.vendor_tuning.filling import Applied, Filled, filled
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning, standard_tunings
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK, VendorBlock
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process


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
    refused : tuple of (str, str, str)
        Loop, block and the reason; the block is empty where the loop has no tuning at all.
    saturated : float
        Share of the samples of the check in which an output is at a limit.
    """

    controller: str
    process: str
    tunings: tuple[StandardTuning, ...]
    rows: tuple[TranslatedLoop, ...]
    refused: tuple[tuple[str, str, str], ...]
    saturated: float

    def as_markdown(self) -> str:
        """Return all of it as Markdown."""
        return markdown(tuning_answer(self, every=True), 1) + "\n"

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain values, for JSON."""
        return {
            "controller": self.controller,
            "process": self.process,
            "saturated_share": self.saturated,
            "loops": [_loop_dict(self, tuning) for tuning in self.tunings],
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
        controller.title, plant.name, tuple(tunings), tuple(rows), tuple(refused), check.saturated()
    )


def _of(tuning: StandardTuning, differences: dict[str, float]) -> float:
    if not tuning.direct:
        return max(differences.values())
    return differences[tuning.moved.name]


def _loop_dict(translation: Translation, tuning: StandardTuning) -> dict[str, Any]:
    numbers = tuning.settings
    return {
        "loop": tuning.title,
        "action": tuning.action,
        "gain": numbers.gain * tuning.engineering_factor,
        "gain_unit": tuning.engineering_unit,
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
