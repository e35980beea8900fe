"""What a run and its scores show that a reader must know."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.words import share_text, time_text
from clepsydra.linear.signal_words import shown
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.scores.effort import at_limit
from clepsydra.scores.score_key import by_signal
from clepsydra.studies.warnings.alarmed import alarmed
from clepsydra.studies.warnings.caveat import Caveat
from clepsydra.studies.warnings.harm import emptied, harms
from clepsydra.studies.warnings.strokes import driven_to_and_fro
from clepsydra.studies.warnings.unsolved import unsolved
from clepsydra.studies.warnings.wind_up import ANTI_WINDUP, winds_up

#: Share of a run at a limit above which the reader is told, and above which it is most of it.
_SATURATED, _MOSTLY = 0.05, 0.5
#: Error estimate above which the reader is told, share of the state's range; and above which it is
#: seen in figures of three digits.
_ERROR, _SEEN = 1e-6, 1e-3
#: Part of a segment, its last, in which a level at rest does not move any more.
_LAST = 0.1
#: A level that moves less in it, as a share of the way that it went in the segment, is at rest.
_AT_REST = 0.01
#: And one that went less than this share of its range has not moved.
_NO_WAY = 1e-6


def run_warnings(run: Run) -> tuple[Remark, ...]:
    """Return what is unusual about a run: overflow, trips, alarms, saturation, wind-up.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> fast = cl.design.simc(plant).with_values({"level_1": {"K": 50.0}})
    >>> print(run_warnings(cl.simulate(plant, fast))[0])
    pump_1 stands at a limit for 34 % of the time, mostly at 0 V: nothing is corrected meanwhile; \
ask for less, or give it another size.
    """
    return (
        *(each.warning for each in (*harms(run), *emptied(run))),
        *alarmed(run),
        *_saturated(run),
        *_driven_to_and_fro(run),
        *_inner_setpoints_at_limits(run),
        *unsolved(run),
    )


def warnings_after(run: Run, scores: Mapping[str, float]) -> tuple[Remark, ...]:
    """Return the warnings of a run and of its scores, "settling_time[level_1]" to value.

    That a level does not settle is no fault where it is meant to average (`Process.averaging`), or
    where the controller has no setpoint for it.
    """
    followed = set(run.controller.setpoints) - set(run.process.averaging)
    unsettled = (
        Remark(
            f"{name} does not settle within its setpoint step",
            "the loop is too slow or rings",
            "compare its trend",
        )
        for name, time in by_signal(scores, "settling_time").items()
        if name in followed and math.isinf(time)
    )
    return (*run_warnings(run), *unsettled)


def caveats_after(run: Run) -> tuple[Caveat, ...]:
    """Return what a run leaves open, whatever its controller: its error, steps cut short.

    Smaller integration steps might still change a state by more than 1e-6 of its range. And an
    averaging level may still move by more than 1 % of its way in the last tenth of a step's
    segment, which is then shorter than what its loop takes, an arrest time, say, so that scores
    are of a part of the response; of each level all such segments are told together.
    """
    found = []
    if run.error_estimate is not None and run.error_estimate > _ERROR:
        error, about = run.error_estimate, "accuracy"
        words = Remark(
            f"Halving the integration step shows that a state may be wrong by {share_text(error)} "
            f"of its range, more than the {share_text(_ERROR)} aimed at",
            "smaller differences between runs say nothing",
            "compare with the reference solver",
        )
        if error >= 1.0:
            # Beside others that are a little wrong, it is told of those alone of which it is true.
            about = "no accuracy"
            words = Remark(
                "Halving the integration step moves a state by as much as its whole range",
                "the steps are too long for what happens in this run, and none of its figures can "
                "be relied on",
                "compare with the reference solver, or shorten the sampling period",
            )
        found.append(Caveat(words, about, 100.0 * error, seen=error >= _SEEN))
    for name in run.process.averaging:
        steps = [segment for segment in run.scenario.segments if segment.kind != "noise"]
        shares = {segment: _still_moving(name, segment, run) for segment in steps}
        moving = [segment for segment, share in shares.items() if share > _AT_REST]
        if moving and name in run.controller.setpoints:
            first, share = moving[0], max(shares.values())
            what = (
                f"{name} is not at rest when the {first.kind} step of {first.signal} ends "
                f"after {time_text(first.stop - first.start)}"
            )
            others = f", nor at the end of {len(moving) - 1} more" if moving[1:] else ""
            words = Remark(
                f"{what}{others}, so that what follows begins away from the setpoint",
                f"in the last tenth it still moves by up to {100.0 * share:.2g} % of its way, and "
                "its scores are of a part of the response",
                "leave more time between the steps, in a study file",
            )
            found.append(Caveat(words, what, share))
    return tuple(found)


def _still_moving(name: str, segment: Segment, run: Run) -> float:
    """Return the way in the last tenth of a segment as a share of the way in the whole of it."""
    first, after = (
        round(time / run.scenario.sampling_period) for time in (segment.start, segment.stop)
    )
    within = run.true_measurement(name)[first:after]
    if len(within) < 2:
        return 0.0
    way = float(np.ptp(within))
    late = within[-max(2, round(_LAST * len(within))) :]
    nothing = _NO_WAY * run.process.signal(name).span
    return float(np.ptp(late)) / way if way > nothing else 0.0


def _saturated(run: Run) -> Iterator[Remark]:
    """Return for how long inputs stood at a limit, and with what effect."""
    if not run.controller.setpoints:  # pumps that start and stop stand at their limits
        return
    shares = {}
    for signal in run.process.inputs:
        low, high = run.limits(signal.name)
        share, mostly_low = _share_at_limit(run.values[signal.name], low, high)
        shares[signal.name] = share
        if share > _SATURATED:
            mostly = share > _MOSTLY
            effect = "controlled for most of it" if mostly else "corrected meanwhile"
            yield Remark(
                f"{signal.name} stands at a limit for {100 * share:.0f} % of the time, mostly "
                f"at {shown(signal, low if mostly_low else high)}",
                f"nothing is {effect}",
                "ask for less, or give it another size",
            )
    if any(shares[name] > 0.0 for name in run.controller.manipulated):
        for name in winds_up(run.controller, run.process):
            if shares[name] > 0.0:
                yield Remark(
                    f"{name} winds up",
                    "its integral has no anti-windup and went on while it stood at a limit, for "
                    f"{100 * shares[name]:.2g} % of the time",
                    ANTI_WINDUP,
                )


def _driven_to_and_fro(run: Run) -> Iterator[Remark]:
    """Return which inputs a controller sends from end to end again and again after a step."""
    for each in driven_to_and_fro(run):
        yield Remark(
            f"{each.input} goes from one end of its range to the other {each.times} times after "
            f"the {each.segment.kind} step of {each.segment.signal}",
            "that wears it out",
            "make the loop slower",
        )


def _inner_setpoints_at_limits(run: Run) -> Iterator[Remark]:
    """Return which inner setpoints stood at a limit for more than half of a run."""
    for inner in inner_setpoints(run.controller, run.process):
        share, mostly_low = _share_at_limit(run.values[inner.name], inner.low, inner.high)
        if share > _MOSTLY:
            end, limit = ("low", inner.low) if mostly_low else ("high", inner.high)
            yield Remark(
                f"The inner setpoint of {inner.measurement} stands at a limit for "
                f"{100.0 * share:.0f} % of the time, mostly at its {end} limit of "
                f"{shown(inner.signal, limit)}",
                "the outer loop controls nothing for most of it",
                f"widen setpoint_{end} of the inner loop, or ask for less",
            )


def _share_at_limit(values: np.ndarray, low: float, high: float) -> tuple[float, bool]:
    """Return the share of samples at a limit, and whether they are mostly at the low one."""
    share = float(np.mean(at_limit(values, low, high)))
    return share, float(np.mean(at_limit(values, low, np.inf))) > share / 2.0
