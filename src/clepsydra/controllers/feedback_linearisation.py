"""Feedback linearisation: every output follows a PI controller of its own alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import get_args

import casadi as ca

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, cut_off
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.ports import Applied, Asked
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import any_of, time_step_of
from clepsydra.controllers.observers.observer import ModelObserver
from clepsydra.controllers.observers.state_source import ShownStates, sensors_of_states
from clepsydra.controllers.process_model import evaluated, models_in
from clepsydra.controllers.virtual_input import (
    ANTI_WINDUPS,
    AlphaOn,
    VirtualAntiWindup,
    VirtualInput,
)
from clepsydra.linear.relative_degree import VectorRelativeDegree
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class Evaluated:
    """The linearised process in a sample.

    Parameters
    ----------
    derivatives : list of list of casadi.SX
        For each output y, dy/dt, … by the drift alone; the last is its entry of L.
    effects : list of list of casadi.SX [q][m]
        E.
    state : list of casadi.SX
        What its source knows of the state.
    """

    derivatives: list[list[ca.SX]]
    effects: list[list[ca.SX]]
    state: list[ca.SX]

    def through(self, inputs: Sequence[ca.SX]) -> list[ca.SX]:
        """Return L + E u: the highest derivative of each output under these inputs."""
        return [
            sum((e * u for e, u in zip(row, inputs, strict=True) if not e.is_zero()), chain[-1])
            for chain, row in zip(self.derivatives, self.effects, strict=True)
        ]


class LinearisedProcess:
    """The equations of a linearised process within a step law.

    `observer`: where not every state is measured that the law needs.

    Raises InputError: A state that the law needs is neither measured nor estimated.
    """

    def __init__(
        self, linearised: VectorRelativeDegree, observer: ModelObserver | None = None
    ) -> None:
        self.linearised = linearised
        equations = linearised.equations
        # For each output its derivatives by the drift, then E row by row.
        drift = [each for chain in linearised.derivatives for each in chain[1:]]
        found = ca.vertcat(*drift, ca.vec(ca.densify(linearised.decoupling.T)))
        pairs = zip(equations.states, ca.vertsplit(equations.state), strict=True)
        needed = [name for name, symbol in pairs if ca.depends_on(found, symbol)]
        sensors = sensors_of_states(equations)
        known = observer.states if observer else sensors
        if missing := [name for name in needed if name not in known]:
            raise InputError(
                "feedback linearisation, state",
                ", ".join(missing),
                "a state that is measured or estimated: the law needs it",
                "add a sensor, or an observer",
            )
        self.source = observer or ShownStates(equations, {name: sensors[name] for name in needed})
        # What the law reads: the outputs, then what shows the other states.
        self.measurements = tuple(dict.fromkeys((*equations.outputs, *self.source.measurements)))
        self._expressions = found

    def evaluated(self, sample: Sample, shown: dict[str, ca.SX], known: ca.SX) -> Evaluated:
        """Return derivatives and effects in this sample.

        `shown`: what the `measurements` show, as numbers; `known`: whether they may be used.
        """
        equations, source = self.linearised.equations, self.source
        sample.parameters(*models_in(equations, [self._expressions]))
        state = ca.SX(equations.point.state)
        found = source.correct(sample, [shown[y] for y in source.measurements], known)
        for name, value in zip(source.states, found, strict=True):
            state[equations.states.index(name)] = value
        (terms,) = evaluated(equations, [self._expressions], sample.symbols, state)
        values = iter(ca.vertsplit(ca.densify(terms)))
        degrees = zip(equations.outputs, self.linearised.degrees, strict=True)
        derivatives = [[shown[y], *islice(values, degree)] for y, degree in degrees]
        effects = [list(islice(values, len(equations.inputs))) for _ in equations.outputs]
        return Evaluated(derivatives, effects, found)


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

    `linearised`: of a process at an operating point; `observer`: where not every state is measured
    that the law needs.

    Raises InputError: A state that the law needs is neither measured nor estimated, or a name is
    unknown.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, section 5.3,
    doi 10.1007/978-1-84628-615-5.
    """
    check_choice("anti_windup", anti_windup, ANTI_WINDUPS)
    check_choice("alpha_on", alpha_on, get_args(AlphaOn))
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
    return control_law(
        "feedback_linearisation",
        law.equations,
        measured=[process.signal(name) for name in law.known.measurements],
        controlled=[each.measurement for each in law.virtual],
        manipulated=law.manipulated,
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

    def equations(self, sample: Sample) -> None:
        outputs = [each.measurement.name for each in self.virtual]
        reading = Reading.of(sample, self.known.measurements, outputs)
        usable = ca.logic_and(reading.numbers, reading.sensors)
        time_step, _ = time_step_of(sample.symbols)
        process = self.known.evaluated(sample, reading.measurements, reading.known)
        last = sample.memory(*map(signals.last_output, self.manipulated))
        chains = zip(process.derivatives, process.through(last), strict=True)
        parts = [
            self.virtual[j].asked(sample, reading.setpoints[outputs[j]], chain[:-1], standing)
            for j, (chain, standing) in enumerate(chains)
        ]
        asked = [now + integral for now, integral in parts]
        unlimited = self._solved(sample, asked, process, last)
        applied = [
            final_element(sample, u, Asked(value, usable, reading.numbers, reading.sensors))
            for u, value in zip(self.manipulated, unlimited, strict=True)
        ]
        told = self._told(sample, process, unlimited, applied)
        for j, y in enumerate(outputs):
            proportional, integral = parts[j]
            given = {"proportional": proportional, "integral_used": integral}
            given |= {"error": reading.setpoints[y] - reading.measurements[y]}
            self.virtual[j].integrate(sample, {**given, **told[j], "time_step": time_step})
            sample.name(y, {"drift": process.derivatives[j][-1], "virtual": asked[j]})
        for u, value in zip(self.manipulated, unlimited, strict=True):
            sample.name(u, {"unlimited": value})
        self.known.source.predict(sample, process.state, [each.applied for each in applied])

    def _solved(
        self, sample: Sample, asked: list[ca.SX], process: Evaluated, last: list[ca.SX]
    ) -> list[ca.SX]:
        """Return u of L + E u = ν by elimination, around the inputs that stand."""
        order = self.known.linearised.order
        rows, pivots = {}, {}
        for j, i in order:
            controls, drift = self._controls(sample, j), process.derivatives[j][-1]
            # An input that is moved in manual stays where it is: its row says just that.
            rows[j] = [
                effect
                if effect.is_zero() and k != i
                else ca.if_else(controls, effect, float(k == i))
                for k, effect in enumerate(process.effects[j])
            ]
            rows[j].append(ca.if_else(controls, asked[j] - drift, last[i]))
        for step, (j, i) in enumerate(order):
            pivots[j] = self._pivot(sample, j, rows[j][i])
            for other, _ in order[step + 1 :]:
                if not rows[other][i].is_zero():
                    share = rows[other][i] / pivots[j]
                    rows[other] = [
                        low if high.is_zero() else low - share * high
                        for low, high in zip(rows[other], rows[j], strict=True)
                    ]
        found = [ca.SX(0)] * len(last)
        for step, (j, i) in reversed(list(enumerate(order))):
            rest = rows[j][-1]
            for _, later in order[step + 1 :]:
                if not rows[j][later].is_zero():
                    rest = rest - rows[j][later] * found[later]
            found[i] = rest / pivots[j]
        return found

    def _controls(self, sample: Sample, output: int) -> ca.SX:
        """Return whether the input of an output is in automatic."""
        return sample[path(self.virtual[output].moved, "mode")] == Mode.AUTOMATIC

    def _pivot(self, sample: Sample, output: int, value: ca.SX) -> ca.SX:
        """Return a divisor that is not zero: as it is, or the smallest that is divided by."""
        smallest = sample[path(self.virtual[output].measurement, "smallest_effect")]
        large = ca.logic_and(ca.fabs(value) >= ca.fabs(smallest), value != 0)
        safe = ca.if_else(smallest == 0, 1, smallest)
        return ca.if_else(self._controls(sample, output), ca.if_else(large, value, safe), 1)

    def _told(
        self, sample: Sample, process: Evaluated, unlimited: list[ca.SX], applied: list[Applied]
    ) -> list[dict[str, ca.SX]]:
        """Return for each virtual input what became of it, see `VirtualInput.integrate`."""
        moved = [each.applied for each in applied]
        limits = [sample.of(u, "low_limit", "high_limit") for u in self.manipulated]
        cut = [
            cut_off(value, given, *ends)
            for value, given, ends in zip(unlimited, moved, limits, strict=True)
        ]
        reached = process.through(moved)
        middle = process.through([0.5 * (low + high) for low, high in limits])
        told = []
        for j, i in sorted(self.known.linearised.order):
            effects = process.effects[j]
            ends = [reached[j] + effects[i] * (limit - moved[i]) for limit in limits[i]]
            told.append(
                {
                    "applied": reached[j],
                    "cut": any_of([cut[k] for k, each in enumerate(effects) if not each.is_zero()]),
                    "middle": middle[j],
                    "low_limit": ca.fmin(*ends),
                    "high_limit": ca.fmax(*ends),
                    "input_excess": unlimited[i] - moved[i],
                    "in_force": applied[i].in_force,
                }
            )
        return told
