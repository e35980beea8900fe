"""What decoupling and feedforward add to the outputs of PID blocks, for who enters it by hand."""

from __future__ import annotations

from clepsydra.base.units import from_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.deploy.vendor_tuning.printed_gain import gain_words, printed_number
from clepsydra.deploy.vendor_tuning.standard_tuning import known_signal
from clepsydra.process.process import Process


def beside_blocks(controller: Controller, process: Process) -> tuple[str, ...]:
    """Return a sentence for each signal that moves an output beside its PID block.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> beside_blocks(cl.design.simc(plant, decoupling="static"), plant.process)[0]
    'Add to pump_1 what pump_2 moves from 3 V, times -0.57486 V/V = -0.57486 %/%.'
    """
    sums = (block for block in controller.law.blocks if isinstance(block, FeedforwardBlock))
    return tuple(_added(term, controller, process) for block in sums for term in block.terms)


def _added(term: FeedforwardTerm, controller: Controller, process: Process) -> str:
    signal, moved = (known_signal(process, each) for each in (term.signal, term.moved))
    gain, reference, *times = (controller.values[each.name] for each in term.parameters())
    unit = "" if signal.shown_unit == "1" else f" {signal.shown_unit}"
    rest = printed_number(from_si(reference, signal.unit, signal.shown_unit))
    words = f"Add to {moved.name} what {signal.name} moves from {rest}{unit}, times "
    words += gain_words(gain, signal, moved)
    if times:
        lead, lag = map(printed_number, times)
        words += f", with a lead of {lead} s and a lag of {lag} s"
    return f"{words}."
