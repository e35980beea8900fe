"""The processes of the documents on 10,000 drawn plants: the table of docs/robustness.md.

``python tools/documents_on_drawn_plants.py [DRAWS]``, in Markdown. Errors are those over all
setpoint steps, each over its size and added up, as a multiple of the least that any controller
could leave on the plant on paper.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

import clepsydra as cl
from clepsydra.interface.robustness import loops_of
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_scores import Happening, joined
from clepsydra.studies.robustness.shares import share_of

DRAWS = 10_000
#: Process, what its uncertainty is called, and that where it is not 10 % about each parameter.
PLANTS: tuple[tuple[str, str, Mapping[str, Any] | None], ...] = (
    ("averaging-tank", "10 %", None),
    ("eight-tanks", "10 %", None),
    ("quadruple-tank", "10 %", None),
    (
        "quadruple-tank",
        "pump gains 30 %",
        {"default": "0 %", "pump_1.gain": "30 %", "pump_2.gain": "30 %"},
    ),
    ("three-tanks", "10 %", None),
    ("laboratory-four-tanks", "10 %", None),
)
#: Beside the recommended controller, by how their names begin.
BESIDE = ("LQI", "One-step inverse", "MPC")


def times_limit(loops: DrawnLoops, limits: cl.Limits, draws: int) -> tuple[np.ndarray, int, int]:
    """Return the error of each draw over the limit, on how many it stays, and of how many."""
    process = loops.plants.point.process
    names = tuple(f"iae[{y}]" for y in process.controlled)
    asked = DrawnLoops(loops.controller, loops.scenario, loops.plants, names)
    found = joined([*asked.draw_many(np.arange(1, draws + 1))])
    places = {
        (each.signal, each.start): place
        for place, each in enumerate(asked.events, start=1)
        if each is not None
    }
    total = np.zeros(draws)
    for each in limits.proved:
        event = each.event
        place = places[event.segment.signal, event.segment.start]
        for name, size in event.sizes:
            total += found.scores[f"iae[{name}]"][place] / size
    feasible = ~found.happened[Happening.INFEASIBLE]
    steady = int(found.happened[Happening.STEADY][feasible].sum())
    return total[feasible] / limits.index, steady, int(feasible.sum())


def rows(draws: int) -> Iterator[str]:
    """Yield a row for each process and controller."""
    for name, words, uncertainty in PLANTS:
        study = cl.study(name)
        limits = cl.limit(name)
        chosen = {study.recommended.controller.name: study.recommended}
        for begin in BESIDE:
            first = next((c for c in study.ranking if c.controller.name.startswith(begin)), None)
            if first is not None:
                chosen[first.controller.name] = first
        for title, candidate in chosen.items():
            loops = loops_of(
                candidate.controller, study.plant, None,
                uncertainty=uncertainty, duration=None, seed=1,
            )  # fmt: skip
            times, steady, of = times_limit(loops, limits, draws)
            paper = limits.times(candidate.run)
            median, high = np.quantile(times, [0.5, 0.95], method="inverted_cdf")
            share = share_of(steady, of)
            yield (
                f"| {name} | {words} | {title} | {paper:.2f} | {median:.2f} | {high:.2f} "
                f"| {100 * share.value:.2g} % ({100 * share.low:.2g} to {100 * share.high:.2g} %) "
                f"| {draws - of:,} |"
            )


def main() -> None:
    """Print the table."""
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else DRAWS
    print("| process | varied | controller | on paper | median | 95 % | an error stays | no rest |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows(draws):
        print(row, flush=True)


if __name__ == "__main__":
    main()
