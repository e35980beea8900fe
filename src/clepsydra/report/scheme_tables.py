"""The blocks of a control scheme beside its PID loops, as facts."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import SplitRangeBlock
from clepsydra.process.process import Process
from clepsydra.report.facts import DIGITS, Facts, gain_text, known_signal
from clepsydra.report.output_facts import output_facts
from clepsydra.report.quantities import number_text, quantity_text


def scheme_blocks(controller: Controller, process: Process) -> list[Facts]:
    """Return what stands between the loops of a controller and its outputs, block by block.

    Parameters
    ----------
    controller : Controller
    process : Process
        Lends display units.

    Returns
    -------
    list of Facts
        Empty where each loop moves its output itself.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant, decoupling="static")
    >>> blocks = scheme_blocks(controller, plant.process)
    >>> blocks[0].title, blocks[0].facts[1][0]
    ('Decoupling of pump_1 (sum 1)', 'from pump_2')
    """
    direct = {
        block.direct for block in controller.law.blocks if isinstance(block, PidBlock)
    }  # fmt: skip
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
        elif isinstance(block, OutputBlock) and block.number not in direct:
            signal = known_signal(process, block.signal)
            facts = [("moved by", block.source), *output_facts(block.number, signal, controller)]
            found.append(Facts(f"Output {signal.name}", tuple(facts)))
    return found


def _feedforward(block: FeedforwardBlock, controller: Controller, process: Process) -> Facts:
    moved = known_signal(process, block.moved)
    decouples = all(term.taken_from.startswith("last_output_") for term in block.terms)
    facts = [("adds to", block.source)]
    facts += [_term(term, moved, controller, process) for term in block.terms]
    what = "Decoupling" if decouples else "Feedforward"
    return Facts(f"{what} of {moved.name} ({block.name})", tuple(facts))


def _term(
    term: FeedforwardTerm, moved: Signal, controller: Controller, process: Process
) -> tuple[str, str]:
    values, label = controller.values, term.label
    signal = known_signal(process, term.signal)
    gain = gain_text(values[f"feedforward_gain_{label}"], signal, moved)
    reference = quantity_text(signal, values[f"feedforward_reference_{label}"], DIGITS)
    words = f"{gain} × ({signal.name} − {reference})"
    if term.dynamic:
        lead, lag = (
            number_text(values[f"feedforward_{what}_{label}"], DIGITS) for what in ("lead", "lag")
        )
        above, below = (f"(1 + {time} s · s)" if time != "0" else "" for time in (lead, lag))
        if above or below:
            words += f", through {above or '1'}" + (f"/{below}" if below else "")
    if term.taken_from.startswith("last_output_"):
        words += ", the output applied in the last sample"
    return f"from {signal.name}", words


def _ratio(block: RatioBlock, controller: Controller, process: Process) -> Facts:
    moved, wild = known_signal(process, block.moved), known_signal(process, block.wild)
    values, number = controller.values, block.number
    facts = [("asks for", f"ratio × {wild.name}")]
    if block.source is None:
        facts.append(("ratio", gain_text(values[f"ratio_{number}"], wild, moved)))
    else:
        low, high = (
            gain_text(values[f"{end}_ratio_{number}"], wild, moved) for end in ("lowest", "highest")
        )
        facts += [("ratio trimmed by", block.source), ("ratio between", f"{low} and {high}")]
    return Facts(f"Ratio of {moved.name} to {wild.name} ({block.name})", tuple(facts))


def _selector(block: SelectorBlock) -> Facts:
    word = "lowest" if block.selection == "low" else "highest"
    facts = (
        ("takes", f"the {word} of {', '.join(block.sources)}"),
        ("loops not selected", "follow what was applied (external reset)"),
    )
    return Facts(f"Override, {word} selector ({block.name})", facts)


def _split_range(block: SplitRangeBlock, controller: Controller, process: Process) -> Facts:
    facts = [("splits", f"{block.source}, 0 to 100 %")]
    for leg in block.legs:
        signal, values = known_signal(process, leg.moved), controller.values
        start, end = (
            number_text(values[f"split_{what}_{leg.number}"], DIGITS) for what in ("start", "end")
        )
        first, last = (
            quantity_text(signal, values[f"split_at_{what}_{leg.number}"], DIGITS)
            for what in ("start", "end")
        )
        words = f"from {first} at {start} % to {last} at {end} %, level beyond"
        facts.append((signal.name, words))
    return Facts(f"Split range ({block.name})", tuple(facts))
