"""`cl.robustness`: how sure a controller is on plants that are not quite the one on paper."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.engine.white_noise import check_seed
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.quantities import Quantity, arguments
from clepsydra.interface.run import Run
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import StudyRequest, Subject, plant_of, read_subject
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.process.uncertainty_reader import read_uncertainty
from clepsydra.studies.robustness import robustness as inner
from clepsydra.studies.robustness.campaign import DrawProgress
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.fan import DRAWS as FAN_DRAWS
from clepsydra.studies.robustness.fan import fan_of
from clepsydra.studies.robustness.robustness import DRAWS, ROWS, robustness_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from clepsydra.base.section import Section
    from clepsydra.interface.events import Events
    from clepsydra.interface.plant import Plant
    from clepsydra.studies.robustness.cluster import Cluster


@dataclass(frozen=True, eq=False, repr=False)
class Robustness(Answered, inner.Robustness):
    """What came of many plants: `quantile(score)`, `worst(score)`, `run(draw)`, `report(path)`."""

    def answer(self, *, every: bool = False) -> Section:
        """Return how sure the controller is, or every score, cause and reason as well."""
        from clepsydra.report.robustness_answer import robustness_answer

        return robustness_answer(self, every=every)

    def plot(self) -> Figure:
        """Draw between which values the plants are, event by event, as a Matplotlib figure."""
        from clepsydra.report.fan_picture import fan_figure

        return fan_figure(self.loops, fan_of(self.loops, min(self.draws, FAN_DRAWS)))

    def report(self, path: str | Path) -> None:
        """Write the page: the fan of the plants, the worst one, which parameter matters."""
        from clepsydra.report.page import write_page
        from clepsydra.report.robustness_page import robustness_text

        write_page(robustness_text(self), path)

    def run(self, draw: int) -> Run:
        """Return the run of one draw with its trajectories; 0 is the plant itself.

        Raises
        ------
        InputError
            The draw has no admissible steady state.
        """
        return lifted(Run, super().run(draw))


@keywords_checked()
def robustness(
    controller: AnyController,
    plant: Subject,
    events: Events | None = None,
    *,
    draws: int = DRAWS,
    uncertainty: Mapping[str, Any] | None = None,
    scores: Sequence[str] | None = None,
    duration: Quantity | None = None,
    seed: int = 1,
    sensitivity: bool = True,
    workers: int | None = None,
    cluster: str | None = None,
    state_file: str | Path | None = None,
    progress: Callable[[DrawProgress], None] | None = None,
) -> Robustness:
    """Put a controller on many plants whose parameters differ from those on paper.

    Each plant starts at its own rest, its controlled measurements where those of the plant itself
    are, and its controller without a bump. Draw n follows from the seed and n alone.

    Parameters
    ----------
    controller : Controller
    plant : Plant, str or Path
        Or the path of a study file, whose scenario it is.
    events, duration : optional
        The scenario, as for `cl.simulate`; the default scenario if left out.
    draws : int
    uncertainty : mapping, optional
        How uncertain parameters are, {"tank_1.area": "5 %"}, as the table [uncertainty] of a
        process file has it; that of the file if left out, and 10 % where it says nothing.
    scores : sequence of str, optional
        Scores beside those that are told in any case, "ise[level_1]".
    seed : int
        Of the draws, and of the noise of the default scenario.
    sensitivity : bool
        Whether it is found which parameters the scatter comes from, on some thousand draws more.
    workers : int, optional
        Draw in so many processes of this machine, instead of in threads; with the extra "cluster".
    cluster : str, optional
        Draw on the workers of a scheduler of dask.distributed, "tcp://10.0.0.1:8786", with the same
        bits as here. Whoever reaches a scheduler can run anything on it.
    state_file : str or Path, optional
        Where what is done is kept, so that the same call goes on after control-C.
    progress : callable, optional
        Takes how far it is, after each chunk of draws.

    Returns
    -------
    Robustness

    Raises
    ------
    InputError
        There is no draw, a score, a parameter or a distribution cannot be used, the state file is
        of other draws, or the cluster cannot be reached or is another version.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = robustness(cl.design.simc(plant), plant, draws=200, sensitivity=False)
    >>> found.draws, found.nominal["error"], found.quantile("error").value > 1.0
    (200, 1.0, True)
    """
    loops = loops_of(
        controller, plant, events, uncertainty=uncertainty, duration=duration, seed=seed
    )
    require_type(draws, int, "robustness, draws", "a whole number", "as in draws=1000")
    require_type(sensitivity, bool, "robustness, sensitivity", "True or False", "choose one")
    remedy = 'write as in ["ise[level_1]"]'
    named = sequence_of(scores or (), str, "robustness, scores", "scores", remedy)
    with _where(workers, cluster) as there:
        found = robustness_of(
            loops,
            draws,
            scores=named,
            rows=ROWS if sensitivity else 0,
            cluster=there,
            state_file=None if state_file is None else Path(state_file),
            progress=progress,
        )
    return lifted(Robustness, found)


@contextmanager
def _where(workers: int | None, cluster: str | None) -> Iterator[Cluster | None]:
    """Give the workers that draw; None for this process."""
    if workers is None and cluster is None:
        yield None
        return
    if workers is not None and cluster is not None:
        raise InputError(
            "robustness, workers", workers, "workers or a cluster, not both", "leave one out"
        )
    # Nothing of a cluster is loaded before one is asked for.
    from clepsydra.studies.robustness.cluster import cluster_at, local_workers

    chosen = cluster_at(cluster) if cluster is not None else local_workers(workers or 0)
    with chosen as found:
        yield found


def loops_of(
    controller: AnyController,
    plant: Subject,
    events: Events | None,
    *,
    uncertainty: Mapping[str, Any] | None,
    duration: Quantity | None,
    seed: int,
) -> DrawnLoops:
    """Return a controller over drawn plants, as callers ask for it."""
    subject = read_subject(plant) if isinstance(plant, (str, Path)) else plant
    own = plant_of(subject)
    check_seed(seed)
    if isinstance(subject, StudyRequest) and events is None and duration is None:
        scenario = subject.scenario
    else:
        scenario = scenario_of(own, events, duration, seed)
    plants = DrawnPlants(own.point, own.analysis.pairing, uncertainty_of(own, uncertainty), seed)
    return DrawnLoops(of_plant(controller, own), scenario, plants, ())


def uncertainty_of(plant: Plant, given: Mapping[str, Any] | None) -> Uncertainty:
    """Return how uncertain the parameters of a plant are: as given, or as its file has it."""
    if given is None:
        return plant.process.uncertainty
    remedy = 'write as in {"tank_1.area": "5 %"}'
    require_type(given, Mapping, "uncertainty", "parameters with their uncertainty", remedy)
    return read_uncertainty(arguments("uncertainty", given), plant.process)
