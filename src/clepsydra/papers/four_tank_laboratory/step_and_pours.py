"""What Tables 5 and 6 share: their printed numbers, their rows and the figures beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clepsydra.papers.comparison import compared
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_laboratory.closed_loop import TARGET, Kind, Runs, runs
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, NON_MINIMUM, Holes, SetUp, Units
from clepsydra.papers.row import Row

#: The report shows one run, so that what noise does to most runs is left open.
_CENTRAL = (0.025, 0.975)


@dataclass(frozen=True)
class Printed:
    """One line of Table 5 or 6, for tank 1 and tank 2; where one number stands, for both.

    Parameters
    ----------
    rise, overshoot, recovery : tuple of str
        [s], [%], [s]
    """

    rise: tuple[str, str]
    overshoot: tuple[str, str]
    recovery: tuple[str, str]


TABLES: dict[Kind, tuple[str, dict[SetUp, Printed]]] = {
    "decentralised": (
        "Table 5",
        {
            MINIMUM: Printed(("6.3", "6.3"), ("15.17", "17.11"), ("46", "46")),
            NON_MINIMUM: Printed(("29.4", "32.6"), ("6.67", "27.98"), ("85.75", "104.8")),
        },
    ),
    "robust": (
        "Table 6",
        {
            MINIMUM: Printed(("6.6", "6.6"), ("11.63", "15.58"), ("27.15", "27.15")),
            NON_MINIMUM: Printed(("103.1", "81.5"), ("0.83", "1.78"), ("83.89", "83.89")),
        },
    ),
}
_FIGURES = {
    ("decentralised", MINIMUM): "Fig. 7",
    ("decentralised", NON_MINIMUM): "Fig. 8",
    ("robust", MINIMUM): "Fig. 9",
    ("robust", NON_MINIMUM): "Fig. 10",
}
#: What is scored, in which unit, how.
SCORES: tuple[tuple[str, str, Callable[[Runs, int], np.ndarray]], ...] = (
    ("rise", "s", Runs.rise),
    ("overshoot", "%", Runs.overshoot),
    ("recovery", "s", Runs.recovery),
)


def median(
    score: str, set_up: SetUp, kind: Kind, tank: int, units: Units = "percent",
    holes: Holes = "report",
) -> float:  # fmt: skip
    """Return the median of a score over the seeds; tank counts from one.

    Examples
    --------
    >>> [median("rise", each, "decentralised", 1) < 10.0 for each in (MINIMUM, NON_MINIMUM)]
    [True, False]
    """
    scored = next(function for name, _, function in SCORES if name == score)
    return float(np.median(scored(runs(set_up, kind, units, holes), tank - 1)))


def table_rows(kind: Kind) -> list[Row]:
    """Return the rows of Table 5 or 6, beside what the same controllers do in volts."""
    place, lines = TABLES[kind]
    rows = []
    for set_up, line in lines.items():
        found = runs(set_up, kind, "percent")
        for score, unit, function in SCORES:
            printed: tuple[str, str] = getattr(line, score)
            for tank in (1, 2):
                values = function(found, tank - 1)
                value = float(np.median(values))
                low, high = (float(q) for q in np.quantile(values, _CENTRAL))
                # One run is shown, which may lie as far off as most of ours do on that side.
                reach = high - value if float(printed[tank - 1]) > value else value - low
                others = f"In volts it is {median(score, set_up, kind, tank, 'volts'):.3g} {unit}"
                if set_up is MINIMUM:
                    fitted = median(score, set_up, kind, tank, "percent", "fitted")
                    others += f", with the fitted holes in percent {fitted:.3g} {unit}"
                both = "; one number stands for both tanks" if printed[0] == printed[1] else ""
                spread = f"95 % of {len(values)} runs from {low:.3g} to {high:.3g} {unit}"
                rows.append(
                    compared(
                        place, f"{score} {tank}, {set_up.phase}", printed[tank - 1], value, unit,
                        tolerance=reach / value if value else 0.0,
                        why=f"Median in percent, {spread}, which is left open. {others}.",
                        unprinted="The controller is not printed, nor how the figure was read"
                        f"{both}. Ours is a design by the stated rules; {spread}. {others}.",
                    )
                )  # fmt: skip
    return rows


def table_figures(kind: Kind) -> list[Figure]:
    """Return the runs of Figs. 7 and 8, or 9 and 10: levels and pumps of one seed."""
    figures = []
    for set_up in (MINIMUM, NON_MINIMUM):
        found = runs(set_up, kind, "percent")
        time = found.time
        target = Curve("reference", time[[0, -1]], np.full(2, 100.0 * TARGET), "dashed")
        levels = [Curve(f"tank {tank}", time, 100.0 * found.levels[tank - 1, 0]) for tank in (1, 2)]
        pumps = [Curve(f"pump {pump}", time, 100.0 * found.pumps[pump - 1, 0]) for pump in (1, 2)]
        name = "Decentralised PI" if kind == "decentralised" else "Glover-McFarlane"
        figures.append(
            Figure(
                _FIGURES[kind, set_up],
                f"{name}, both references 60 %, then pours into tank 1 and tank 2, {set_up.phase}",
                (
                    Panel("", "level [% of 25 cm]", (target, *levels)),
                    Panel("", "pump [% of 15 V]", tuple(pumps)),
                ),
                "One seed of the simulator's noise, from empty tanks.",
            )
        )
    return figures
