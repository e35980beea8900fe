"""Active disturbance rejection: loops that estimate the load and balance it at once."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.ports import Asked
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.validity import all_of, is_number, time_step_of
from clepsydra.program.step_law import StepLaw

FAMILY = "active disturbance rejection"
_FASTEST = 1.0 / signals.SHORTEST_TIME
_BANDWIDTH = Key("bandwidth", "1/s", "bandwidth of the loop", 0.0, _FASTEST, 0.01)
_OBSERVER = Key("observer_bandwidth", "1/s", "bandwidth of the observer", 0.0, _FASTEST, 0.05)
_MODEL_GAIN = signals.signed(
    "model_gain", "{measurement}/({output} s)", "rate of {measurement} for each of {output}", 1.0
)
_ESTIMATE = Key("estimate", "{measurement}", "{measurement} by the observer")
_BALANCE = Key("balance", "{output}", "{output} that balances the load")
_LOST = Key("lost", "1", "{measurement} was not known", 0.0, 1.0, kind="boolean")
_DESCRIPTION = (
    "Model: y rises at the rate b0 (u − u°); b0 is model_gain, u° the balance, which the observer "
    "finds from what y does: the load, and whatever else the model lacks.",
    "With z = 1/(1 + ωo Δt) and e = y − (ŷ + Δt b0 (u(k−1) − u°)), ŷ⁺ = y − z² e and "
    "u°⁺ = u° − (ωo z)² Δt e/b0; ωo is observer_bandwidth.",
    "u = u° + ωc/b0 (w − ŷ) within the limits; ωc is bandwidth.",
)


def disturbance_rejection_law(
    measured: Sequence[Signal | str], manipulated: Sequence[Signal | str]
) -> StepLaw:
    """Write the step law of linear active disturbance rejection, a loop for each pair.

    The process is taken as ẏ = b0 (u − u°): an integrator whose balancing input u° is unknown.
    All that the model lacks is in u°, the load first of all. An observer estimates both, and the
    law is proportional control about the balance::

        z  = 1/(1 + ωo Δt)
        e  = y − (ŷ + Δt b0 (u(k−1) − u°))
        ŷ⁺ = y − z² e,    u°⁺ = u° − (ωo z)² Δt e/b0
        u  = u°⁺ + ωc/b0 (w − ŷ⁺)

    Both poles of the observer lie at z, for whatever time step. It is told what was applied, at a
    limit and in manual too, so that nothing winds up and automatic goes on from there. While the
    measurement is not known it waits, and then goes on from the first value with the balance that
    it had.

    `measured`, `manipulated`: the process signals of each loop: they lend their names, units and
    ranges.

    References
    ----------
    Z. Gao, Scaling and bandwidth-parameterization based controller tuning, American Control
    Conference 2003, 4989-4996; G. Herbst, A simulative study on active disturbance rejection
    control (ADRC) as a control tool for practitioners, Electronics 2(3), 2013, 246-279,
    doi 10.3390/electronics2030246.

    Examples
    --------
    At the setpoint, y has risen by 0.3 where the model saw nothing move; z = 1/2 and b0 = 0.1
    make of it 0.25 · 0.3/0.1 = 0.75 less of u:

    >>> law = disturbance_rejection_law(["level"], ["pump"])
    >>> given = dict(sp=5.225, pv=5.3, good=1, mode=1, time_step=1)
    >>> values = dict(bandwidth=0.2, observer_bandwidth=1, model_gain=0.1, low_limit=0,
    ...               high_limit=10)
    >>> before = dict(estimate=5, balance=4, last_output=4)
    >>> state, outputs, _ = law.function(
    ...     [before.get(signal.part, 0) for signal in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.part] for signal in law.parameters],
    ... )
    >>> round(float(outputs[0]), 9), [round(float(value), 9) for value in state.elements()]
    (3.25, [5.225, 3.25, 0.0, 3.25])
    """
    pairs = signals.paired(measured, manipulated)
    controlled, moved = [y for y, _ in pairs], [u for _, u in pairs]
    return control_law(
        "disturbance_rejection",
        lambda sample: _equations(sample, pairs),
        measured=controlled,
        controlled=controlled,
        manipulated=moved,
        description=_DESCRIPTION,
    )


def _equations(sample: Sample, pairs: Sequence[tuple[Signal, Signal]]) -> None:
    time_step, time_step_good = time_step_of(sample.symbols)
    for y, u in pairs:
        reading = Reading.of(sample, [y.name], [y.name])
        level, known = reading.measurements[y.name], reading.known
        bandwidth, fast, slope = sample.parameters(
            *(key.of(y, measurement=y, output=u) for key in (_BANDWIDTH, _OBSERVER, _MODEL_GAIN))
        )
        estimate, balance, lost, last = sample.memory(
            *(key.of(y, measurement=y, output=u) for key in (_ESTIMATE, _BALANCE, _LOST)),
            signals.last_output(u),
        )
        # Set to zero at run time there is no law, and nothing is divided by it.
        known = ca.logic_and(known, slope != 0)
        slope = ca.if_else(slope != 0, slope, 1)
        pole = 1 / (1 + ca.fmax(fast * time_step, 0))
        moved = time_step * (slope * (last - balance))
        surprise = ca.if_else(lost, 0, level - (estimate + moved))
        step = (fast * pole) * ((fast * pole) * (time_step * surprise))
        following, balanced = level - (pole * pole) * surprise, balance - step / slope
        goes_on = all_of([known, time_step_good, is_number(following), is_number(balanced)])
        estimate = ca.if_else(goes_on, following, estimate)
        balance = ca.if_else(goes_on, balanced, balance)
        sample.next_state |= {
            path(y, "estimate"): estimate,
            path(y, "balance"): balance,
            path(y, "lost"): ca.logic_not(reading.known),
        }
        asked = balance + (bandwidth / slope) * (reading.setpoints[y.name] - estimate)
        sample.name(y, {"pole": pole, "surprise": surprise, "asked": asked})
        usable = ca.logic_and(known, reading.numbers)
        final_element(sample, u, Asked(asked, usable, reading.numbers, reading.sensors))
