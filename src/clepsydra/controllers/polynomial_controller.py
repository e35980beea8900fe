"""Polynomial control of two degrees of freedom, in increments: P ∇u = r0 w − Q y."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import told
from clepsydra.controllers.blocks.increments import increments
from clepsydra.controllers.blocks.ports import called, numbered
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
    shapes: Sequence[PolynomialShape],
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of polynomial controllers, loop i from measurement_i to manipulated_i.

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
    shapes : sequence of PolynomialShape
        One for each loop.
    measured, manipulated : sequence of Signal, optional
        The process signals of loop 1, 2, …: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs setpoint_i, measurement_i, sensor_i, mode_i, manual_i, tracking_i, time_step;
        parameters reference_gain_i, measurement_gain_i_j, setpoint_gain_i_j, increment_gain_i_j,
        low_limit_i, high_limit_i, which hold for one sampling period; outputs manipulated_i,
        status_i.

    Raises
    ------
    InputError
        There is no loop, or the signals are not one for each loop.

    References
    ----------
    V. Bobál, J. Böhm, J. Fessl, J. Macháček, Digital Self-tuning Controllers: Algorithms,
    Implementation and Applications, Springer 2005.

    Examples
    --------
    One sample with r0 = 0.5 and g1 = 2 at an error of 1, after a rise of 0.25:

    >>> law = polynomial_law([PolynomialShape(1)])
    >>> given = dict(setpoint_1=6, measurement_1=5, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(reference_gain_1=0.5, measurement_gain_1_1=2, low_limit_1=0, high_limit_1=10)
    >>> before = dict(last_output_1=3, past_measurement_1_1=4.75)
    >>> state, outputs, _ = law.function(
    ...     [before[entry.name] for entry in law.state],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0])
    3.0
    """
    count = len(shapes)
    measured = signals.wired_signals("measurement", count, measured, "polynomial law, measured")
    manipulated = signals.wired_signals("output", count, manipulated, "polynomial law, manipulated")
    loops = [
        IncrementalLoop(i, *parts)
        for i, parts in enumerate(zip(shapes, measured, manipulated, strict=True), start=1)
    ]

    def equations(symbols: Symbols) -> Equations:
        found = [loop.step(symbols, read(symbols, loop)) for loop in loops]
        return joined(found)

    return step_law(
        "polynomial_control",
        inputs=law_inputs(measured, manipulated),
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
    number : int
        i, from 1.
    shape : PolynomialShape
    measured, moved : Signal
    what : str
        What it acts on: the measurement, or a prediction of it.

    Examples
    --------
    >>> loop = IncrementalLoop(1, PolynomialShape(1), Signal("level", "m"), Signal("pump", "V"))
    >>> [parameter.name for parameter in loop.parameters()]
    ['reference_gain_1', 'measurement_gain_1_1', 'low_limit_1', 'high_limit_1']
    """

    number: int
    shape: PolynomialShape
    measured: Signal
    moved: Signal
    what: str = "measurement"

    def parameters(self) -> list[Signal]:
        """Return the gains and the limits."""
        i, y, u = self.number, self.measured, self.moved
        unit = signals.ratio_of_units(u.unit, y.unit)
        difference = (
            f"gain on the difference of {{}} between {{}} and {{}} samples ago, to {u.name}"
        )
        error = f"gain on the error of {y.name} in each sample, to {u.name}"
        found = [signals.coefficient(f"reference_gain_{i}", unit, error)]
        shown = y.name if self.what == "measurement" else f"the {self.what} of {y.name}"
        for stem, count, of in (
            ("measurement_gain", self.shape.measurement_gains, shown),
            ("setpoint_gain", self.shape.setpoint_gains, f"the setpoint of {y.name}"),
        ):
            found += [
                signals.coefficient(f"{stem}_{i}_{j}", unit, difference.format(of, j - 1, j))
                for j in range(1, count + 1)
            ]
        found += [
            signals.coefficient(
                f"increment_gain_{i}_{j}", "1", f"gain on the move of {u.name} {j} samples ago"
            )
            for j in range(1, self.shape.increment_gains + 1)
        ]
        return found + signals.limit_parameters(i, u)

    def states(self) -> list[Signal]:
        """Return what is remembered of measurement, setpoint and output."""
        i, y, u = self.number, self.measured, self.moved
        past = [
            signals.like(
                y, f"past_{self.what}_{i}_{j}", f"{self.what} of {y.name}, {j} samples ago"
            )
            for j in range(1, self.shape.measurement_gains + 1)
        ]
        past += [
            signals.like(y, f"past_setpoint_{i}_{j}", f"setpoint of {y.name}, {j} samples ago")
            for j in range(1, self.shape.setpoint_gains + 1)
        ]
        past += [
            Signal(f"past_move_{i}_{j}", u.unit, description=f"move of {u.name}, {j} samples ago")
            for j in range(1, self.shape.increment_gains + 1)
        ]
        return [*past, signals.last_output(i, u)]

    def outputs(self) -> list[Signal]:
        """Return manipulated_i and status_i."""
        return signals.output_signals(self.number, self.moved)

    def step(self, symbols: Symbols, read: Read) -> Equations:
        """Compute one sample: an instance of `increments`, one block for all loops of a shape."""
        i, shape = self.number, self.shape
        block = increments(shape.measurement_gains, shape.setpoint_gains, shape.increment_gains)
        # What the law calls the signals of the loop, whose numbers stand before the sample's.
        own = {"past_value": f"past_{self.what}_{i}"}
        names = {}
        for entry in (*block.state, *block.inputs):
            stem, _, j = entry.name.rpartition("_")
            if j.isdigit():
                names[entry.name] = f"{own.get(stem, f'{stem}_{i}')}_{j}"
        state = {entry.name: names.get(entry.name, f"last_output_{i}") for entry in block.state}
        given = {
            **numbered(symbols, block.inputs, i),
            **{local: symbols[name] for local, name in {**names, **state}.items()},
            "value": read.measurement,
            "setpoint": read.setpoint,
            "known": read.measurement_known,
            "numbers": read.numbers,
            "sensors": read.sensor,
        }
        found = called(block, f"{self.moved.identifier}_loop", given)
        status, conditions = told(found.outputs, i, self.moved)
        between = {f"{name}_{i}": value for name, value in found.intermediates.items()}
        return Equations(
            {name: found.next_state[local] for local, name in state.items()},
            {f"manipulated_{i}": found.outputs["manipulated"], f"status_{i}": status},
            {**between, **read.named, **conditions},
        )


def read(symbols: Symbols, loop: IncrementalLoop) -> Read:
    """Return what a loop reads of its inputs.

    Examples
    --------
    >>> loop = IncrementalLoop(1, PolynomialShape(0), Signal("level"), Signal("pump"))
    >>> symbols = dict(measurement_1=ca.DM(float("nan")), setpoint_1=ca.DM(6), sensor_1=ca.DM(1))
    >>> found = read(symbols, loop)
    >>> float(found.measurement), bool(found.numbers)
    (0.0, False)
    """
    i = loop.number
    raw, setpoint = symbols[f"measurement_{i}"], symbols[f"setpoint_{i}"]
    valid, given, sound = is_number(raw), is_number(setpoint), symbols[f"sensor_{i}"]
    return Read(
        measurement=value_or_zero(raw, valid),
        setpoint=value_or_zero(setpoint, given),
        measurement_known=ca.logic_and(valid, sound),
        numbers=ca.logic_and(valid, given),
        sensor=sound,
        named={f"measurement_is_number_{i}": valid, f"setpoint_is_number_{i}": given},
    )


def law_inputs(measured: Sequence[Signal], manipulated: Sequence[Signal]) -> list[Signal]:
    """Return the inputs of a law of loops from measurement_i to manipulated_i.

    Examples
    --------
    >>> [s.name for s in law_inputs([Signal("level")], [Signal("pump")])]
    ['setpoint_1', 'measurement_1', 'sensor_1', 'mode_1', 'manual_1', 'tracking_1', 'time_step']
    """
    return [
        *signals.setpoint_inputs(measured),
        *signals.measurement_inputs(measured),
        *signals.output_inputs(manipulated),
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
