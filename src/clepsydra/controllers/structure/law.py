"""A control scheme of blocks as one step law."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import Applied, Asked, Limits
from clepsydra.controllers.blocks.sample import Sample, written_law
from clepsydra.controllers.structure.block import Block, Opened
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.program.step_law import StepLaw


def in_order(place: str, sources: Mapping[str, Collection[str]]) -> list[str]:
    """Return names so that each stands after all that it takes a value from.

    `place`: for the message; `sources`: name to those that it takes a value from.

    Raises InputError: some take their values from each other in a circle; the first of them ends
    the place.

    Examples
    --------
    >>> in_order("scheme", {"pump": ["level"], "level": []})
    ['level', 'pump']
    """
    ordered: list[str] = []
    while len(ordered) < len(sources):
        waiting = [name for name in sources if name not in ordered]
        ready = [name for name in waiting if set(sources[name]) <= set(ordered)]
        if not ready:
            circle = _circle(waiting, sources)
            raise InputError(
                f"{place}, {circle[0]}",
                " → ".join([*circle, circle[0]]),
                "a way from setpoints to manipulated variables without a circle",
                "let one of them move something else, or take its value from elsewhere",
            )
        ordered += ready
    return ordered


def _circle(waiting: list[str], sources: Mapping[str, Collection[str]]) -> list[str]:
    """Return names of which each gives its value to the next, and the last to the first."""
    passed = [waiting[0]]
    while True:
        source = next(name for name in sources[passed[-1]] if name in waiting)
        if source in passed:
            circle = passed[passed.index(source) :][::-1]
            first = circle.index(min(circle, key=waiting.index))
            return circle[first:] + circle[:first]
        passed.append(source)


def structure_law(
    name: str,
    blocks: Sequence[Block],
    *,
    setpoints: Mapping[str, Signal],
    measured: Sequence[Signal],
) -> StepLaw:
    """Join blocks to the step law of a control scheme.

    `name`: an identifier; `blocks`: in any order. Every port is taken by one other block, and the
    ways of the signals form no circle: they end in the outputs; `setpoints`: what an input sp
    belongs to, to the measurement that it is a setpoint of; `measured`: the measurements of the
    scheme.

    Raises InputError: the signals run in a circle, or a loop that waits for a selector would wind
    up.
    """
    ordered = _in_order(name, blocks)
    outputs = [block.signal for block in blocks if isinstance(block, OutputBlock)]
    loops = _plain_loops(blocks)
    joined = [block for block in ordered if not any(block in pair for pair in loops)]

    def equations(sample: Sample) -> None:
        for block in blocks:
            sample.parameters(*block.parameters())
        for loop, output in loops:
            loop.closed(sample, output.signal, rate_limited=output.rate_limited)
        _join(sample, joined)

    inputs = (
        *(signals.SP.of(owner, measurement=signal) for owner, signal in setpoints.items()),
        *signals.measurement_inputs(measured),
        *(signal for block in blocks for signal in block.inputs()),
        *signals.output_inputs(outputs),
    )
    return written_law(name, equations, inputs, signals.output_results(outputs), blocks=blocks)


def _in_order(name: str, blocks: Sequence[Block]) -> list[Block]:
    """Return the blocks from setpoints to outputs."""
    _check_selectors(name, blocks)
    by_name = {block.name: block for block in blocks}
    givers = {port: block.name for block in blocks for port in block.ports}
    sources = {block.name: [givers[port] for port in block.sources] for block in blocks}
    return [by_name[each] for each in in_order(f"control scheme {name}", sources)]


def _check_selectors(name: str, blocks: Sequence[Block]) -> None:
    """A loop that was not selected has to follow what was, or it winds up."""
    givers = {port: block for block in blocks for port in block.ports}
    for selector in (block for block in blocks if isinstance(block, SelectorBlock)):
        waiting = list(selector.sources)
        while waiting:
            block = givers[waiting.pop()]
            if isinstance(block, PidBlock):
                form = block.form
                if form.has_integral and not (form.tracks_back or form.algorithm == "velocity"):
                    raise InputError(
                        f"control scheme {name}, {block.name}, anti_windup", form.winding,
                        f"back_calculation: {selector.name} selects among several loops, and "
                        "the integral of those that wait has to follow what is applied",
                        'write anti_windup = "back_calculation"',
                    )  # fmt: skip
            else:
                waiting += block.sources


def _plain_loops(blocks: Sequence[Block]) -> list[tuple[PidBlock, OutputBlock]]:
    """Return the loops that move an output with nothing between, with their outputs."""
    return [
        (loop, output)
        for loop in blocks
        for output in blocks
        if isinstance(loop, PidBlock) and isinstance(output, OutputBlock)
        if output.source == loop.name and loop.direct and not loop.inner
    ]


def _join(sample: Sample, ordered: Sequence[Block]) -> None:
    """Run forward from setpoints to outputs, and back with what was applied."""
    after: dict[str, Limits] = {}
    for block in reversed(ordered):
        found = block.limits(sample, [after[port] for port in block.ports])
        after |= dict(zip(block.sources, found, strict=True))
    asked: dict[str, Asked] = {}
    opened: dict[str, Opened] = {}
    for block in ordered:
        step = opened[block.name] = block.open(
            sample,
            [asked[source] for source in block.sources],
            [after[port] for port in block.ports],
        )
        asked |= dict(zip(block.ports, step.asked, strict=True))
    applied: dict[str, Applied] = {}
    for block in reversed(ordered):
        told = opened[block.name].close([applied[port] for port in block.ports])
        applied |= dict(zip(block.sources, told, strict=True))
