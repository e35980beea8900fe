"""What is to be set for a manipulated variable: its limits and its value at rest."""

from __future__ import annotations

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.report.facts import DIGITS
from clepsydra.report.quantities import quantity_text


def output_facts(signal: Signal, controller: Controller) -> list[tuple[str, str]]:
    """Return limits, rate limit and the value at rest of an output, in display units.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> values = {"pump_1.low_limit": 0.0, "pump_1.high_limit": 10.0}
    >>> controller = SimpleNamespace(values=values, initial_state={"pump_1.last_output": 3.0})
    >>> output_facts(pump, controller)
    [('output limits', '0 to 10.00 V'), ('output at rest', '3.000 V')]
    """
    values, state = controller.values, controller.initial_state
    facts = []
    ends = [path(signal, f"{end}_limit") for end in ("low", "high")]
    if ends[0] in values:
        low, high = (quantity_text(signal, values[end], DIGITS) for end in ends)
        facts.append(("output limits", f"{low.split(' ')[0]} to {high}"))
    rate = values.get(path(signal, "rate_limit"), LARGEST_PARAMETER)
    if rate < LARGEST_PARAMETER:
        facts.append(("rate limit", f"{quantity_text(signal, rate, DIGITS)} per s"))
    if (last := path(signal, "last_output")) in state:
        facts.append(("output at rest", quantity_text(signal, state[last], DIGITS)))
    return facts
