"""The page of a controller on many plants: its answer, its pictures, and every number."""

from __future__ import annotations

from clepsydra.base.section import Line, Picture, Section, Table
from clepsydra.base.words import time_text
from clepsydra.report.causes_picture import causes_figure
from clepsydra.report.distribution_picture import distribution_figure
from clepsydra.report.facts import facts_table
from clepsydra.report.fan_picture import fan_figure
from clepsydra.report.html import address_text, versions_text
from clepsydra.report.page import page_text, svg_text
from clepsydra.report.plant_axes import settle
from clepsydra.report.replay_picture import replay_figure
from clepsydra.report.robustness_answer import answer_lines, robustness_title, scatters
from clepsydra.report.robustness_tables import (
    causes_table,
    differences_table,
    events_table,
    scores_table,
    varied_table,
)
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.fan import DRAWS, fan_of
from clepsydra.studies.robustness.robustness import Robustness

_FAN = (
    "Bands: where 90 % and half of {} plants are, at each instant by itself, so that no plant need "
    "follow an edge; black: the plant on paper; dashed: the setpoint. One column for the first "
    "event of each kind, as long as the plants need to come to rest. Inputs differ from the "
    "beginning, since each plant needs its own to hold the same measurements."
)
_REPLAY = "The whole scenario on the plant with the largest error, draw {}, and on paper."
_SELDOM = (
    "A parameter far from paper is no cause by itself. In Python run({}) of the result is this run "
    "again, and values({}) has all of its parameters."
)
_CAUSES = (
    "Bar: the share of the scatter that would stay if all other parameters were measured exactly, "
    "this one with all that it acts with; a parameter with a short bar need not be known better. "
    "Mark: the share that would go, on average, if this parameter alone were measured. A bar far "
    "beyond its mark acts together with others. The line is the interval of the bar. What is "
    "shared is the scatter of a plant's rank among all plants by error, so that a few plants with "
    "a very large error do not hold all of it."
)
_DISTRIBUTED = (
    "How many of the plants have an error at most so large. Marked: half, 95 % and 99 % of the "
    "plants, each with the interval that holds it in 19 of 20 repetitions with other draws."
)
_SURE = (
    "A share in brackets is Wilson's interval, the bounds of a quantile are two other draws of the "
    "same order, and those of a cause are a bootstrap over the rows of its design: each holds in "
    "19 of 20 repetitions. A worst draw has none: more draws find a worse one."
)


def robustness_text(found: Robustness) -> str:
    """Return the page of a controller on many plants as HTML."""
    parts: list[Line | Table | Picture | Section] = [*answer_lines(found, every=True)]
    if found.simulated:
        fan = fan_of(found.loops, min(found.draws, DRAWS))
        words = f"What {found.loops.controller.title} does on {fan.draws:,} plants"
        picture = svg_text(settle(fan_figure(found.loops, fan)), words, "fan")
        parts.append(Picture(picture, _FAN.format(f"{fan.draws:,}")))
        if ERROR in found.tally.scores:
            parts += [_worst(found), *_causes(found), _distributed(found)]
        tables = tuple(t for t in (scores_table(found), events_table(found)) if t.rows)
        parts.append(Section("Scores", (*tables, Line(_SURE))))
    varied = varied_table(found)
    if varied.rows:
        parts.append(Section("What varies", (varied,), folded=True))
    parts.append(Section("How this was computed", (facts_table("", _facts(found)),)))
    return page_text(Section(robustness_title(found), tuple(parts)))


def _worst(found: Robustness) -> Section:
    """Return the worst plant beside the one on paper, and what is different in it."""
    draw = found.worst().draw
    figure = replay_figure(found.run(draw), found.run(0), f"draw {draw}")
    svg = svg_text(settle(figure), f"Draw {draw} beside the plant on paper", "worst")
    differences = differences_table(found, draw)
    parts: list[Line | Table | Picture] = [Picture(svg, _REPLAY.format(draw))]
    parts += [differences] if differences.rows else []
    return Section("The worst plant", (*parts, Line(_SELDOM.format(draw, draw))))


def _causes(found: Robustness) -> list[Section]:
    """Return from which parameters the scatter comes, where that is known."""
    if found.sensitivity is None or not scatters(found):
        return []
    figure = settle(causes_figure(found.sensitivity))
    svg = svg_text(figure, "Which parameter matters", "causes")
    folded = Section("All parameters", (causes_table(found),), folded=True)
    return [Section("Which parameter matters", (Picture(svg, _CAUSES), folded))]


def _distributed(found: Robustness) -> Section:
    whole = found.tally.scores[ERROR][0]
    assert whole is not None  # some plant was simulated
    figure = settle(distribution_figure(whole))
    svg = svg_text(figure, "How the error is distributed", "distribution")
    return Section("How the error is distributed", (Picture(svg, _DISTRIBUTED),))


def _facts(found: Robustness) -> list[tuple[str, str]]:
    loops, tally = found.loops, found.tally
    process, scenario = found.plants.point.process, loops.scenario
    period = time_text(process.sampling_period, 4)
    sensitivity = found.sensitivity
    return [
        ("process file", address_text(process)),
        ("controller", loops.controller.title),
        ("draws", f"1 to {tally.draws:,} of the seed {found.plants.seed}"),
        *([] if sensitivity is None else [("rows of the design of causes", f"{found.rows:,}")]),
        (
            "scenario",
            f"{time_text(scenario.duration, 4)}, {scenario.samples:,} samples of {period}",
        ),
        ("integration", f"at most {tally.substeps} steps a sampling period"),
        ("versions", versions_text()),
    ]
