"""The blocks of a control scheme beside its PID loops, as facts."""

from __future__ import annotations

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import SplitRangeBlock
from clepsydra.designs.gain_units import percent_gain
from clepsydra.process.process import Process
from clepsydra.report.facts import (
    DIGITS,
    facts_table,
    gain_text,
    known_signal,
    own_values,
    told_table,
)
from clepsydra.report.law_tables import output_facts
from clepsydra.report.quantities import number_text, quantity_text, time_cell


def scheme_blocks(controller: Controller, process: Process) -> list[Table]:
    """Return what stands between the loops of a controller and its outputs, block by block.

    Parameters
    ----------
    process : Process
        Lends display units.

    Returns
    -------
    list of Table
        Empty where each loop moves its output itself.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant, decoupling="static")
    >>> blocks = scheme_blocks(controller, plant.process)
    >>> blocks[0].title, blocks[0].rows[1][0]
    ('Decoupling of pump_1 (pump_1 decoupled)', 'from pump_2')
    """
    direct = {
        block.moved.name
        for block in controller.law.blocks
        if isinstance(block, PidBlock) and block.direct
    }
    found = []
    for block in controller.law.blocks:
        if isinstance(block, FeedforwardBlock):
            found.append(_feedforward(block, controller, process))
        elif isinstance(block, RatioBlock):
            found.append(_ratio(block, controller, process))
        elif isinstance(block, SelectorBlock):
            found.append(_selector(block))
        elif isinstance(block, SplitRangeBlock):
            found.append(_split_range(block, controller, process))
        elif isinstance(block, OutputBlock) and block.name not in direct:
            signal = known_signal(process, block.signal)
            facts = [("moved by", block.source), *output_facts(signal, controller)]
            found.append(facts_table(f"Output {signal.name}", facts))
    return found


def _feedforward(block: FeedforwardBlock, controller: Controller, process: Process) -> Table:
    moved = known_signal(process, block.moved)
    decouples = not any(term.measured for term in block.terms)
    terms = [_term(term, moved, controller, process) for term in block.terms]
    what = "Decoupling" if decouples else "Feedforward"
    return facts_table(
        f"{what} of {moved.name} ({block.name})", [("adds to", block.source), *terms]
    )


def _term(
    term: FeedforwardTerm, moved: Signal, controller: Controller, process: Process
) -> tuple[str, str]:
    values = own_values(term.parameters(), controller)
    signal = known_signal(process, term.signal)
    gain = gain_text(values["gain"], signal, moved)
    reference = quantity_text(signal, values["reference"], DIGITS)
    words = f"{gain} × ({signal.name} − {reference})"
    if term.dynamic:
        lead, lag = (number_text(values[what], DIGITS) for what in ("lead", "lag"))
        above, below = (f"(1 + {time} s · s)" if time != "0" else "" for time in (lead, lag))
        if above or below:
            words += f", through {above or '1'}" + (f"/{below}" if below else "")
    if not term.measured:
        words += ", the output applied in the last sample"
    return f"from {signal.name}", words


def _ratio(block: RatioBlock, controller: Controller, process: Process) -> Table:
    moved, wild = known_signal(process, block.moved), known_signal(process, block.wild)
    values = own_values(block.parameters(), controller)
    facts = [("asks for", f"ratio × {wild.name}")]
    if block.source is None:
        facts.append(("ratio", gain_text(values["ratio"], wild, moved)))
    else:
        low, high = (
            gain_text(values[f"{end}_ratio"], wild, moved) for end in ("lowest", "highest")
        )
        facts += [("ratio trimmed by", block.source), ("ratio between", f"{low} and {high}")]
    return facts_table(f"Ratio of {moved.name} to {wild.name} ({block.name})", facts)


def _selector(block: SelectorBlock) -> Table:
    word = "lowest" if block.selection == "low" else "highest"
    facts = (
        ("takes", f"the {word} of {', '.join(block.sources)}"),
        ("loops not selected", "follow what was applied (external reset)"),
    )
    return facts_table(f"Override, {word} selector ({block.name})", facts)


def _split_range(block: SplitRangeBlock, controller: Controller, process: Process) -> Table:
    facts = [("splits", f"{block.source}, 0 to 100 %")]
    for leg in block.legs:
        signal = known_signal(process, leg.moved)
        values = own_values(leg.parameters(), controller)
        start, end = (number_text(values[what], DIGITS) for what in ("start", "end"))
        first, last = (
            quantity_text(signal, values[what], DIGITS) for what in ("at_start", "at_end")
        )
        words = f"from {first} at {start} % to {last} at {end} %, level beyond"
        facts.append((signal.name, words))
    return facts_table(f"Split range ({block.name})", facts)


def added_table(controller: Controller, process: Process) -> Table | None:
    """Return what decoupling and feedforward add to the outputs of loops, a row each, or None.

    Gain (1 + lead s)/(1 + lag s) times the way of a signal from where it adds nothing.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> decoupled = cl.design.simc(plant, decoupling="static")
    >>> added_table(decoupled, plant.process).rows[0]
    ('pump_1 from pump_2', '−0.575 V/V', '−0.575')
    """
    sums = (block for block in controller.law.blocks if isinstance(block, FeedforwardBlock))
    rows = []
    for term in (term for block in sums for term in block.terms):
        signal, moved = (known_signal(process, each) for each in (term.signal, term.moved))
        values = own_values(term.parameters(), controller)
        ranged = signal.has_range and moved.has_range
        rows.append(
            (
                f"{moved.name} from {signal.name}",
                gain_text(values["gain"], signal, moved, 3),
                number_text(percent_gain(values["gain"], signal, moved)) if ranged else "",
                *(time_cell(values[what]) if values.get(what) else "" for what in ("lead", "lag")),
            )
        )
    head = ("added to", "gain", "gain [%/%]", "lead", "lag")
    return told_table(head, rows) if rows else None
