"""Which input controls which output, checked, and the pairs as loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.designs.loops.control_authority import check_ranges, largest_proportional_gain
from clepsydra.designs.models.held_element import held_element
from clepsydra.designs.models.transfer_element import TransferElement, moving_element
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.pairing import paired_gains

Pairing = Sequence[tuple[str, str]] | Mapping[str, str]


@dataclass(frozen=True, eq=False)
class PairedLoop:
    """One pair of a linear model: measurement and input, with the input at rest [its unit].

    `others` are the pairs that are closed when its loop is designed, where they change what it
    meets: a valve holds the outflow of a tank only while another loop holds the level.
    """

    output: Signal
    input: Signal
    model: LinearModel
    resting_input: float
    others: tuple[tuple[str, str], ...]

    @property
    def pair(self) -> str:
        """The pair as the reader sees it."""
        return f"{self.output.name} by {self.input.name}"

    @cached_property
    def element(self) -> TransferElement:
        """What is between them, with the others closed; refused where nothing moves the output."""
        if self.others:
            return held_element(self.model, (self.output.name, self.input.name), self.others)
        return self.alone

    @cached_property
    def alone(self) -> TransferElement:
        """What is between them with all others open; refused where nothing moves the output."""
        return moving_element(self.model, self.output.name, self.input.name)

    @property
    def largest_gain(self) -> float:
        """The largest proportional gain that the room of the input allows."""
        return largest_proportional_gain(self.output, self.input, self.resting_input)


def paired_loops(model: LinearModel, pairing: Pairing | None) -> list[PairedLoop]:
    """Return the loops of a pairing; all as in `checked_pairing`.

    Raises
    ------
    NotApplicable
        A signal has no finite range.
    """
    outputs, inputs = checked_pairing(pairing, model)
    point = operating_point_of(model)
    check_ranges(point.process, outputs, inputs)
    at, signal = point.as_dict(), point.process.signal
    pairs = tuple(zip(outputs, inputs, strict=True))
    changed = _changed_by_others(model, pairs)
    return [
        PairedLoop(
            signal(y), signal(u), model, at[u],
            tuple(pair for pair in pairs if (y, u) in changed and pair != (y, u)),
        )
        for y, u in pairs
    ]  # fmt: skip


@lru_cache(maxsize=16)
def _changed_by_others(
    model: LinearModel, pairs: tuple[tuple[str, str], ...]
) -> frozenset[tuple[str, str]]:
    """Return the pairs that are to be designed with the others closed."""
    if len(pairs) < 2:
        return frozenset()
    try:
        gains = paired_gains(model, pairs)
    except InputError:  # they cannot all be held at once
        return frozenset()
    return frozenset((each.output, each.input) for each in gains if each.changed_by_others)


def checked_pairing(
    pairing: Pairing | None, model: LinearModel
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the outputs and the inputs of a pairing; of the suggested one for None.

    Raises
    ------
    InputError
        It is no sequence of pairs and no mapping, is empty, names an unknown signal or one signal
        twice; or it is None, and the relative gains suggest none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> checked_pairing([("level", "duty")], cl.load("wet-well").linear)
    (('level',), ('duty',))
    """
    example = f'write as in [("{model.outputs[0]}", "{model.inputs[0]}")]'
    if pairing is None:  # the one that `linear.analysis.analyse` suggests
        try:
            pairing = [(pair.output, pair.input) for pair in paired_gains(model)]
        except InputError:  # singular, as the words of an analysis say
            expected = "a pairing, since the relative gains suggest none"
            raise InputError("pairing", None, expected, example) from None
    pairing = list(pairing.items()) if isinstance(pairing, Mapping) else pairing
    whole = isinstance(pairing, (list, tuple)) and all(
        isinstance(pair, (list, tuple)) and len(pair) == 2 for pair in pairing
    )
    if not whole or not pairing:
        expected = "at least one pair (output, input), in a list or a dictionary"
        raise InputError("pairing", pairing, expected, example)
    outputs, inputs = zip(*pairing, strict=True)
    model.select(outputs, inputs)
    return outputs, inputs
