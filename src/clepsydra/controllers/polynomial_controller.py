"""Polynomial control of two degrees of freedom, in increments: P ∇u = r0 w − Q y."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache
from itertools import pairwise

import casadi as ca

from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_PORTS,
    declare_output,
    give_output,
    output_end,
    output_results,
)
from clepsydra.controllers.blocks.ports import ASKED, Asked, truth
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.validity import all_of, is_time_step
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, StepLaw, Symbols


@dataclass(frozen=True)
class PolynomialShape:
    """How many gains one loop has.

    `measurement_gains`: on the last differences of the measurement: the degree of Q;
    `setpoint_gains`: on those of the setpoint: the degree of R, which is zero by equation (24);
    `increment_gains`: on the last increments of the output: the degree of P.
    """

    measurement_gains: int
    setpoint_gains: int = 0
    increment_gains: int = 0


@dataclass(frozen=True)
class IncrementalLoop:
    """One loop of a law in increments.

    `what`: what it acts on: the measurement, or a prediction of it.
    """

    shape: PolynomialShape
    measured: Signal
    moved: Signal
    what: str = "measurement"

    def gains(self) -> list[Signal]:
        """Return the parameters that are ports of the block, as many as the degrees say."""
        y, u, unit = self.measured, self.moved, signals.per(self.moved, self.measured)
        shown = y.name if self.what == "measurement" else f"the {self.what} of {y.name}"
        ago = f"between {{0}} and {{1}} samples ago, to {u.name}"
        rows: tuple[tuple[str, Signal | str, str, float], ...] = (
            ("measurement_gain", unit, f"gain on the difference of {shown} {ago}", 1.0),
            (
                "setpoint_gain",
                unit,
                f"gain on the difference of the setpoint of {y.name} {ago}",
                1.0,
            ),
            ("increment_gain", "1", f"gain on the move of {u.name} {{1}} samples ago", 0.0),
        )
        error = f"gain on the error of {y.name} in each sample, to {u.name}"
        found = signals.growing([signals.coefficient(path(y, "reference_gain"), unit, error)])
        for (stem, per, words, power), count in zip(rows, astuple(self.shape), strict=True):
            counted = row(signals.coefficient(path(y, stem), per, words), count)
            found += signals.growing(counted, power)
        return found

    def memory(self) -> list[Signal]:
        """Return what is remembered of measurement, setpoint and moves."""
        y, u, ago = self.measured, self.moved, "{1} samples ago"
        patterns = (
            signals.like(y, path(y, "past_value"), f"{self.what} of {y.name}, {ago}"),
            signals.like(y, path(y, "past_setpoint"), f"setpoint of {y.name}, {ago}"),
            Signal(path(y, "past_move"), u.unit, description=f"move of {u.name}, {ago}"),
        )
        counted = zip(patterns, astuple(self.shape), strict=True)
        return [each for pattern, count in counted for each in row(pattern, count)]

    def step(self, sample: Sample) -> None:
        """Write one sample."""
        y = [self.measured.name]
        self.act(sample, Reading.of(sample, y, y))

    def act(self, sample: Sample, reading: Reading) -> None:
        """Write what follows from what the loop acts on: one block for all loops of a shape."""
        y, u = self.measured, self.moved
        sample.parameters(*self.gains())
        sample.memory(*self.memory())
        declare_output(sample, u)
        found = sample.call(
            increments(self.shape),
            path(u, "loop"),
            y,
            u,
            value=reading.measurements[y.name],
            setpoint=reading.setpoints[y.name],
            known=reading.known,
            numbers=reading.numbers,
            sensors=reading.sensors,
        )
        give_output(sample, u, found)


def row(pattern: Signal, count: int, first: int = 1) -> list[Signal]:
    """Return the elements of a vector, whose words tell their places and those before."""
    return [
        replace(pattern, name=name, description=pattern.description.format(place - 1, place))
        for place, name in enumerate(elements(pattern.name, count), start=first)
    ]


@cache
def increments(shape: PolynomialShape) -> Block:
    """Return the block of a loop in increments."""
    loop = IncrementalLoop(shape, Signal("value"), Signal("output"))
    gains, memory = (
        [replace(entry, name=entry.name.removeprefix("value.")).port for entry in entries]
        for entries in (loop.gains(), loop.memory())
    )
    return Block(
        "_".join(map(str, ("increments", *astuple(shape)))),
        (
            Signal("setpoint", description="target value"),
            Signal("value", description="the measurement, or a prediction of it"),
            truth("known", "the value is a number from a good sensor"),
            *ASKED[2:],
            *gains,
            *OUTPUT_PORTS,
        ),
        (*memory, LAST_OUTPUT),
        output_results(),
        lambda s: _increments(s, shape),
        ("P u' = r0 w - Q y in the differences from one sample to the next.",),
    )


def products(s: Symbols, weights: str, values: Sequence[ca.SX]) -> list[ca.SX]:
    """Return each value times its weight."""
    names = elements(weights, len(values))
    return [s[name] * value for name, value in zip(names, values, strict=True)]


def _increments(s: Symbols, shape: PolynomialShape) -> Equations:
    counts = zip(("value", "setpoint", "move"), astuple(shape), strict=True)
    past = {what: [s[name] for name in elements(f"past_{what}", n)] for what, n in counts}

    def differences(what: str) -> list[ca.SX]:
        return [new - old for new, old in pairwise([s[what], *past[what]])]

    increment = s["reference_gain"] * (s["setpoint"] - s["value"])
    for part in products(s, "measurement_gain", differences("value")):
        increment = increment - part
    for part in products(s, "setpoint_gain", differences("setpoint")):
        increment = increment + part
    for part in products(s, "increment_gain", past["move"]):
        increment = increment - part
    known = ca.logic_and(s["numbers"], s["known"])
    asked = Asked(s["last_output"] + increment, known, s["numbers"], s["sensors"])
    applied, results, named = output_end(s, asked)
    # The sample counts where its signals were there and something was moved by them or in manual.
    acts = ca.logic_or(applied.in_force, applied.follows)
    counts_now = all_of([known, is_time_step(s["time_step"]), acts])
    state = {"last_output": applied.applied}
    for what, now, taken in (
        ("value", s["value"], counts_now),
        ("setpoint", s["setpoint"], counts_now),
        ("move", applied.applied - s["last_output"], acts),
    ):
        state |= shifted(s, f"past_{what}", len(past[what]), now, taken)
    return Equations(state, results, {"increment": increment, **named})


def shifted(s: Symbols, stem: str, count: int, now: ca.SX, counts: ca.SX) -> dict[str, ca.SX]:
    """Return a memory one sample later, or as it is where the sample does not count."""
    past = elements(stem, count)
    values = [now, *(s[name] for name in past)]
    return {n: ca.if_else(counts, new, s[n]) for n, new in zip(past, values, strict=False)}


FAMILY = "2DOF polynomial"


def polynomial_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    shapes: Sequence[PolynomialShape],
) -> StepLaw:
    """Write the step law of polynomial controllers, one from each measurement to an output.

    With Q y = Q(1) y + g1 ∇y + g2 ∇y(k−1) + …, R likewise, Q(1) = R(1) = r0 and ∇ the difference
    from one sample to the next, each sample in automatic::

        v  = u(k−1) + r0 (w − y) − Σ g_j ∇y(k−j+1) + Σ s_j ∇w(k−j+1) − Σ p_j ∇u(k−j)
        u  = min(high limit, max(low limit, v))

    So rounding leaves no offset however small r0 is, and the output leaves a limit as soon as
    the law asks for less. ∇u is what was really applied, in manual and at a limit too, so that
    automatic goes on from there without a bump. In a sample without a usable measurement or
    setpoint the output is held, and the law then goes on as if that sample had not been.

    `measured`, `manipulated`: the process signals of each loop: they lend their names, units and
    ranges; `shapes`: one for each loop.

    References
    ----------
    V. Bobál, J. Böhm, J. Fessl, J. Macháček, Digital Self-tuning Controllers: Algorithms,
    Implementation and Applications, Springer 2005.

    Examples
    --------
    One sample with r0 = 0.5 and g1 = 2 at an error of 1, after a rise of 0.25:

    >>> law = polynomial_law(["level"], ["pump"], [PolynomialShape(1)])
    >>> given = dict(sp=6, pv=5, good=1, mode=1, time_step=1)
    >>> values = {"level.reference_gain": 0.5, "level.measurement_gain.1": 2,
    ...           "pump.low_limit": 0, "pump.high_limit": 10}
    >>> before = {"pump.last_output": 3, "level.past_value.1": 4.75}
    >>> state, outputs, _ = law.function(
    ...     [before[entry.name] for entry in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0])
    3.0
    """
    pairs = zip(shapes, signals.paired(measured, manipulated), strict=True)
    return law_of_loops(
        "polynomial_control",
        [IncrementalLoop(shape, y, u) for shape, (y, u) in pairs],
        "u = u(k−1) + r0 (w − y) − Σ g_j ∇y(k−j+1) − Σ p_j ∇u(k−j) within the limits, ∇ being "
        "the difference between two samples: r0 is reference_gain, g_j measurement_gain, p_j "
        "increment_gain.",
    )


def law_of_loops(name: str, loops: Sequence[IncrementalLoop], *description: str) -> StepLaw:
    """Write the step law of loops, each from a measurement to an output."""

    def equations(sample: Sample) -> None:
        for loop in loops:
            loop.step(sample)

    measured = [loop.measured for loop in loops]
    return control_law(
        name,
        equations,
        measured=measured,
        controlled=measured,
        manipulated=[loop.moved for loop in loops],
        description=description,
    )
