"""What a run and its scores show that a reader must know."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.loop.run import Run
from clepsydra.scores.score_key import by_signal
from clepsydra.studies.warnings.accuracy import accuracy_caveats
from clepsydra.studies.warnings.caveat import Caveat
from clepsydra.studies.warnings.harm import emptied, harms
from clepsydra.studies.warnings.inner_setpoint import inner_setpoint_warnings
from clepsydra.studies.warnings.saturation import saturation_warnings
from clepsydra.studies.warnings.settling import settling_warnings
from clepsydra.studies.warnings.unfinished import unfinished_caveats


def run_warnings(run: Run) -> tuple[str, ...]:
    """Return what is unusual about a run: overflow, trips, saturation, wind-up.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from clepsydra.designs.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> designed = design_simc(analysis.model, analysis.pairing)
    >>> for gain in (designed.values["level_1.proportional_gain"], 50.0):
    ...     controller = replace(
    ...         designed, values=designed.values | {"level_1.proportional_gain": gain})
    ...     run = Loop(controller, analysis.model).run(default_scenario(analysis.model))
    ...     words = run_warnings(run)
    ...     print(len(words), *words)
    0
    1 pump_1 stands at a limit for 35 % of the time, mostly at 0 V: nothing is corrected meanwhile.
    """
    return (
        *(each.sentence for each in (*harms(run), *emptied(run))),
        *saturation_warnings(run),
        *inner_setpoint_warnings(run),
    )


def warnings_after(run: Run, scores: Mapping[str, float]) -> tuple[str, ...]:
    """Return the warnings of a run and of its scores.

    That a level does not settle is no fault where it is meant to average (`Process.averaging`), or
    where the controller has no setpoint for it.

    Parameters
    ----------
    scores : mapping
        Score to value, "settling_time[level_1]".
    """
    followed = set(run.controller.setpoints) - set(run.process.averaging)
    times = by_signal(scores, "settling_time")
    held = {name: time for name, time in times.items() if name in followed}
    return (*run_warnings(run), *settling_warnings(held))


def caveats_after(run: Run) -> tuple[Caveat, ...]:
    """Return what a run leaves open, whatever its controller: its error, steps cut short.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> caveats_after(cl.simulate(plant, cl.design.simc(plant)))
    ()
    """
    return (*accuracy_caveats(run), *unfinished_caveats(run))
