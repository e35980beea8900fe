"""Feedback linearisation: inputs that make every output follow its own PI controller alone."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS
from clepsydra.controllers.blocks.final_element import FinalElement, final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.ports import as_parts
from clepsydra.controllers.blocks.validity import (
    all_of,
    any_of,
    is_number,
    is_time_step,
    value_or_zero,
)
from clepsydra.controllers.blocks.variable_structure import cut_off
from clepsydra.controllers.linearised_process import Evaluated, LinearisedProcess
from clepsydra.controllers.observers.model_observer import ModelObserver
from clepsydra.controllers.virtual_input import (
    AlphaOn,
    Applied,
    VirtualAntiWindup,
    VirtualInput,
    check_virtual_anti_windup,
)
from clepsydra.linear.relative_degree import VectorRelativeDegree
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "feedback linearisation"


def feedback_linearisation_law(
    linearised: VectorRelativeDegree,
    *,
    anti_windup: VirtualAntiWindup = "variable_structure",
    alpha_on: AlphaOn = "virtual",
    observer: ModelObserver | None = None,
) -> StepLaw:
    """Write the step law u = E⁻¹ (ν − L) with a PI controller for each virtual input ν.

    With d^r y/dt^r = L(x) + E(x) u, each output follows d^r y/dt^r = ν, and

        ν = Kp (b r − y) + I − Σ m_k dᵏy/dtᵏ,  I′ = Ki (r − y),

    with dᵏy/dtᵏ from the state and not from differences. E is solved by elimination in the
    order that is best at the operating point, output by output. No pivot is taken below
    smallest_effect, a share of what it is there, so that nothing is divided by zero where a
    tank is empty and its valve moves nothing: the output then asks for more than the limits
    give, in the direction that is right at the operating point.

    An input that is not in automatic stands where it is, and the others are solved around it.
    When automatic takes over, after a change of mode or a fault, the integral restarts so that
    the input goes on from where it stands. A change of Kp, b or m_k makes no bump either.

    Anti-windup acts on ν: what was asked for beside L + E u with the inputs that were applied.
    Variable structure lets the excess die away with the rate α while the error pushes on into
    the limit; with `alpha_on="input"` it takes back α times the excess of the input, in
    its unit, so that α depends on the units and on E.

    Parameters
    ----------
    linearised : VectorRelativeDegree
        Of a process at an operating point.
    anti_windup : {"variable_structure", "clamping", "conditional_integration", \
"back_calculation", "none"}
    alpha_on : {"virtual", "input"}
    observer : ModelObserver, optional
        Where not every state is measured that the law needs.

    Returns
    -------
    StepLaw
        Inputs sp of each output, pv and good of each measurement, mode, manual and tracking of
        each input, and time_step [s]; parameters virtual_gain, virtual_integral_gain,
        setpoint_weight, virtual_damping.K, saturation_rate [1/s] (or saturation_feedback, or
        tracking_time [s]) and smallest_effect of each output, those of the model and of the
        observer, low_limit and high_limit of each input; state virtual_integral, was_in_force
        and the last gains of each output, last_output of each input, and the estimates; outputs
        out and status of each input.

    Raises
    ------
    InputError
        A state that the law needs is neither measured nor estimated, or a name is unknown.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, section 5.3,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.relative_degree import relative_degree
    >>> law = feedback_linearisation_law(relative_degree(cl.load("quadruple-tank").linear))
    >>> [signal.name for signal in law.inputs if signal.part == "pv"]
    ['level_1.pv', 'level_2.pv', 'level_3.pv', 'level_4.pv']
    """
    check_virtual_anti_windup(anti_windup, alpha_on)
    equations = linearised.equations
    process, paired = equations.point.process, dict(linearised.order)
    law = _Law(
        LinearisedProcess(linearised, observer),
        tuple(
            VirtualInput(
                process.signal(name),
                linearised.degrees[j],
                anti_windup,
                alpha_on,
                process.signal(equations.inputs[paired[j]]),
            )
            for j, name in enumerate(equations.outputs)
        ),
        tuple(process.signal(name) for name in equations.inputs),
    )
    return step_law(
        "feedback_linearisation",
        inputs=law.inputs(),
        parameters=law.parameters(),
        state=law.state(),
        outputs=law.outputs(),
        equations=law.equations,
        description=(
            "u = E⁻¹ (ν − L) within the limits, with d^r y/dt^r = L + E u from the equations of "
            "the process, and ν = Kp (b r − y) + I − Σ m_k dᵏy/dtᵏ, I⁺ = I + Δt Ki (r − y), each "
            "sample.",
            f"Anti-windup: {IN_WORDS[anti_windup]}.",
        ),
    )


@dataclass(frozen=True, eq=False)
class _Law:
    known: LinearisedProcess
    virtual: tuple[VirtualInput, ...]
    manipulated: tuple[Signal, ...]

    @property
    def paired(self) -> dict[int, int]:
        """Place of each output to that of its input."""
        return dict(self.known.linearised.order)

    def inputs(self) -> list[Signal]:
        process = self.known.linearised.equations.point.process
        return [
            *signals.setpoint_inputs([each.measurement for each in self.virtual]),
            *signals.measurement_inputs([process.signal(n) for n in self.known.measurements]),
            *signals.output_inputs(self.manipulated),
        ]

    def parameters(self) -> list[Signal]:
        found = [signal for each in self.virtual for signal in each.parameters()]
        found += [smallest_effect(each) for each in self.virtual]
        found += self.known.parameters()
        return found + [p for moved in self.manipulated for p in signals.limit_parameters(moved)]

    def state(self) -> list[Signal]:
        observer = self.known.observer
        return [
            *(signal for each in self.virtual for signal in each.state()),
            *map(signals.last_output, self.manipulated),
            *([] if observer is None else observer.state()),
        ]

    def outputs(self) -> list[Signal]:
        return [result for moved in self.manipulated for result in signals.output_signals(moved)]

    def equations(self, symbols: Symbols) -> Equations:
        names = self.known.measurements
        count = len(names)
        raw = [symbols[path(name, "pv")] for name in names]
        raw += [symbols[path(each.measurement, "sp")] for each in self.virtual]
        valid = [is_number(value) for value in raw]
        values = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        measured, setpoints = values[:count], values[count:]
        sensors = all_of([symbols[path(name, "good")] for name in names])
        measured_well = ca.logic_and(all_of(valid[:count]), sensors)
        numbers = all_of(valid)
        usable = ca.logic_and(numbers, sensors)
        time_step = ca.if_else(is_time_step(symbols["time_step"]), symbols["time_step"], 1)
        process = self.known.evaluated(symbols, measured, measured_well)
        last = [symbols[path(moved, "last_output")] for moved in self.manipulated]
        standing = process.through(last)
        asked, integrals = [], []
        for j, each in enumerate(self.virtual):
            below = process.derivatives[j][:-1]
            now = each.nonintegral(symbols, setpoints[j], below)
            former = each.nonintegral(symbols, setpoints[j], below, former=True)
            integrals.append(each.integral(symbols, now, former, standing[j]))
            asked.append(now + integrals[j])
        unlimited = self._solved(symbols, asked, process, last)
        elements = [
            final_element(symbols, moved, Asked(value, usable, numbers, sensors))
            for moved, value in zip(self.manipulated, unlimited, strict=True)
        ]
        told = self._told(symbols, process, unlimited, elements)
        next_state: dict[str, ca.SX] = {}
        named: dict[str, ca.SX] = {}
        for j, each in enumerate(self.virtual):
            y = each.measurement
            gain = symbols[path(y, "virtual_integral_gain")]
            increment = time_step * gain * (setpoints[j] - measured[j])
            next_state |= each.next_state(
                symbols, integrals[j], increment, asked[j], told[j], time_step
            )
            named |= as_parts(y, {"drift": process.derivatives[j][-1], "virtual": asked[j]})
        outputs: dict[str, ca.SX] = {}
        for moved, value, element in zip(self.manipulated, unlimited, elements, strict=True):
            next_state[path(moved, "last_output")] = element.manipulated
            outputs |= as_parts(moved, {"out": element.manipulated, "status": element.status})
            named |= {path(moved, "unlimited"): value} | element.named
        next_state |= process.following([element.manipulated for element in elements])
        return Equations(next_state, outputs, named)

    def _solved(
        self, symbols: Symbols, asked: list[ca.SX], process: Evaluated, last: list[ca.SX]
    ) -> list[ca.SX]:
        """Return u of L + E u = ν by elimination, around the inputs that stand."""
        rows, right = [], []
        for j, chain in enumerate(process.derivatives):
            i = self.paired[j]
            controls = symbols[path(self.manipulated[i], "mode")] == Mode.AUTOMATIC
            unit = [ca.SX(float(k == i)) for k in range(len(last))]
            # An input that is moved by hand stays where it is: its row says just that.
            rows.append(
                [
                    effect if effect.is_zero() and k != i else ca.if_else(controls, effect, one)
                    for k, (effect, one) in enumerate(zip(process.effects[j], unit, strict=True))
                ]
            )
            right.append(ca.if_else(controls, asked[j] - chain[-1], last[i]))
        pivots = {}
        order = self.known.linearised.order
        for step, (j, i) in enumerate(order):
            pivots[j] = self._pivot(symbols, j, rows[j][i])
            for other, _ in order[step + 1 :]:
                if rows[other][i].is_zero():
                    continue
                share = rows[other][i] / pivots[j]
                right[other] = right[other] - share * right[j]
                rows[other] = [
                    low if high.is_zero() else low - share * high
                    for low, high in zip(rows[other], rows[j], strict=True)
                ]
        found = [ca.SX(0)] * len(last)
        for step, (j, i) in reversed(list(enumerate(order))):
            rest = right[j]
            for _, later in order[step + 1 :]:
                if not rows[j][later].is_zero():
                    rest = rest - rows[j][later] * found[later]
            found[i] = rest / pivots[j]
        return found

    def _pivot(self, symbols: Symbols, output: int, value: ca.SX) -> ca.SX:
        """Return a divisor that is not zero: as it is, or the smallest that is divided by."""
        each = self.virtual[output]
        smallest = symbols[path(each.measurement, "smallest_effect")]
        controls = symbols[path(each.moved, "mode")] == Mode.AUTOMATIC
        large = ca.logic_and(ca.fabs(value) >= ca.fabs(smallest), value != 0)
        safe = ca.if_else(smallest == 0, 1, smallest)
        return ca.if_else(controls, ca.if_else(large, value, safe), 1)

    def _told(
        self,
        symbols: Symbols,
        process: Evaluated,
        unlimited: list[ca.SX],
        elements: list[FinalElement],
    ) -> list[Applied]:
        """Return for each virtual input what became of it."""
        moved = [element.manipulated for element in elements]
        limits = [
            (symbols[path(u, "low_limit")], symbols[path(u, "high_limit")])
            for u in self.manipulated
        ]
        cut = [
            cut_off(value, element, low, high)
            for value, element, (low, high) in zip(unlimited, moved, limits, strict=True)
        ]
        reached = process.through(moved)
        middle = process.through([0.5 * (low + high) for low, high in limits])
        told = []
        for j, i in sorted(self.paired.items()):
            effect = process.effects[j][i]
            ends = [reached[j] + effect * (limit - moved[i]) for limit in limits[i]]
            acting = [cut[k] for k, each in enumerate(process.effects[j]) if not each.is_zero()]
            told.append(
                Applied(
                    virtual=reached[j],
                    cut=any_of(acting),
                    middle=middle[j],
                    low=ca.fmin(*ends),
                    high=ca.fmax(*ends),
                    input_excess=unlimited[i] - moved[i],
                    in_force=elements[i].applied.in_force,
                )
            )
        return told


def smallest_effect(virtual: VirtualInput) -> Signal:
    """Return smallest_effect, below which no effect of an input is divided by.

    Examples
    --------
    >>> level, pump = Signal("level", "V"), Signal("pump", "V")
    >>> smallest_effect(VirtualInput(level, 1, "none", "virtual", pump)).unit
    'V/s/V'
    """
    moved, measured = virtual.moved, virtual.measurement
    return signals.gain(
        path(measured, "smallest_effect"),
        signals.per(virtual.quantity, moved),
        1.0,
        f"smallest effect of {moved.name} on {measured.name} that is divided by",
    )
