"""`cl.batch`: a controller over many plants, with the scores of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController
from clepsydra.interface.given_draws import given_plants
from clepsydra.interface.quantities import Quantity
from clepsydra.interface.robustness import loops_of
from clepsydra.interface.run import Run
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import Subject
from clepsydra.studies.robustness.campaign import DrawProgress
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_scores import DrawnScores, joined
from clepsydra.studies.robustness.robustness import DRAWS, usual_names

if TYPE_CHECKING:
    import pandas
    import xarray

    from clepsydra.base.section import Section
    from clepsydra.interface.events import Events


@dataclass(frozen=True, eq=False, repr=False)
class Batch(Answered):
    """Scores of every draw: `to_xarray()`, `to_pandas()`, `run(draw)`, `drawn`.

    Parameters
    ----------
    loops : DrawnLoops
    drawn : DrawnScores
    """

    loops: DrawnLoops
    drawn: DrawnScores

    def answer(self) -> Section:
        """Return how many draws there are, what happened, and the quantiles of each score."""
        from clepsydra.report.batch_answer import batch_answer

        return batch_answer(self.loops, self.drawn)

    def run(self, draw: int) -> Run:
        """Return the run of one draw with its trajectories; 0 is the plant itself.

        Raises
        ------
        InputError
            The draw has no admissible steady state.
        """
        return lifted(Run, self.loops.run(draw))

    def to_xarray(self) -> xarray.Dataset:
        """Return scores over events and draws, and what varies over draws, with their units.

        A score is infinite where the loop broke, and not a number where a draw has no admissible
        steady state, whose `reason` is told.
        """
        from clepsydra.report.batch_data import dataset_of

        return dataset_of(self.loops, self.drawn)

    def to_pandas(self) -> pandas.DataFrame:
        """Return a row for each draw: what varies, the scores of the whole run, what happened."""
        found = self.to_xarray().isel(event=0, drop=True).to_dataframe()
        return found


@keywords_checked()
def batch(
    plant: Subject,
    controller: AnyController,
    events: Events | None = None,
    *,
    draws: int | Mapping[str, Any] = DRAWS,
    uncertainty: Mapping[str, Any] | None = None,
    scores: Sequence[str] | None = None,
    duration: Quantity | None = None,
    seed: int = 1,
    progress: Callable[[DrawProgress], None] | None = None,
) -> Batch:
    """Run one controller over many plants side by side, and keep the scores of each.

    Each starts at its own rest, its controlled measurements where those of the plant itself are,
    and its controller without a bump.

    Parameters
    ----------
    plant : Plant, str or Path
    controller : Controller
    events, duration : optional
        The scenario, as for `cl.simulate`; the default scenario if left out, with noise of its own
        in each draw.
    draws : int or mapping
        How many plants are drawn from the uncertainty; or what varies, each with a value for every
        plant: a parameter or a disturbance of the process, a state where it begins elsewhere than
        at rest, {"tank_1.area": ["27 cm^2", "28 cm^2"]}, or numbers in display units; or a
        parameter of the law by its name in `Controller.values`, in SI.
    uncertainty : mapping, optional
        As for `cl.robustness`.
    scores : sequence of str, optional
        "iae[level_1]"; those that `cl.robustness` tells if left out.
    seed : int
        Of the draws, and of the noise of the default scenario.
    progress : callable, optional
        Takes how far it is, after each chunk of draws.

    Returns
    -------
    Batch

    Raises
    ------
    InputError
        There is no draw, columns have different lengths, or a name, a value, a score or a
        distribution cannot be used.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> areas = {"tank_3.area": ["120 cm^2", "154 cm^2", "190 cm^2"]}
    >>> found = batch(plant, cl.design.simc(plant), draws=areas, scores=["overshoot[level_3]"])
    >>> found.to_xarray()["overshoot[level_3]"].sel(event="whole run").round(1).values
    array([0. , 0. , 0.2])
    """
    loops = loops_of(
        controller, plant, events, uncertainty=uncertainty, duration=duration, seed=seed
    )
    if isinstance(draws, Mapping):
        if uncertainty is not None:
            raise InputError(
                "batch, uncertainty", "given", "none where draws say what varies", "leave it out"
            )
        plants = given_plants(loops, draws)
        loops, count = replace(loops, plants=plants), plants.count
    else:
        require_type(draws, int, "batch, draws", "a whole number", "as in draws=1000")
        count = draws
    if count < 1:
        raise InputError("batch, draws", count, "at least 1", "draw 1000, or leave it out")
    if scores is None:
        names, _ = usual_names(loops)
    else:
        remedy = 'write as in ["iae[level_1]"]'
        names = tuple(sequence_of(scores, str, "batch, scores", "scores", remedy))
    whole = replace(loops, names=names)
    parts = list[DrawnScores]()
    for part in whole.draw_many(np.arange(1, count + 1)):
        parts.append(part)
        if progress is not None:
            done = sum(len(each.numbers) for each in parts)
            progress(DrawProgress(done, count, float("inf")))
    return Batch(whole, joined(parts))
