"""What hardware in the loop has shown, on one screen, and as values for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.base.units import unit_text
from clepsydra.deploy.proof.comparison import Difference
from clepsydra.hil.case import CASES
from clepsydra.hil.hardware_in_the_loop import HardwareInTheLoop
from clepsydra.hil.trial import Tried

_HOLDS, _FAILS = "holds", "FAILS"


def hil_answer(found: HardwareInTheLoop, *, every: bool = False) -> Section:
    """Return what holds and what does not, by PLC and wires; with `every` each case in words."""
    trials = found.tried
    failed = [
        f"{trial.label}, {CASES[name].title}: {verdict.words}."
        for trial in trials
        for name, verdict in trial.verdicts.items()
        if not verdict.holds
    ]
    failed += [f"{trial.label}: {words}" for trial in trials for words in _inexact(trial)]
    count = sum(len(trial.verdicts) for trial in trials)
    words = (
        f"{found.title} holds on its wires: all {count} cases, every bit as computed."
        if found.holds
        else f"{found.title} does not hold on its wires: see what fails below."
    )
    return Section(
        "",
        (
            Line(words, Mark.ANSWER),
            _table(trials),
            *(Line(each, Mark.WATCH) for each in failed),
            *(Line(each) for each in _said(trials)),
            *(Line(f"Without {plc}: {reason}") for plc, reason in found.left_out),
            *((_in_words(trials),) if every else ()),
        ),
    )


def _table(trials: tuple[Tried, ...]) -> Table:
    def mark(holds: bool) -> str:
        return _HOLDS if holds else _FAILS

    rows = [
        (case.title, *(mark(trial.verdicts[name].holds) for trial in trials))
        for name, case in CASES.items()
    ]
    rows += [
        ("law as simulated", *(mark(each.evidence.is_law) for each in trials)),
        ("plant as simulated", *(mark(each.evidence.is_plant) for each in trials)),
        ("values on the wires", *(mark(each.evidence.is_carried) for each in trials)),
    ]
    return Table("", ("", *(each.label for each in trials)), tuple(rows))


def _inexact(trial: Tried) -> list[str]:
    evidence, found = trial.evidence, []
    parts = (("law", evidence.law, evidence.is_law), ("plant", evidence.plant, evidence.is_plant))
    for what, difference, holds in parts:
        if not holds:
            found.append(
                f"the {what} differs from the simulation in {difference.differing} numbers, by up "
                f"to {100 * difference.largest:.2g} % of {difference.signal}."
            )
    if not evidence.is_carried:
        found.append(
            f"{evidence.wires.misread} values were read otherwise than they were told, and "
            f"{evidence.wires.foreign} commands stood that nobody had written."
        )
    return found


def _said(trials: tuple[Tried, ...]) -> list[str]:
    """Return the lines about time and about the distance to the simulation."""
    timings = [trial.timing for trial in trials]
    period = 1000 * max(each.period for each in timings)
    latest, usual = (1000 * max(each.lateness[place] for each in timings) for place in (2, 0))
    scan, long = (1000 * max(each.evidence.took[place] for each in trials) for place in (0, 1))
    late, unseen = sum(each.late for each in timings), sum(each.unseen for each in timings)
    samples = sum(each.samples for each in timings)
    lines = [
        f"A sample each {period:g} ms: the plant {usual:.2g} ms late as a rule, {latest:.2g} ms at "
        f"most; a scan takes {scan:.2g} ms, 99 % of them up to {long:.2g} ms.",
        f"Of {samples} samples {late} were answered late and {unseen} not at all, in the cases "
        "that compare with a simulation in which every scan is in time:",
    ]
    return [*lines, *(f"  {trial.label}: {_distance(trial)}" for trial in trials)]


def _distance(trial: Tried) -> str:
    away = zip(trial.evidence.deviations, trial.evidence.steps, strict=True)
    measured = [(each, step) for each, step in away if each.tag.judged_by]
    worst, step = max(measured, key=lambda one: one[0].largest / one[0].tag.signal.percent_span)
    unit = unit_text(worst.tag.signal.unit)
    if worst.largest == 0.0:
        return "every measurement as simulated, in every bit"
    steps = f"; the wires show steps of {step:.2g} {unit}" if step else ""
    return f"{worst.tag.label} at most {worst.largest:.2g} {unit} from it{steps}"


def _in_words(trials: tuple[Tried, ...]) -> Section:
    parts = tuple(
        Section(
            f"{trial.plc}, {trial.wires}",
            tuple(Line(f"{CASES[n].title}: {v.words}.") for n, v in trial.verdicts.items()),
        )
        for trial in trials
    )
    return Section("Every case", parts)


def hil_data(found: HardwareInTheLoop) -> dict[str, Any]:
    """Return all of it as values for JSON."""
    return {
        "title": found.title,
        "holds": found.holds,
        "tried": [_trial_data(trial) for trial in found.tried],
        "left_out": [{"plc": plc, "reason": reason} for plc, reason in found.left_out],
    }


def _trial_data(trial: Tried) -> dict[str, Any]:
    timing, evidence = trial.timing, trial.evidence
    check = evidence.wires
    return {
        "plc": trial.plc,
        "wires": trial.wires,
        "holds": trial.holds,
        "cases": [
            {"case": name, "holds": verdict.holds, "words": verdict.words}
            for name, verdict in trial.verdicts.items()
        ],
        "law": _difference(evidence.law),
        "plant": _difference(evidence.plant),
        "wires_carried": asdict(check),
        "deviations": [
            {"tag": each.tag.name, "largest": each.largest, "unit": each.tag.signal.unit,
             "step": step, "sample": each.sample}
            for each, step in zip(evidence.deviations, evidence.steps, strict=True)
        ],
        "scans": {
            "count": evidence.scans, "off": evidence.off, "left_out": evidence.left_out,
            "lost": list(evidence.lost), "lateness": list(evidence.lateness),
            "took": list(evidence.took),
        },
        "timing": {
            "period": timing.period, "lateness": list(timing.lateness), "late": timing.late,
            "unseen": timing.unseen, "samples": timing.samples,
        },
    }  # fmt: skip


def _difference(found: Difference) -> dict[str, Any]:
    return {"differing": found.differing, "largest": found.largest, "signal": found.signal}
