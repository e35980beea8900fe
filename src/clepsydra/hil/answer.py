"""What hardware in the loop has shown, on one screen, and as values for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.base.units import unit_text
from clepsydra.base.words import listed
from clepsydra.deploy.proof.comparison import Difference
from clepsydra.hil.case import CASES
from clepsydra.hil.hardware_in_the_loop import HardwareInTheLoop
from clepsydra.hil.ideal import Deviation
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
    exactly = all(trial.evidence.law.differing == 0 for trial in trials)
    computed = "every bit as computed" if exactly else "but for a library's last bits as computed"
    words = (
        f"{found.title} holds on its wires: all {count} cases, {computed}."
        if found.holds
        else f"{found.title} does not hold on its wires: see what fails below."
    )
    return Section(
        "",
        (
            Line(words, Mark.ANSWER),
            _table(trials),
            *(Line(each, Mark.WATCH) for each in [*failed, *_too_fast(trials)]),
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
        *_distances(trials),
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
    if evidence.wires.misread:
        found.append(f"values read otherwise than they were told: {evidence.wires.misread}.")
    if evidence.wires.foreign:
        found.append(f"commands that stood and that nobody had written: {evidence.wires.foreign}.")
    return found


def _too_fast(trials: tuple[Tried, ...]) -> list[str]:
    """Return what to do where something failed and the clocks were not met either."""
    hasty = [each.label for each in trials if not each.holds and not each.timing.is_met]
    if not hasty:
        return []
    return [
        f"{listed(hasty)}: samples went amiss, so this machine was too slow or too busy; try a "
        "smaller --speed."
    ]


def _said(trials: tuple[Tried, ...]) -> list[str]:
    """Return the lines about time and about the distance to the simulation."""
    timings = [trial.timing for trial in trials]
    periods = dict.fromkeys(_milliseconds(each.period) for each in timings)
    usual, latest = (max(each.lateness[place] for each in timings) for place in (0, 2))
    scan, long = (max(each.evidence.took[place] for each in trials) for place in (0, 1))
    late, unseen = sum(each.late for each in timings), sum(each.unseen for each in timings)
    samples = sum(each.samples for each in timings)
    return [
        f"A sample each {' or '.join(periods)}: the plant {_milliseconds(usual)} late as a rule, "
        f"{_milliseconds(latest)} at most; a scan takes {_milliseconds(scan)}, 99 % of them up to "
        f"{_milliseconds(long)}.",
        "Off by: how far from the simulation, in which every scan is in time and exact, in the "
        f"first four cases; of their {samples} samples {late} were answered late and {unseen} not "
        "at all.",
    ]


def _milliseconds(time: float) -> str:
    return f"{float(f'{1000 * time:.2g}'):g} ms"


def _distances(trials: tuple[Tried, ...]) -> list[tuple[str, ...]]:
    """Return how far measurement and output that went farthest were from the simulation."""
    away = [
        {each.tag.name: (each, step) for each, step in zip(e.deviations, e.steps, strict=True)}
        for e in (trial.evidence for trial in trials)
    ]
    rows = []
    for is_measured in (True, False):
        names = [name for name, (d, _) in away[0].items() if bool(d.tag.judged_by) is is_measured]
        name = max(names, key=lambda each: max(_share(found[each][0]) for found in away))
        tag = away[0][name][0].tag
        unit = unit_text(tag.signal.unit)
        found = [f"{by[name][0].largest:.2g}" for by in away]
        rows.append((f"{tag.label} off by, {unit}", *found))
        if is_measured:
            steps = [f"{by[name][1]:.2g}" if by[name][1] else "none" for by in away]
            on_wires = (f"its step on the wires, {unit}", *steps)
    return [rows[0], on_wires, rows[1]]


def _share(found: Deviation) -> float:
    return found.largest / found.tag.signal.percent_span


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
            {"case": name, "holds": verdict.holds, "words": verdict.words,
             "samples": list(trial.windows[name])}
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
