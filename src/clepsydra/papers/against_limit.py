"""The documents' controllers, ours and the best input, in every experiment of the documents."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import SampledLoop, sampled_loop
from clepsydra.limits.limits import Limits
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.papers.contest import Contest, Contests
from clepsydra.papers.document import Document, documents, load_document
from clepsydra.papers.side_by_side import side_by_side
from clepsydra.studies.file.request import StudyRequest
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.study import run_study

#: Keys of a document and of one of its experiments.
_Task = tuple[str, str]
#: What is at its setpoint is nearer than this share of its step, the band of settling times.
BAND = 0.02
#: The last share of a run, in which an error counts as left.
_END = 0.1
#: An angle at which S is that at rest [rad], and the largest that integral action leaves there.
_AT_REST, _NOTHING = 1e-8, 0.01


class ContestProgress(NamedTuple):
    """How many experiments are done, of how many, and the one that ended last."""

    done: int
    of: int
    name: str


@dataclass(frozen=True)
class Entrant:
    """A controller in an experiment.

    Parameters
    ----------
    name : str
    published, recommended : bool
        Whether it is the document's; of ours, whether the study recommends it.
    reads_more : bool
        Whether it measures more than what it controls.
    integrates : bool
        Whether a load that stays leaves no offset, by its linear loop; true where it has none.
    error : float
        Sum of the integrals of the absolute errors, each over its step [s].
    times : float
        The same as a multiple of the physical limit.
    peak : float
        max|S|; infinite where the loop is unstable, not a number where it has no linear loop.
    left : dict
        Output to the largest share of its step that its error has in the last tenth of the run.
    swings : dict
        Input to the share of its range over which it moves there.
    """

    name: str
    published: bool
    recommended: bool
    reads_more: bool
    integrates: bool
    error: float
    times: float
    peak: float
    left: dict[str, float]
    swings: dict[str, float]

    @property
    def works(self) -> bool:
        """Whether its loop is stable and ends at the setpoints."""
        return not math.isinf(self.peak) and max(self.left.values()) <= BAND


@dataclass(frozen=True)
class Outcome:
    """What came of an experiment.

    Parameters
    ----------
    document, title : str
        Key of the document, and which of its experiments.
    limit : float
        The least error that any input could leave, each output's over its step [s].
    proved : bool
        Whether all its proofs hold.
    steps : tuple of (Signal, float)
        Each controlled measurement and its step [SI].
    inputs : tuple of Signal
        With the limits of each.
    duration : float
        Of the run [s].
    entrants : tuple of Entrant
        The nearest to the limit first.
    """

    document: str
    title: str
    limit: float
    proved: bool
    steps: tuple[tuple[Signal, float], ...]
    inputs: tuple[Signal, ...]
    duration: float
    entrants: tuple[Entrant, ...]

    @property
    def published(self) -> Entrant | None:
        """The nearest of the document's controllers that work; None where none does."""
        return next((each for each in self.entrants if each.published and each.works), None)

    @property
    def nearest(self) -> Entrant:
        """The nearest of ours."""
        return next(each for each in self.entrants if not each.published)

    @property
    def recommended(self) -> Entrant:
        """The one of ours that the study recommends."""
        return next(each for each in self.entrants if each.recommended)


@dataclass(frozen=True)
class AgainstLimit:
    """Every experiment of some documents against its physical limit."""

    outcomes: tuple[Outcome, ...]

    @property
    def by_document(self) -> dict[str, tuple[Outcome, ...]]:
        """Key of each document to its experiments."""
        keys = dict.fromkeys(each.document for each in self.outcomes)
        return {key: tuple(o for o in self.outcomes if o.document == key) for key in keys}

    def as_list(self) -> list[dict[str, Any]]:
        """Return every controller of every experiment as values for JSON."""
        return [
            {"document": outcome.document, "experiment": outcome.title, "limit": outcome.limit}
            | asdict(entrant)
            for outcome in self.outcomes
            for entrant in outcome.entrants
        ]


def contests_of(document: Document) -> Contests:
    """Return what makes each experiment of a document that is compared."""
    found: Contests = _module(document).contests()
    return found


def words_of(document: Document) -> str:
    """Return what its experiments are, and which controllers the document has."""
    words: str = _module(document).WORDS
    return words


def _module(document: Document) -> Any:
    return importlib.import_module(f"{document.package}.against_limit")


def against_limit(
    keys: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Callable[[ContestProgress], None] | None = None,
) -> AgainstLimit:
    """Run every controller of documents, and ours, and find the least error that there can be.

    Parameters
    ----------
    keys : sequence of str
        Of documents; all if left out, each once.
    workers : int
        Processes that share the experiments; with more than one, guard a script's start by
        ``if __name__ == "__main__"``.
    progress : callable, optional
        Called after each experiment.

    Raises
    ------
    InputError
        There is no such document.
    NoCourse
        The limit of an experiment was not found.
    """
    loaded = [load_document(key) for key in dict.fromkeys(keys or documents())]
    groups = [[(each.key, title) for title in contests_of(each)] for each in loaded]
    tasks = [task for group in groups for task in group]
    found: dict[_Task, Outcome] = {}
    for task, outcome in side_by_side(_run, groups, workers):
        found[task] = outcome
        if progress is not None:
            progress(ContestProgress(len(found), len(tasks), ": ".join(task)))
    return AgainstLimit(tuple(found[task] for task in tasks))


def _run(task: _Task) -> Outcome:
    return outcome_of(*task)


def outcome_of(key: str, title: str, *, ours: bool = True) -> Outcome:
    """Return what comes of one experiment of a document.

    Parameters
    ----------
    key, title : str
    ours : bool
        Whether with our controllers, whose study takes most of the time.
    """
    contest = contests_of(load_document(key))[title]()
    limit, process = contest.limit(), contest.process
    limits = Limits(process, (limit,))
    entrants = [*_published(contest, limits), *(_ours(contest, limits) if ours else ())]
    return Outcome(
        document=key,
        title=title,
        limit=limit.index,
        proved=limit.accepted,
        steps=tuple((process.signal(name), size) for name, size in contest.sizes.items()),
        inputs=process.inputs,
        duration=contest.duration,
        entrants=tuple(sorted(entrants, key=lambda each: each.error)),
    )


def _published(contest: Contest, limits: Limits) -> Iterator[Entrant]:
    for name, controller in contest.published.items():
        run = Loop(controller, contest.model).run(contest.scenario)
        loop: SampledLoop | None = None
        with suppress(ClepsydraError):  # rules of a fuzzy controller have none
            loop = sampled_loop(controller, contest.model)
        found = _entrant(name, controller, run, loop, limits)
        yield replace(found, published=True)


def _ours(contest: Contest, limits: Limits) -> Iterator[Entrant]:
    """Yield what a study of the plant finds in this scenario, of the best standing there is.

    What has no integral action is left out: nothing here would show what it lacks.
    """
    study = run_study(
        StudyRequest(
            path=None,
            title=contest.process.title,
            process=contest.process,
            analysis=contest.analysis,
            scenario=contest.scenario,
            controllers=(),
            scores=(),
            seed=1,
            designs="all",
        )
    )
    found = {}
    for each in study.ranking:
        loop = each.response.loop if each.response else None
        entrant = _entrant(each.controller.name, each.controller, each.run, loop, limits)
        if each.standing is study.ranking[0].standing and entrant.works and entrant.integrates:
            found[each] = entrant
    advice = recommend(tuple(found))
    assert advice is not None, f"{contest.process.name}: no controller that works"
    found[advice.simplest] = replace(found[advice.simplest], recommended=True)
    yield from found.values()


def _entrant(
    name: str, controller: Controller, run: Run, loop: SampledLoop | None, limits: Limits
) -> Entrant:
    (limit,) = limits.found
    process, times = run.process, limits.times(run)
    assert times is not None
    end = slice(-round(_END * len(run.time)), None)
    left = {}
    for output, size in limit.event.sizes:
        error = run.values[f"{output}.setpoint"] - run.true_measurement(output)
        left[output] = float(np.max(np.abs(error[end]))) / size
    at_rest = np.zeros(1) if loop is None else np.abs(loop.response(np.array([_AT_REST])))
    return Entrant(
        name,
        published=False,
        recommended=False,
        reads_more=bool(set(controller.measurements) - set(process.controlled)),
        integrates=bool(np.max(at_rest) < _NOTHING),
        error=times * limit.index,
        times=times,
        peak=math.nan if loop is None else loop.maximum_sensitivity,
        left=left,
        swings={u.name: float(np.ptp(run.values[u.name][end])) / u.span for u in process.inputs},
    )
