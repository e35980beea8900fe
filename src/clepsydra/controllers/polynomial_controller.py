"""Polynomial control of two degrees of freedom, in increments: P ∇u = r0 w − Q y."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import told
from clepsydra.controllers.blocks.increments import increments
from clepsydra.controllers.blocks.ports import as_parts, called, parts_of
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "2DOF polynomial"


@dataclass(frozen=True)
class PolynomialShape:
    """How many gains one loop has.

    Parameters
    ----------
    measurement_gains : int
        On the last differences of the measurement: the degree of Q.
    setpoint_gains : int
        On those of the setpoint: the degree of R, which is zero by equation (24).
    increment_gains : int
        On the last increments of the output: the degree of P.

    Raises
    ------
    InputError
        A number is negative.

    Examples
    --------
    >>> PolynomialShape(2)
    PolynomialShape(measurement_gains=2, setpoint_gains=0, increment_gains=0)
    """

    measurement_gains: int
    setpoint_gains: int = 0
    increment_gains: int = 0

    def __post_init__(self) -> None:
        for count in (self.measurement_gains, self.setpoint_gains, self.increment_gains):
            if count < 0:
                raise InputError(
                    "polynomial controller", count, "degrees from 0 on", "correct the degree"
                )


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
    the law asks for less. ∇u is what was really applied, by hand and at a limit too, so that
    automatic goes on from there without a bump. In a sample without a usable measurement or
    setpoint the output is held, and the law then goes on as if that sample had not been.

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The process signals of each loop: they lend their names, units and ranges.
    shapes : sequence of PolynomialShape
        One for each loop.

    Returns
    -------
    StepLaw
        Inputs sp, pv and good of each measurement, mode, manual and tracking of each output, and
        time_step; parameters reference_gain, measurement_gain.J, setpoint_gain.J and
        increment_gain.J of each measurement, which hold for one sampling period, low_limit and
        high_limit of each output; outputs out and status of each output.

    Raises
    ------
    InputError
        There is no loop, or the signals or shapes are not one for each loop.

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
    pairs = signals.paired(measured, manipulated, "polynomial law")
    check_shapes(shapes, pairs, "polynomial law")
    loops = [IncrementalLoop(shape, *pair) for shape, pair in zip(shapes, pairs, strict=True)]

    def equations(symbols: Symbols) -> Equations:
        found = [loop.step(symbols, read(symbols, loop)) for loop in loops]
        return joined(found)

    return step_law(
        "polynomial_control",
        inputs=law_inputs(pairs),
        parameters=[p for loop in loops for p in loop.parameters()],
        state=[s for loop in loops for s in loop.states()],
        outputs=[o for loop in loops for o in loop.outputs()],
        equations=equations,
        description=(
            "u = u(k−1) + r0 (w − y) − Σ g_j ∇y(k−j+1) − Σ p_j ∇u(k−j) within the limits, ∇ being "
            "the difference between two samples: r0 is reference_gain, g_j measurement_gain, p_j "
            "increment_gain.",
        ),
    )


@dataclass(frozen=True)
class Read:
    """What a loop acts on in a sample.

    Parameters
    ----------
    measurement, setpoint : casadi.SX
        Zero where they are no numbers.
    measurement_known : casadi.SX
        Whether the measurement is a number from a sound sensor.
    numbers, sensor : casadi.SX
        Whether both are numbers, and the sensor sound.
    named : dict

    Examples
    --------
    >>> true = ca.DM(1)
    >>> float(Read(ca.DM(5), ca.DM(6), true, true, true, {}).setpoint)
    6.0
    """

    measurement: ca.SX
    setpoint: ca.SX
    measurement_known: ca.SX
    numbers: ca.SX
    sensor: ca.SX
    named: dict[str, ca.SX]


@dataclass(frozen=True)
class IncrementalLoop:
    """One loop of a law in increments.

    Parameters
    ----------
    shape : PolynomialShape
    measured, moved : Signal
    what : str
        What it acts on: the measurement, or a prediction of it.

    Examples
    --------
    >>> loop = IncrementalLoop(PolynomialShape(1), Signal("level", "m"), Signal("pump", "V"))
    >>> [parameter.name for parameter in loop.parameters()]
    ['level.reference_gain', 'level.measurement_gain.1', 'pump.low_limit', 'pump.high_limit']
    """

    shape: PolynomialShape
    measured: Signal
    moved: Signal
    what: str = "measurement"

    def parameters(self) -> list[Signal]:
        """Return the gains and the limits."""
        y, u = self.measured, self.moved
        unit = signals.per(u, y)
        difference = (
            f"gain on the difference of {{}} between {{}} and {{}} samples ago, to {u.name}"
        )
        error = f"gain on the error of {y.name} in each sample, to {u.name}"
        found = [signals.coefficient(path(y, "reference_gain"), unit, error)]
        shown = y.name if self.what == "measurement" else f"the {self.what} of {y.name}"
        for what, count, of in (
            ("measurement_gain", self.shape.measurement_gains, shown),
            ("setpoint_gain", self.shape.setpoint_gains, f"the setpoint of {y.name}"),
        ):
            found += [
                signals.coefficient(name, unit, difference.format(of, j - 1, j))
                for j, name in enumerate(elements(path(y, what), count), start=1)
            ]
        moves = elements(path(y, "increment_gain"), self.shape.increment_gains)
        found += [
            signals.coefficient(name, "1", f"gain on the move of {u.name} {j} samples ago")
            for j, name in enumerate(moves, start=1)
        ]
        return found + signals.limit_parameters(u)

    def states(self) -> list[Signal]:
        """Return what is remembered of measurement, setpoint and output."""
        y, u, shape = self.measured, self.moved, self.shape
        past = [
            signals.like(y, name, f"{what} of {y.name}, {j} samples ago")
            for part, count, what in (
                ("past_value", shape.measurement_gains, self.what),
                ("past_setpoint", shape.setpoint_gains, "setpoint"),
            )
            for j, name in enumerate(elements(path(y, part), count), start=1)
        ]
        past += [
            Signal(name, u.unit, description=f"move of {u.name}, {j} samples ago")
            for j, name in enumerate(elements(path(y, "past_move"), shape.increment_gains), start=1)
        ]
        return [*past, signals.last_output(u)]

    def outputs(self) -> list[Signal]:
        """Return out and status."""
        return signals.output_signals(self.moved)

    def step(self, symbols: Symbols, read: Read) -> Equations:
        """Compute one sample: an instance of `increments`, one block for all loops of a shape."""
        y, u, shape = self.measured, self.moved, self.shape
        block = increments(shape.measurement_gains, shape.setpoint_gains, shape.increment_gains)
        ports = (*block.state, *block.inputs)
        given = {
            **parts_of(y, symbols, ports),
            **parts_of(u, symbols, ports),
            "value": read.measurement,
            "setpoint": read.setpoint,
            "known": read.measurement_known,
            "numbers": read.numbers,
            "sensors": read.sensor,
        }
        found = called(block, path(u, "loop"), given)
        status, conditions = told(found.outputs, u)
        memory = found.next_state
        return Equations(
            {path(u if name == "last_output" else y, name): memory[name] for name in memory},
            as_parts(u, {"out": found.outputs["manipulated"], "status": status}),
            {**as_parts(y, found.intermediates), **read.named, **conditions},
        )


def read(symbols: Symbols, loop: IncrementalLoop) -> Read:
    """Return what a loop reads of its inputs.

    Examples
    --------
    >>> loop = IncrementalLoop(PolynomialShape(0), Signal("level"), Signal("pump"))
    >>> nan = ca.DM(float("nan"))
    >>> symbols = {"level.pv": nan, "level.sp": ca.DM(6), "level.good": ca.DM(1)}
    >>> found = read(symbols, loop)
    >>> float(found.measurement), bool(found.numbers)
    (0.0, False)
    """
    raw, setpoint, sound = (symbols[path(loop.measured, part)] for part in ("pv", "sp", "good"))
    valid, given = is_number(raw), is_number(setpoint)
    named = {"measurement_is_number": valid, "setpoint_is_number": given}
    return Read(
        measurement=value_or_zero(raw, valid),
        setpoint=value_or_zero(setpoint, given),
        measurement_known=ca.logic_and(valid, sound),
        numbers=ca.logic_and(valid, given),
        sensor=sound,
        named=as_parts(loop.measured, named),
    )


def check_shapes(shapes: Sequence[object], pairs: Sequence[object], place: str) -> None:
    """Refuse shapes that are not one for each loop.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_shapes([], [("level", "pump")], "polynomial law")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: polynomial law, shapes: got 0, expected 1, one for each \
loop; give one for each.
    """
    if len(shapes) != len(pairs):
        raise InputError(
            f"{place}, shapes", len(shapes), f"{len(pairs)}, one for each loop", "give one for each"
        )


def law_inputs(pairs: Sequence[tuple[Signal, Signal]]) -> list[Signal]:
    """Return the inputs of a law of loops, each from a measurement to an output.

    Examples
    --------
    >>> [s.name for s in law_inputs([(Signal("level"), Signal("pump"))])][:4]
    ['level.sp', 'level.pv', 'level.good', 'pump.mode']
    """
    measured = [y for y, _ in pairs]
    return [
        *signals.setpoint_inputs(measured),
        *signals.measurement_inputs(measured),
        *signals.output_inputs([u for _, u in pairs]),
    ]


def joined(loops: Sequence[Equations]) -> Equations:
    """Return the equations of all loops as those of one law.

    Examples
    --------
    >>> one, two = Equations({"a": 1.0}, {}), Equations({"b": 2.0}, {})
    >>> sorted(joined([one, two]).next_state)
    ['a', 'b']
    """
    total = Equations({}, {}, {})
    for loop in loops:
        total = Equations(
            {**total.next_state, **loop.next_state},
            {**total.outputs, **loop.outputs},
            {**total.intermediates, **loop.intermediates},
        )
    return total
