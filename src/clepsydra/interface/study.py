"""`cl.study`: controllers designed, simulated, scored and ranked."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.files import require_writable
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.section import Section
from clepsydra.interface.controller import AnyController, Controller
from clepsydra.interface.plant import Plant
from clepsydra.interface.shown import Answered, Page, Told, lifted, screen
from clepsydra.interface.study_request import asked_of
from clepsydra.interface.subject import Subject
from clepsydra.studies import result as results
from clepsydra.studies.file.request import StudyRequest
from clepsydra.studies.ranking import verdict
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.study import StudyProgress, controller_names, run_study

if TYPE_CHECKING:
    import pandas
    from rich.console import RenderableType

    from clepsydra.interface.events import Events
    from clepsydra.interface.loop_settings import Settings
    from clepsydra.interface.quantities import Quantity
    from clepsydra.interface.run import Run
    from clepsydra.interface.tuned import Tuned
    from clepsydra.limits.limits import LimitProgress
    from clepsydra.studies.robustness.campaign import DrawProgress


class Candidate(Told, results.Candidate):
    """A controller of a study with its run, its scores and its place in the ranking.

    `controller`, `settings`, `run`, `scores`, `rank`, `standing`, `maximum_sensitivity`, `reason`,
    `warnings` of the controller, `caveats` of its simulation and scenario and, of a tuned one,
    `tuning`.
    """

    controller: Controller
    run: Run
    tuning: Tuned | None

    @property
    def settings(self) -> Settings:
        """The settings of the loops of its controller."""
        return self.controller.settings


@dataclass(frozen=True, eq=False, repr=False)
class Study(Answered, results.StudyResult):
    """The controllers of a study in order of rank, and what came out.

    Printed, it shows what to use with which settings, how good it is, what to watch, and the first
    of the ranking.

    Parameters
    ----------
    plant : Plant
    named : bool
        Whether its controllers were asked for by name, as in a study file, and not tried in turn:
        of one that does not apply it is then said at once, why.
    """

    ranking: tuple[Candidate, ...]
    plant: Plant = field(kw_only=True)
    named: bool = field(default=False, kw_only=True)

    @property
    def best(self) -> Candidate:
        """The first of the ranking.

        Raises
        ------
        InputError
            No controller applies.
        """
        if self.ranking:
            return self.ranking[0]
        reasons = "; ".join(f"{name}: {reason}" for name, reason in self.not_applicable)
        raise InputError(
            "study",
            Finding("no controller that applies"),
            "at least one",
            f"see why: {reasons[:200]}",
        )

    def __getitem__(self, name: str) -> Candidate:
        """Return a candidate by the name of its controller."""
        by_name = {candidate.controller.name: candidate for candidate in self.ranking}
        if name not in by_name:
            from clepsydra.base.suggestion import suggestion

            raise InputError(
                "study", str(name)[:60], f"one of: {'; '.join(by_name)}",
                suggestion(name, by_name, "choose one of them"),
            )  # fmt: skip
        return by_name[name]

    @property
    def recommended(self) -> Candidate:
        """The simplest controller that is good enough, which may be the best.

        Raises
        ------
        InputError
            No controller applies, or all are unsafe.
        """
        advice = recommend(self.ranking, self.accept)
        if advice is None and self.ranking:
            why = f"see why: {self.best.reason[:200]}"
            raise InputError("study", "only unsafe controllers", "one that is safe", why)
        return self.best if advice is None else advice.simplest  # type: ignore[return-value]

    def as_dict(self) -> dict[str, Any]:
        """Return the study as values for JSON, in SI; an unreached score is infinite."""
        advice = recommend(self.ranking, self.accept)
        recommended = None if advice is None else advice.simplest.controller.name
        return {**super().as_dict(), "recommended": recommended, "accept": self.accept}

    def with_limits(self, progress: Callable[[LimitProgress], None] | None = None) -> Study:
        """Return the study with the physical limit of its setpoint steps, see `cl.limit`.

        The ranking, the report and `as_dict` then say how many times it each controller is.
        """
        from clepsydra.studies.kept_limits import limits_of_study

        return replace(self, limits=limits_of_study(self, progress))

    def with_draws(
        self, draws: int = 64, progress: Callable[[DrawProgress], None] | None = None
    ) -> Study:
        """Return the study whose first five controllers have met drawn plants.

        One that does not settle on some of them goes behind those that do. The ranking, the report
        and `as_dict` then say what becomes of each on the worst of them; see `cl.robustness` for
        more.
        """
        from clepsydra.studies.robustness.of_study import with_draws

        found = with_draws(self, draws, progress)
        said = verdict(self.process, found.ranking, self.accept, self.out_of_reach)
        return replace(self, ranking=found.ranking, verdict=said)  # type: ignore[arg-type]

    def beside_limit(self) -> Page:
        """Return how far the first controllers are from the limit, to print."""
        from clepsydra.report.limit_answer import beside_limit
        from clepsydra.report.ranking_rows import RANKED

        advice = recommend(self.ranking, self.accept)
        advised = None if advice is None else advice.simplest
        return Page(beside_limit(self, advised, RANKED))

    def report(self, path: str | Path) -> None:
        """Write the study as one HTML file."""
        from clepsydra.report.html import report_text
        from clepsydra.report.page import write_page

        write_page(report_text(self), path)

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the report, in which settings can be moved."""
        from clepsydra.report.html import report_text
        from clepsydra.report.page import framed

        return framed(report_text(self), f"Control study of {self.process.title}")

    def save(self, path: str | Path, *, largest: int | None = None) -> int:
        """Write the trajectories of the runs as one Parquet file, and return how many those are.

        Parameters
        ----------
        path : str or Path
        largest : int, optional
            The recommended controller and then the best and the others, by their rank, as long
            as the file has at most so many bytes; all of them if left out.
        """
        from clepsydra.loop.trajectory_file import fitting, write_parquet

        runs = [candidate.run for candidate in self.ranking]
        if largest is not None:
            advice = recommend(self.ranking, self.accept)
            first = None if advice is None else advice.simplest.run
            runs.sort(key=lambda run: run is not first)
            runs = runs[: fitting(runs, largest)]
        write_parquet(runs, Path(path))
        return len(runs)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the ranking as a table: one row a controller, one column a score [SI]."""
        import pandas

        rows = [
            {
                "standing": each.standing.name.lower(),
                "max|S|": each.maximum_sensitivity,
                **each.scores,
            }
            for each in self.ranking
        ]
        names = [each.controller.name for each in self.ranking]
        return pandas.DataFrame(rows, index=pandas.Index(names, name="controller"))

    def answer(self, *, every: bool = False, why: bool = False, refused: bool = False) -> Section:
        """Return what to use, and on request what stands behind it.

        Parameters
        ----------
        every : bool
            Whether with the whole ranking.
        why : bool
            Whether with the reason of every place, all warnings and the rule.
        refused : bool
            Whether with what does not apply; always where the controllers were named.
        """
        from clepsydra.report.study_answer import study_answer

        return study_answer(self, every=every, why=why, refused=refused or self.named)


@keywords_checked()
def study(
    plant: Subject,
    controllers: Sequence[AnyController] | None = None,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    seed: int | None = None,
    cases: Mapping[str, Plant] | None = None,
    designed_anew: Sequence[str] = (),
    only: str | None = None,
    accept: float = results.ACCEPTED,
    folder: str | Path | None = None,
    progress: Callable[[StudyProgress], None] | None = None,
) -> Study:
    """Simulate controllers of a plant in the same scenario, score and rank them.

    Parameters
    ----------
    plant : Plant, str or Path
        Or the path of a study file, which says itself what is studied.
    controllers : sequence of Controller, optional
        If left out, every design that applies, and PI control tuned by simulation. Those of one
        name are numbered: "PI, SIMC" and "PI, SIMC, 2"; `controller.named` gives another.
    events, duration : optional
        The scenario, as for `cl.simulate`; the default scenario if left out.
    seed : int, optional
        Of noise and tuning; 1, or that of the study file, if left out.
    cases : mapping, optional
        Other operating points and variants at which the same steps are taken: a name to a plant,
        `{"low": plant.at(outputs={"level": "20 %"})}`. The worst case of each controller counts.
    designed_anew : sequence of str
        The cases for which the controllers are designed; in the others they keep their settings.
    only : str, optional
        The name of the one design that is wanted, "PI, SIMC"; it is tried without cases.
    accept : float
        The simplest controller whose relative error is at most this is recommended.
    folder : str or Path, optional
        Where a tuning keeps what it has computed until it is done, to go on after control-C.
    progress : callable, optional
        Takes how far the study is, before each controller.

    Returns
    -------
    Study
        With `best`, `ranking`, `verdict` and `report(path)`.

    Raises
    ------
    InputError
        Something given cannot be used; the message says what and where.
    NoEquilibrium
        The plant has no operating point.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> found.best.controller.name
    'PI, AMIGO'
    """
    if not (is_finite_number(accept) and accept >= 1.0):
        raise InputError(
            "study, accept", str(accept), "a number from 1", "give how many times the best error"
        )
    kept = None if folder is None else Path(folder)
    if kept is not None:
        require_writable(kept, "study, folder")
    asked = asked_of(plant, controllers, events, duration, seed, cases, designed_anew)
    request = asked.request
    found = run_study(request, progress=progress, tuning_folder=kept, only=only)
    plants = {each.name: Plant.resting(each.study.process, each.asked) for each in request.cases}
    return _of_plant(found, asked.plant, accept, plants, named=bool(request.controllers))


def so_far(progress: StudyProgress) -> RenderableType:
    """Return the first rows of a ranking that is not whole yet, for a terminal.

    Examples
    --------
    >>> so_far(StudyProgress(0, 15, "PI, SIMC")).section.parts
    ()
    """
    from clepsydra.report.ranking_rows import RANKED, ranking_glance

    first = progress.ranking[:RANKED]
    return screen(Section("", (ranking_glance(first),) if first else ()))


def newest(progress: StudyProgress) -> str:
    """Return the controller that was tried last in a line; empty before there is one.

    Examples
    --------
    >>> newest(StudyProgress(0, 15, "PI, SIMC"))
    ''
    """
    from clepsydra.report.ranking_rows import trial_line

    return trial_line(progress.trials[-1]).text if progress.trials else ""


def names_of(subject: Plant | StudyRequest) -> tuple[str, ...]:
    """Return the names of the controllers that a study tries, whether or not they apply.

    Examples
    --------
    >>> import clepsydra as cl
    >>> names_of(cl.load("equalisation-tank"))[-1]
    'PI, arrest time, tuned'
    """
    return controller_names(subject.process if isinstance(subject, Plant) else subject)


def _of_plant(
    found: results.StudyResult,
    plant: Plant,
    accept: float,
    plants: Mapping[str, Plant],
    *,
    named: bool,
) -> Study:
    """Return what was found with the classes of the interface, and so its cases."""
    # A first row needs none of these, nor what they load.
    from clepsydra.interface.run import Run
    from clepsydra.interface.scores import Scores
    from clepsydra.interface.tuned import Tuned
    from clepsydra.studies.single_precision import told_of_single_precision

    cases = {
        name: _of_plant(each, plants[name], accept, {}, named=named)
        for name, each in found.cases.items()
    }
    there = {
        (name, each.controller.name): each for name, case in cases.items() for each in case.ranking
    }

    def candidate(each: results.Candidate) -> Candidate:
        cases_of = {
            name: there.get((name, each.controller.name)) if name in cases else case
            for name, case in each.cases.items()
        }
        own = each.controller  # which rests at this plant, whatever it was made for
        if not (isinstance(own, Controller) and own.plant is plant):
            own = lifted(Controller, own, plant=plant)
        return lifted(
            Candidate,
            each,
            controller=own,
            run=lifted(Run, each.run),
            tuning=each.tuning and lifted(Tuned, each.tuning),
            scores=Scores(each.scores, plant.process, each.run.scenario.duration),
            cases=cases_of,
        )

    told = told_of_single_precision(found.ranking, found.model, accept)
    ranking = tuple(map(candidate, told))
    said = verdict(plant.process, ranking, accept, found.out_of_reach)
    how = {"ranking": ranking, "plant": plant, "accept": accept, "verdict": said, "named": named}
    return lifted(Study, found, **how, cases=cases)
