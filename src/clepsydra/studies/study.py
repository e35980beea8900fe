"""A study: every controller asked for is tried in every case, and ranked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import nearest_few
from clepsydra.studies.case_ranking import CASES_RULE, rank_cases
from clepsydra.studies.designs import studied_designs
from clepsydra.studies.file.request import CaseRequest, StudyRequest
from clepsydra.studies.ranking import rule_of, verdict
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.tries import StudyProgress as StudyProgress
from clepsydra.studies.tries import Tries
from clepsydra.studies.usual_tuning import usual_tunings
from clepsydra.studies.warnings.out_of_reach import out_of_reach

if TYPE_CHECKING:
    from clepsydra.process.process import Process

#: Names of controllers that a refusal shows.
_NAMES_SAID = 8


def run_study(
    request: StudyRequest,
    *,
    progress: Callable[[StudyProgress], None] | None = None,
    tuning_folder: Path | None = None,
    only: str | None = None,
) -> StudyResult:
    """Design, tune, simulate, score and rank controllers of a process.

    Parameters
    ----------
    request : StudyRequest
        Where it names no controllers, every design that applies is tried, and PI and PID
        control are tuned by simulation.
    progress : callable, optional
        Takes a `StudyProgress` before each controller, and while one is tuned.
    tuning_folder : Path, optional
        Where a tuning keeps what it has computed until it is done. Control-C ends a tuning with
        the best so far; the same study then goes on from there.
    only : str, optional
        Name of the one controller that is wanted, from `controller_names`; the others are left
        out, but for those that its tuning starts from.

    Raises
    ------
    InputError
        A controller of the request cannot be made, or `only` names none of the study.
    """
    known = controller_names(request)
    if only is not None and only not in known:
        raise _unknown_controller(only, known, written_out=not request.tries_every_design)
    return _Study(request, progress or (lambda _: None), tuning_folder).run(only)


def _unknown_controller(name: str, known: Sequence[str], *, written_out: bool) -> InputError:
    """Return the refusal of a name: those that are near, or the first few, and where others are."""
    near = " or ".join(f"'{each}'" for each in nearest_few(name, known))
    if near:
        expected = "the name of a controller of this study"
        remedy = f"perhaps {near} was meant; the whole study lists every one"
        return InputError("controller", name, expected, remedy)
    more = len(known) - _NAMES_SAID
    expected = " or ".join(f"'{each}'" for each in known[:_NAMES_SAID])
    expected += f" or one of {more} more of this study" if more > 0 else ""
    remedy = "choose one of them; the whole study lists every one"
    if not written_out:
        remedy += (
            ". A scheme of loops, as a cascade, has its name in a study file that writes it out: "
            "give that file instead of the process"
        )
    return InputError("controller", name, expected, remedy)


def controller_names(request: Process | StudyRequest) -> tuple[str, ...]:
    """Return the names of the controllers that a study tries, whether or not they apply."""
    named: tuple[str, ...] = ()
    if isinstance(request, StudyRequest):
        named = tuple(wanted.name for wanted in request.controllers)
        if not request.tries_every_design:
            return named
    process = request.process if isinstance(request, StudyRequest) else request
    usual = (*studied_designs(), *(each.name for each in usual_tunings(process, ())))
    return (*named, *(name for name in usual if name not in named))


class _Study:
    """A study with its cases."""

    def __init__(
        self,
        request: StudyRequest,
        tell: Callable[[StudyProgress], None],
        folder: Path | None,
    ) -> None:
        self.request, self.tell, self.folder = request, tell, folder
        self.base = Tries(request, tell, folder)

    def run(self, only: str | None) -> StudyResult:
        """Try every controller that is wanted, in every case, and rank what applies.

        One that is wanted by its name is tried in the base case alone.
        """
        self.base.try_wanted(only)
        requests = () if only else self.request.cases
        cases = {each.name: self._tried(each) for each in requests}
        found = {name: tries.trials for name, tries in cases.items()}
        overall, by_case = rank_cases(self.base.trials, found, self.request.scores)
        result = _result(self.base, overall)
        if not cases:
            return result
        studies = {
            each.name: replace(
                _result(cases[each.name], by_case[each.name]), settings=each.settings
            )
            for each in requests
        }
        return replace(result, rule=result.rule + CASES_RULE, cases=studies)

    def _tried(self, case: CaseRequest) -> Tries:
        """Try in a case what was tried in the base case."""

        def tell(now: StudyProgress) -> None:
            trials, scores = tuple(self.base.trials), self.request.scores
            name = f"{case.name}: {now.name}"
            self.tell(now._replace(name=name, trials=trials, scores=scores))

        tries = Tries(case.study, tell, self.folder, case.name)
        if case.settings == "frozen":
            tries.try_frozen(self.base)
        else:
            tries.try_wanted()
        return tries


def _result(tries: Tries, ranking: tuple[Candidate, ...]) -> StudyResult:
    """Return what was found at one operating point."""
    request = tries.request
    beyond = out_of_reach(tries.model, request.scenario)
    return StudyResult(
        process=request.process,
        analysis=request.analysis,
        scenario=request.scenario,
        ranking=ranking,
        not_applicable=tuple(tries.refused),
        verdict=verdict(request.process, ranking, out_of_reach=beyond),
        warnings=(*beyond, *request.analysis.operating_point.warnings),
        out_of_reach=beyond,
        title=request.title,
        rule=rule_of(request.scores),
        path=request.path,
        judged_by=tuple(request.scores),
    )
