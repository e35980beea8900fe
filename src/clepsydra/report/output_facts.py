"""What is to be set for a manipulated variable: its limits and its value at rest."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.report.facts import DIGITS
from clepsydra.report.quantities import quantity_text


def output_facts(number: int, signal: Signal, controller: Controller) -> list[tuple[str, str]]:
    """Return limits, rate limit and the value at rest of output `number`, in display units.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> values = {"low_limit_1": 0.0, "high_limit_1": 10.0}
    >>> controller = SimpleNamespace(values=values, initial_state={"last_output_1": 3.0})
    >>> output_facts(1, pump, controller)
    [('output limits', '0 to 10.00 V'), ('output at rest', '3.000 V')]
    """
    values, state = controller.values, controller.initial_state
    facts = []
    if f"low_limit_{number}" in values:
        low, high = (
            quantity_text(signal, values[f"{end}_limit_{number}"], DIGITS)
            for end in ("low", "high")
        )
        facts.append(("output limits", f"{low.split(' ')[0]} to {high}"))
    rate = values.get(f"rate_limit_{number}", LARGEST_PARAMETER)
    if rate < LARGEST_PARAMETER:
        facts.append(("rate limit", f"{quantity_text(signal, rate, DIGITS)} per s"))
    if f"last_output_{number}" in state:
        at_rest = quantity_text(signal, state[f"last_output_{number}"], DIGITS)
        facts.append(("output at rest", at_rest))
    return facts
