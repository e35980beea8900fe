"""The documents' controllers and ours against the physical limit: in a screen, and as a page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from clepsydra.base.markdown import markdown
from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import listed, time_text
from clepsydra.papers.against_limit import BAND, AgainstLimit, Entrant, Outcome, words_of
from clepsydra.papers.document import load_document
from clepsydra.report.quantities import change_text, display_factor, number_text, short_text

#: So many of ours stand in a table, beside the one that the study recommends.
_NEAREST = 4
#: Beyond this multiple of the limit something is left to gain.
_NEAR = 1.1
#: The page but for what is computed.
_PAGE = Path(__file__).with_name("against-the-limit.md")


def limit_answer(result: AgainstLimit, *, every: bool = False) -> Section:
    """Return how near the documents' controllers and ours come to the limit.

    Parameters
    ----------
    every : bool
        Whether with the table of each experiment.
    """
    answer = Line(_answer(result.outcomes), Mark.ANSWER)
    more = (Line(""), Line("Every experiment and its controllers: --all, or on the page."))
    rest: tuple[Line | Section, ...] = _documents(result) if every else more
    return Section("", (answer, Line(""), _overview(result), *_remarks(result), *rest))


def page_text(result: AgainstLimit) -> str:
    """Return the page, in Markdown."""
    answer = Line(_answer(result.outcomes), Mark.ANSWER)
    found = {
        "answer": Section("", (answer, _experiments(result), *_remarks(result))),
        "documents": Section("", _documents(result)),
    }
    page = _PAGE.read_text("utf-8")
    for place, section in found.items():
        page = page.replace(f"<!-- {place} -->", markdown(section, depth=1))
    return page


def _overview(result: AgainstLimit) -> Table:
    """Return a table with a row for each document."""
    rows = []
    for key, outcomes in result.by_document.items():
        working = [each.published for each in outcomes if each.published]
        rows.append(
            (
                key,
                str(len(outcomes)),
                _range(working) if working else "none works",
                _range([each.recommended for each in outcomes]),
                _range([each.nearest for each in outcomes]),
            )
        )
    head = ("document", "experiments", "× published", "× recommended", "× ours")
    return Table("", head, tuple(rows))


def _experiments(result: AgainstLimit) -> Table:
    """Return a table with a row for each experiment."""
    rows = tuple(
        (
            outcome.document,
            outcome.title,
            number_text(outcome.limit),
            *map(_times, (outcome.published, outcome.recommended, outcome.nearest)),
        )
        for outcome in result.outcomes
    )
    head = ("document", "experiment", "least error [s]", "× published", "× recommended", "× ours")
    return Table("", head, rows, names=2)


def _answer(outcomes: Sequence[Outcome]) -> str:
    ahead = sum(_is_ahead(each) for each in outcomes)
    working = [each.published for each in outcomes if each.published]
    none = len(outcomes) - len(working)
    published = f"; the best of the published {_range(working)} times" if working else ""
    if none:
        published += f", and in {none} of the experiments none of them works"
    return (
        f"In {ahead} of {len(outcomes)} experiments a controller of ours comes nearer to the best "
        "possible than every published one that works. Our nearest leave "
        f"{_range(each.nearest for each in outcomes)} times the least error that any controller "
        f"could leave{published}. What the study recommends, the simplest that is good enough, is "
        f"at {_range(each.recommended for each in outcomes)} times."
    )


def _is_ahead(outcome: Outcome) -> bool:
    return outcome.published is None or outcome.nearest.times <= outcome.published.times


def _remarks(result: AgainstLimit) -> tuple[Line, ...]:
    """Return where the published are nearer than ours, and how far away ours are at worst."""
    said = [*filter(None, map(_behind, result.outcomes))]
    far = [each for each in result.outcomes if each.nearest.times > _NEAR]
    if far:
        worst = max(far, key=lambda each: each.nearest.times)
        said.append(
            f"In {len(far)} of them our nearest is still beyond {_NEAR:g} times the limit, at "
            f"worst in {_place(worst)}, at {number_text(worst.nearest.times)} times."
        )
    said += [
        f"{_place(each)}: its limit is not proved, so that it is the least error that was found."
        for each in result.outcomes
        if not each.proved
    ]
    return marked(Mark.WATCH, said)


def _behind(outcome: Outcome) -> str:
    """Return where ours are behind the document's, the recommended one or all; empty elsewhere."""
    theirs, ours = outcome.published, outcome.recommended
    if theirs is None or ours.times <= theirs.times:
        return ""
    whose = "what the study recommends"
    if not _is_ahead(outcome):
        whose, ours = "the nearest of ours", outcome.nearest
    return (
        f"{_place(outcome)}: {whose}, {ours.name}, is behind the document's "
        f"{theirs.name}, {number_text(ours.times)} against {number_text(theirs.times)} times, with "
        f"a max|S| of {number_text(ours.peak)} against {number_text(theirs.peak)}."
    )


def _documents(result: AgainstLimit) -> tuple[Section, ...]:
    found = []
    for key, outcomes in result.by_document.items():
        document = load_document(key)
        head = (Line(f"{document.reference}."), Line(words_of(document)))
        found.append(Section(document.title, (*head, *map(_experiment, outcomes))))
    return tuple(found)


def _experiment(outcome: Outcome) -> Section:
    ours = [each for each in outcome.entrants if not each.published]
    shown = [
        each
        for each in outcome.entrants
        if each.published or each.recommended or each in ours[:_NEAREST]
    ]
    rows = tuple(
        (
            each.name + " †" * each.reads_more + " ‡" * (not each.integrates),
            _whose(each),
            number_text(each.error),
            number_text(each.times),
            "unstable" if math.isinf(each.peak) else number_text(each.peak),
            _left(each),
        )
        for each in shown
    )
    table = Table("", ("controller", "whose", "error [s]", "×", "max|S|", "left"), rows, names=2)
    failures = marked(Mark.WATCH, _failures(outcome))
    return Section(outcome.title, (Line(_conditions(outcome)), table, *failures))


def _conditions(outcome: Outcome) -> str:
    steps = [
        f"{signal.name} by {change_text(size * display_factor(signal), signal.shown_unit)}"
        for signal, size in outcome.steps
    ]
    ranges = []
    for signal in outcome.inputs:
        low, high = (
            from_si(end, signal.unit, signal.shown_unit) for end in (signal.low, signal.high)
        )
        unit = unit_text(signal.shown_unit)
        ranges.append(f"{signal.name} {short_text(low)} to {short_text(high)} {unit}".strip())
    return (
        f"Steps of {listed(steps)}; {listed(ranges)}; {time_text(outcome.duration)}. The least "
        f"possible error is {number_text(outcome.limit)} s."
    )


def _failures(outcome: Outcome) -> Iterable[str]:
    """Yield how those of the document's controllers fail that do, those together that do alike."""
    alike: dict[object, list[Entrant]] = {}
    for each in outcome.entrants:
        if each.published and not each.works:
            how = (math.isinf(each.peak), *(tuple(_beyond(s)) for s in (each.left, each.swings)))
            alike.setdefault(how, []).append(each)
    for those in alike.values():
        first = those[0]
        ends = [
            f"{name} ends {_percent(each.left[name] for each in those)} of its step away"
            for name in _beyond(first.left)
        ]
        if moving := _beyond(first.swings):
            most = [max(each.swings.values()) for each in those]
            still = "still swings" if len(moving) == 1 else "still swing"
            ends.append(f"{listed(moving)} {still} over up to {_percent(most)} of the range")
        unstable = "unstable at this sampling period; " if math.isinf(first.peak) else ""
        yield f"{'; '.join(each.name for each in those)}: {unstable}{', '.join(ends)}."


def _beyond(shares: Mapping[str, float]) -> list[str]:
    return [name for name, share in shares.items() if share > BAND]


def _percent(shares: Iterable[float]) -> str:
    """Return shares as one percentage, or from the least to the most."""
    found = sorted(shares)
    ends = dict.fromkeys(number_text(100.0 * share, 2) for share in (found[0], found[-1]))
    return f"{' to '.join(ends)} %"


def _left(entrant: Entrant) -> str:
    return ", ".join(f"{name} {_percent([entrant.left[name]])}" for name in _beyond(entrant.left))


def _whose(entrant: Entrant) -> str:
    if entrant.published:
        return "published"
    return "ours, recommended" if entrant.recommended else "ours"


def _times(entrant: Entrant | None) -> str:
    return "none works" if entrant is None else number_text(entrant.times)


def _range(entrants: Iterable[Entrant]) -> str:
    """Return at how many times the limit they are, from the least to the most."""
    found = sorted(each.times for each in entrants)
    return " to ".join(dict.fromkeys(number_text(each) for each in (found[0], found[-1])))


def _place(outcome: Outcome) -> str:
    return f"{outcome.document}, {outcome.title}"
