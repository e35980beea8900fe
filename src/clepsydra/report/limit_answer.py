"""What the physical limit of a plant is, in a screen."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.units import unit_text
from clepsydra.base.words import listed, share_text, time_text
from clepsydra.limits.limit import TOLERANCE, Limit
from clepsydra.limits.limits import Limits
from clepsydra.report.limit_picture import limit_picture
from clepsydra.report.quantities import (
    change_text,
    display_factor,
    number_text,
    settled,
    time_cell,
)
from clepsydra.report.ranking_rows import TIMES
from clepsydra.studies.result import Candidate, StudyResult

#: What of an error counts as none beside the others of its event.
_NOTHING = 1e-3
#: A change beyond this share says no more than that there is none to rely on.
_ANY = 10.0
#: Each proof: what failed, in words that say what it may be worth.
_FAILED = {
    "grid": "finer blocks of the input change it",
    "horizon": "twice the time to come to rest changes it",
    "starts": "a search that begins elsewhere changes it",
    "replay": "simulating the input that was found changes it",
    "smoothing": "rounding the kinks of the equations less changes it",
}


def limit_answer(limits: Limits) -> Section:
    """Return the limit of each event, what proves it, and for which events there is none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> found = cl.limit("quadruple-tank", [cl.step("level_1", "+1 V")])
    >>> limit_answer(found).parts[0].text[:58]
    'No controller can do better on Quadruple tank, minimum pha'
    """
    parts: list[Line | Table] = [Line(_answer(limits), Mark.ANSWER)]
    if limits.found:
        parts += [Line(""), _table(limits)]
    return Section("", (*parts, *_remarks(limits)))


def limit_words(result: StudyResult, candidate: Candidate) -> str:
    """Return how far a controller is from the physical limit; empty where that is not known."""
    times = result.times_limit(candidate)
    if times is None:
        return ""
    return (
        f"Over the setpoint steps the error of {candidate.controller.title} is "
        f"{number_text(times)} times the least that any controller could leave."
    )


def beside_limit(result: StudyResult, advised: Candidate | None, most: int) -> Section:
    """Return how far the recommended controller and the first of a ranking are from the limit.

    Parameters
    ----------
    advised : Candidate or None
    most : int
        So many rows.
    """
    limits = result.limits
    if limits is None or not result.ranking:
        return Section("")
    parts: list[Line | Table] = []
    if limits.proved:
        words = limit_words(result, advised or result.ranking[0])
        rows = [
            (str(each.rank), each.controller.name, number_text(result.times_limit(each) or 0.0))
            for each in result.ranking[:most]
        ]
        parts += [Line(words, Mark.ANSWER), Line("")]
        parts.append(Table("", ("", "controller", TIMES), tuple(rows), names=2))
    return Section("", (*parts, *_remarks(limits)))


def limit_sections(result: StudyResult, first: Sequence[Candidate]) -> list[Section]:
    """Return what a report tells of the limit, with its course behind that of a controller."""
    limits = result.limits
    if limits is None or not first:
        return []
    picture = limit_picture(result, first[0], limits)
    words = limit_words(result, first[0])
    parts: list[Line | Table | Picture | Section] = [Line(words)] if words else []
    parts += [] if picture is None else [picture]
    return [Section("The best that any controller could do", (*parts, *limit_answer(limits).parts))]


def _answer(limits: Limits) -> str:
    title = limits.process.title
    if not limits.found:
        return f"There is no physical limit to tell for {title}."
    if not limits.proved:
        return (
            f"No limit is proved for {title}: these errors are the least that were found, and "
            "count for nothing."
        )
    steps = len(limits.proved)
    over = "this setpoint step" if steps == 1 else f"these {steps} setpoint steps"
    return (
        f"No controller can do better on {title}: over {over} the absolute error adds up to at "
        f"least {number_text(limits.index)} s × step, without noise."
    )


def _remarks(limits: Limits) -> tuple[Line, ...]:
    """Return which limits are not proved, and for which events there is none."""
    reasons: dict[str, list[str]] = {}
    for each in limits.refused:
        reasons.setdefault(each.reason, []).append(each.segment.signal)
    return (
        *marked(Mark.WATCH, [words for each in limits.found for words in _doubts(each)]),
        *marked(
            Mark.REFUSED,
            (
                f"No limit for setpoint steps of {listed(list(dict.fromkeys(names)))}: {reason}."
                for reason, names in reasons.items()
            ),
        ),
    )


def _table(limits: Limits) -> Table:
    outputs = limits.found[0].event.outputs
    rows = []
    for each in limits.found:
        segment = each.event.segment
        signal = limits.process.signal(segment.signal)
        step = change_text(segment.size * display_factor(signal), signal.shown_unit)
        rows.append(
            (
                f"{segment.signal} {step}",
                time_cell(segment.start),
                *(_error(limits, each, name) for name in outputs),
                number_text(each.index),
                time_text(each.horizon),
                _proved(each),
            )
        )
    errors = (f"IAE {name}" for name in outputs)
    head = ("event", "at", *errors, "IAE/step [s]", "horizon", "proved within")
    return Table("", head, tuple(rows))


def _error(limits: Limits, limit: Limit, name: str) -> str:
    signal, step = limits.process.signal(name), dict(limit.event.sizes)[name]
    least = _NOTHING * limit.index * step
    value = settled(limit.errors[name], least) * display_factor(signal)
    return f"{number_text(value)} {unit_text(signal.shown_unit)} s".replace("  ", " ")


def _proved(limit: Limit) -> str:
    """Return the largest of what the proofs change a limit by."""
    known = [abs(value) for value in limit.proofs.named.values() if value is not None]
    return share_text(max(max(known), 1e-4)) if limit.accepted else "not proved"


def _amount(change: float | None) -> str:
    if change is None:
        return "an unknown amount"
    return share_text(abs(change)) if abs(change) < _ANY else f"more than {share_text(_ANY)}"


def _doubts(limit: Limit) -> list[str]:
    segment = limit.event.segment
    return [
        f"{segment.signal} at {time_text(segment.start)}: {_FAILED[name]} by "
        f"{_amount(value)}, where at most {share_text(TOLERANCE)} is allowed."
        for name, value in limit.proofs.named.items()
        if name in limit.proofs.failed
    ]
