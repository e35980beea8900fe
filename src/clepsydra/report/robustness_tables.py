"""Scores over drawn plants, what their scatter comes from, and what varies, as tables."""

from __future__ import annotations

from clepsydra.base.section import Table
from clepsydra.report.overlay import event_title
from clepsydra.report.quantities import quantity_text
from clepsydra.report.score_tables import score_text
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.robustness.distribution import Distribution
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.robustness import Robustness

#: What is told of an answer, in its order, and of each event.
_SHORT = ("iae", "overshoot", "total_variation")
_OF_EVENTS = {"setpoint": ("iae",), "load": ("iae", "peak_deviation")}
_ENDS = (0.5, 0.95)
#: Of the parameters of a plant: those that differ most, and those that matter most.
_EXTREME, _CAUSES = 5, 2


def scores_table(found: Robustness, most: int | None = None) -> Table:
    """Return the scores over the plants, each with the draw that is worst in it.

    Parameters
    ----------
    most : int, optional
        So many rows, of what says most, without a title; else all.
    """
    names = [name for name in found.tally.scores if name != ERROR]
    if most is not None:
        chosen = [name for name in names if score_key(name).score in _SHORT]
        names = sorted(chosen, key=lambda name: _SHORT.index(score_key(name).score))[:most]
    rows = []
    for name in names:
        whole = found.tally.scores[name][0]
        if whole is not None:
            title, cells = _cells(found, name, whole, found.nominal[name])
            rows.append((title, *cells, str(whole.extremes.worst().draw)))
    head = ("score", "on paper", "median", "95 %", "worst", "in draw")
    title, kept = ("Scores over the plants", 0) if most is None else ("", len(head) - 1)
    return Table(title, head, tuple(rows), kept=kept)


def events_table(found: Robustness) -> Table:
    """Return what controlled measurements make of each event."""
    process = found.plants.point.process
    rows = []
    for place, segment in enumerate(found.loops.events, 1):
        if segment is None or segment.kind not in _OF_EVENTS:
            continue
        for name, parts in found.tally.scores.items():
            part = parts[place] if len(parts) > place else None
            if part is not None and score_key(name).score in _OF_EVENTS[segment.kind]:
                title, cells = _cells(found, name, part)
                rows.append((event_title(process, segment), title, *cells))
    head = ("event", "score", "median", "95 %", "worst")
    return Table("Scores of each event", head, tuple(rows), names=2)


def causes_table(found: Robustness) -> Table:
    """Return the indices of every group of parameters; no rows where they are not known."""
    sensitivity, rows = found.sensitivity, []
    if sensitivity is not None and sensitivity.varies:
        ordered = sorted(sensitivity.total, key=lambda name: -sensitivity.total[name].value)
        rows = [(n, str(sensitivity.total[n]), str(sensitivity.first[n])) for n in ordered]
    head = ("parameter", "with all that it acts with", "alone")
    return Table("What the scatter of the error comes from", head, tuple(rows))


def varied_table(found: Robustness) -> Table:
    """Return what varies, and how."""
    spread = found.spread
    rows = [
        (name, quantity_text(signal, signal.initial, 4), spread.words(name))
        for name, signal in spread.signals.items()
    ]
    return Table("What varies", ("parameter", "on paper", "is"), tuple(rows))


def differences_table(found: Robustness, draw: int) -> Table:
    """Return the parameters of a draw that are farthest from paper, and those that matter most.

    Farthest is what differs by the largest share of it.
    """
    signals, values = found.spread.signals, found.values(draw)
    shares = {
        n: values[n] / signal.initial - 1.0 for n, signal in signals.items() if signal.initial
    }
    farthest = sorted(shares, key=lambda name: -abs(shares[name]))[:_EXTREME]
    total = {} if found.sensitivity is None else found.sensitivity.total
    matters = {n: index for names, index in total.items() for n in names.split(", ")}
    most = sorted(shares.keys() & matters.keys(), key=lambda name: -matters[name].value)[:_CAUSES]
    rows = [
        (
            name,
            quantity_text(signals[name], signals[name].initial),
            quantity_text(signals[name], values[name]),
            f"{100.0 * shares[name]:+.1f} %".replace("-", "−"),
            f"{100.0 * matters[name].value:.0f} %" if name in matters else "",
        )
        for name in dict.fromkeys((*farthest, *most))
    ]
    head = ("parameter", "on paper", f"draw {draw}", "from paper", "of the scatter")
    return Table("What is different in it", head, tuple(rows))


def _cells(
    found: Robustness, name: str, told: Distribution, on_paper: float | None = None
) -> tuple[str, list[str]]:
    """Return a score with its unit, and its median, 95 % and worst, that on paper before them."""
    process, duration = found.plants.point.process, found.loops.scenario.duration
    score, signal = score_key(name)
    quantiles = [told.quantile(chance).value for chance in _ENDS]
    values = [*([] if on_paper is None else [on_paper]), *quantiles, told.extremes.worst().value]
    texts = [score_text(process, signal, value, SCORES[score], duration) for value in values]
    unit = next((unit for _, unit in texts if unit), "")
    title = f"{score_title(name)} [{unit}]" if unit else score_title(name)
    return title, [number for number, _ in texts]


def score_title(name: str) -> str:
    """Return what a score of a signal is called.

    Examples
    --------
    >>> score_title("iae[level_1]")
    'IAE of level_1'
    """
    score, signal = score_key(name)
    return f"{SCORES[score].title} of {signal}"
