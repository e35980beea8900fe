"""How sure a controller is on plants that are not quite the one on paper."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.errors import Finding, InputError
from clepsydra.loop.run import Run
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.spread import Spread
from clepsydra.studies.judge import negligible, usual_criteria
from clepsydra.studies.robustness.campaign import Campaign, DrawProgress
from clepsydra.studies.robustness.drawn_loops import ERROR, DrawnLoops, mean_error
from clepsydra.studies.robustness.drawn_plants import DrawnPlants, GivenPlants
from clepsydra.studies.robustness.drawn_scores import DrawnScores, Happening
from clepsydra.studies.robustness.draws import values_at
from clepsydra.studies.robustness.extremes import Extreme
from clepsydra.studies.robustness.quantiles import Quantile
from clepsydra.studies.robustness.saltelli import SaltelliDesign
from clepsydra.studies.robustness.sensitivity import Sensitivity, sensitivities
from clepsydra.studies.robustness.tally import Tally
from clepsydra.studies.trial import scores_of

if TYPE_CHECKING:
    from clepsydra.studies.robustness.cluster import Cluster

Array = NDArray[np.float64]

#: Draws without which nothing is told of a tail, and those of a sensitivity in each of its blocks.
DRAWS: int = 1000
ROWS: int = 512
#: What is scored of every output and of every input, where the scenario has what it wants.
_SCORED = ("iae", "overshoot", "peak_deviation", "total_variation", "noise_movement")


@dataclass(frozen=True, eq=False)
class Robustness:
    """What came of a controller over drawn plants.

    Attributes
    ----------
    loops : DrawnLoops
    tally : Tally
    nominal : dict
        Score to what it is on the plant itself.
    on_paper : frozenset of Happening
        What happens on the plant itself.
    sensitivity : Sensitivity or None
        From which parameters the scatter of the error comes; None if it was not asked for, or
        nothing varies.
    rows : int
        Of the design that it rests on.
    notes : tuple of str
        What is to be told of the workers that drew.
    """

    loops: DrawnLoops
    tally: Tally
    nominal: dict[str, float]
    on_paper: frozenset[Happening] = frozenset()
    sensitivity: Sensitivity | None = None
    rows: int = 0
    notes: tuple[str, ...] = ()

    @property
    def draws(self) -> int:
        """How many plants were drawn."""
        return self.tally.draws

    @property
    def plants(self) -> DrawnPlants:
        """The plants, with what is said of how uncertain they are, and their seed."""
        plants = self.loops.plants
        assert isinstance(plants, DrawnPlants)
        return plants

    @property
    def spread(self) -> Spread:
        """What varies from plant to plant, and how."""
        return self.plants.uncertainty.about(self.plants.point.process)

    @property
    def simulated(self) -> int:
        """How many of them have an admissible steady state."""
        return self.draws - self.tally.happened[Happening.INFEASIBLE]

    def quantile(self, score: str, chance: float = 0.95, event: int = 0) -> Quantile:
        """Return a quantile of a score over the plants, with its interval.

        Parameters
        ----------
        score : str
            "iae[level_1]", or "error": the mean of what ranks controllers, each over what it is on
            the plant itself.
        chance : float
            The share of plants that do not exceed it.
        event : int
            0 for the whole run, else the place of an event.

        Raises
        ------
        InputError
            There is no such score, or no plant has it.
        """
        return self._distribution(score, event).quantile(chance)

    def worst(self, score: str = ERROR) -> Extreme:
        """Return the largest value of a score and the draw that gave it.

        Raises
        ------
        InputError
            There is no such score, or no plant has it.
        """
        return self._distribution(score, 0).extremes.worst()

    def run(self, draw: int) -> Run:
        """Return the run of one draw; 0 is the plant itself.

        Raises
        ------
        InputError
            The draw has no admissible steady state.
        """
        return self.loops.run(draw)

    def values(self, draw: int) -> dict[str, float]:
        """Return what varies of a draw, SI."""
        found = self.loops.plants.values(np.array([draw]))
        return {name: float(column[0]) for name, column in found.items()}

    def as_dict(self) -> dict[str, Any]:
        """Return everything as values for JSON, scores in SI."""
        process, tally = self.loops.plants.point.process, self.tally
        shares = {what: tally.share(what) for what in Happening} if self.simulated else {}
        return {
            "process": process.name,
            "controller": self.loops.controller.name,
            "draws": tally.draws,
            "notes": list(self.notes),
            "seed": self.plants.seed,
            "uncertainty": {name: self.spread.words(name) for name in self.spread.signals},
            "no_steady_state": tally.reasons,
            "happened": {
                what.name.lower(): {
                    "count": share.count, "of": share.of, "low": share.low, "high": share.high,
                    "first_draw": tally.first.get(what), "on_paper": what in self.on_paper,
                }
                for what, share in shares.items()
            },
            "scores": {
                name: {
                    "nominal": self.nominal.get(name),
                    "median": _told(found.quantile(0.5)),
                    "95 %": _told(found.quantile(0.95)),
                    "99 %": _told(found.quantile(0.99)),
                    "worst": found.extremes.worst().value,
                    "worst_draw": found.extremes.worst().draw,
                    "mean": found.sums.of_finite().mean if found.sums.of_finite().count else None,
                }
                for name, rows in tally.scores.items()
                if (found := rows[0]) is not None
            },
            "sensitivity": None
            if self.sensitivity is None
            else {
                "score": ERROR,
                "rows": self.rows,
                "left_out": self.sensitivity.left_out,
                "first": {n: vars(i) for n, i in self.sensitivity.first.items()},
                "total": {n: vars(i) for n, i in self.sensitivity.total.items()},
            },
        }  # fmt: skip

    def _distribution(self, score: str, event: int) -> Any:
        known = self.tally.scores
        if score not in known:
            raise InputError(
                "robustness, score", score, f"one of {', '.join(known)}", "choose one of them"
            )
        found = known[score][event]
        if found is None:
            raise InputError(
                "robustness, score", Finding(f"no draw that has {score}"),
                f"one of {self.draws:,} draws with an admissible steady state",
                "; ".join(f"{n:,} draws: {words}" for words, n in self.tally.reasons.items())
                or "make the uncertainty smaller",
            )  # fmt: skip
        return found


def happened_of(drawn: DrawnScores) -> frozenset[Happening]:
    """Return what happened in any of some draws."""
    return frozenset(what for what, truths in drawn.happened.items() if truths.any())


def usual_names(
    loops: DrawnLoops, known: Collection[str] | None = None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what is scored where nobody says what, and those of it that rank controllers.

    Parameters
    ----------
    known : collection of str, optional
        The scores that a run of the plant itself has, where one was made already.
    """
    process, scenario = loops.plants.point.process, loops.scenario
    known = scores_of(loops.run(0)) if known is None else known
    judged = [key for keys in usual_criteria(process, known).values() for key in keys]
    asked = [key for key in known if key.partition("[")[0] in _SCORED]
    names = [n for n in dict.fromkeys((*judged, *asked)) if _runs(process, scenario, n)]
    return tuple(names), tuple(name for name in judged if name in names)


def yardstick_of(loops: DrawnLoops, judged: Sequence[str], drawn: DrawnScores) -> dict[str, float]:
    """Return what counts as 1 of each score that ranks controllers: what the first draw has.

    What counts as nothing where controllers are ranked is left out.
    """
    process, duration = loops.plants.point.process, loops.scenario.duration
    own = {name: float(drawn.scores[name][0, 0]) for name in judged}
    return {
        name: one
        for name, one in own.items()
        if math.isfinite(one) and one > negligible(process, name, duration)
    }


def robustness_of(
    loops: DrawnLoops,
    draws: int = DRAWS,
    *,
    scores: Sequence[str] | None = None,
    rows: int = ROWS,
    cluster: Cluster | None = None,
    state_file: Path | None = None,
    progress: Callable[[DrawProgress], None] | None = None,
) -> Robustness:
    """Return what comes of a controller over drawn plants.

    Parameters
    ----------
    loops : DrawnLoops
        Its scores are replaced.
    draws : int
    scores : sequence of str, optional
        Running scores beside those that are told in any case.
    rows : int
        Of the design of sensitivities, a power of two; 0 for none.
    cluster : Cluster, optional
        Whose workers draw; here if left out.
    state_file, progress : optional
        As for `clepsydra.studies.robustness.campaign.Campaign.run`.

    Raises
    ------
    InputError
        There is no draw, a score is unknown, or the state file is of other draws.
    """
    if draws < 1:
        raise InputError("robustness, draws", draws, "at least 1", "draw 1000, or leave it out")
    names, judged = usual_names(loops)
    whole = replace(loops, names=tuple(dict.fromkeys((*names, *(scores or ())))))
    whole = whole if cluster is None else cluster.fitted(whole)
    nominal = whole.draw(np.array([0]))
    yardstick = yardstick_of(whole, judged, nominal)
    whole = replace(whole, yardstick=yardstick)
    if yardstick:
        nominal.scores[ERROR] = mean_error(nominal, yardstick)[None]
    carrier = None if cluster is None else cluster.carry
    tally = Campaign(whole, draws).run(carrier=carrier, state_file=state_file, progress=progress)
    own = {name: float(values[0, 0]) for name, values in nominal.scores.items()}
    notes = () if cluster is None else tuple(cluster.notes)
    found = Robustness(whole, tally, own, happened_of(nominal), notes=notes)
    if rows and yardstick:
        found = replace(found, sensitivity=sensitivity_of(whole, rows), rows=rows)
    return found


def sensitivity_of(loops: DrawnLoops, rows: int) -> Sensitivity | None:
    """Return from which parameters the scatter of the error comes; None where nothing varies.

    On a design of its own (`SaltelliDesign`), in which what is correlated is one group. The noise
    is that of the plant itself in all of its draws. What is explained is the rank of the error
    among all plants: one plant in a thousand whose pump stands at its limit would otherwise hold
    nearly all of the variance, and a loop that broke is the worst of all (R. L. Iman and W. J.
    Conover, Technometrics 21, 1979, 499-509, doi:10.1080/00401706.1979.10489820).
    """
    plants = loops.plants
    assert isinstance(plants, DrawnPlants)
    spread = plants.uncertainty.about(plants.point.process)
    if not spread.factors:
        return None
    groups = {", ".join(f): r for f, r in zip(spread.factors, spread.rows, strict=True)}
    design = SaltelliDesign(groups, plants.seed, rows)
    values = values_at(spread, design.unit_numbers().T)
    given = GivenPlants(plants.point, plants.pairing, values, noise_alike=True)
    own = replace(loops, plants=given)
    numbers = np.arange(1, design.draws + 1)
    errors = [each.scores[ERROR][0] for each in own.draw_many(numbers)]
    return sensitivities(design, {ERROR: _ranks(np.concatenate(errors))})[ERROR]


def _ranks(values: Array) -> Array:
    """Return the share of values below each, equal ones in the middle; NaN where it is that."""
    ordered = np.sort(values[~np.isnan(values)])
    sides = [
        np.searchsorted(ordered, values, side="left"),
        np.searchsorted(ordered, values, side="right"),
    ]
    found = (sides[0] + sides[1]) / (2.0 * max(len(ordered), 1))
    return np.where(np.isnan(values), np.nan, found)


def _runs(process: Process, scenario: Scenario, name: str) -> bool:
    """Tell whether a score is known while a loop runs, in this scenario."""
    try:
        RunningScores(process, (name,)).inputs_of(scenario)
    except InputError:
        return False
    return True


def _told(found: Quantile) -> dict[str, float | None]:
    return {"value": found.value, "low": found.low, "high": found.high}
