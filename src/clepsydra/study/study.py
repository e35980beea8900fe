"""A study: every design that applies, simulated in one scenario, scored and ranked."""

from __future__ import annotations

from pathlib import Path

from clepsydra.design.applicability import NotApplicable
from clepsydra.design.sampled_loop import sampled_loop
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.scores.evaluate import score_run
from clepsydra.study.designs import DESIGNS
from clepsydra.study.ranking import Trial, rank, verdict
from clepsydra.study.result import StudyResult
from clepsydra.study.warnings import run_warnings, settling_warnings


def run_study(process: Process | str | Path, *, seed: int = 1) -> StudyResult:
    """Design, simulate, score and rank every controller that applies to a process.

    Parameters
    ----------
    process : Process, str or Path
        A process, a name of the catalogue or a process file.
    seed : int
        Of the measurement noise.

    Returns
    -------
    StudyResult

    Raises
    ------
    NoEquilibrium
        The process has no operating point.
    InputError
        The process file cannot be used, or the process is sampled too slowly or too fast to
        be simulated.
    """
    if not isinstance(process, Process):
        process = load_process(process)
    analysis = analyse(process)
    substeps_for(analysis.model)  # a process that cannot be simulated is refused before all else
    model = linearise(analysis.operating_point)
    scenario = default_scenario(analysis.model, seed=seed)
    trials: list[Trial] = []
    refused: list[tuple[str, str]] = []
    for name, design in DESIGNS.items():
        try:
            controller = design(analysis)
        except NotApplicable as refusal:
            refused.append((name, refusal.reason))
            continue
        run = Loop(controller, model).run_checked(scenario)
        scores = scores_of(run)
        trials.append(
            Trial(
                controller=controller,
                run=run,
                scores=scores,
                maximum_sensitivity=sampled_loop(controller, model).maximum_sensitivity,
                warnings=(*run_warnings(run), *settling_warnings(scores)),
            )
        )
    ranking = rank(trials)
    return StudyResult(
        process=process,
        analysis=analysis,
        scenario=scenario,
        ranking=ranking,
        not_applicable=tuple(refused),
        verdict=verdict(process, ranking),
        warnings=analysis.operating_point.warnings,
    )


def scores_of(run: Run) -> dict[str, float]:
    """Return every score of a run; errors are those of the true levels, without noise."""
    process = run.process
    return score_run(
        run.time,
        {name: run.values[f"{name}.setpoint"] for name in process.controlled},
        {name: run.true_measurement(name) for name in process.controlled},
        {u.name: run.values[u.name] for u in process.inputs},
        {u.name: (u.low, u.high) for u in process.inputs},
        run.scenario.segments,
    )
