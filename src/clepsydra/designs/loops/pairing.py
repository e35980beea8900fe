"""Which input controls which output, checked, and the pairs as loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.designs.loops.control_authority import check_ranges, largest_proportional_gain
from clepsydra.designs.models.transfer_element import TransferElement, moving_element
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.relative_gain_array import relative_gains, suggest_pairing

Pairing = Sequence[tuple[str, str]] | Mapping[str, str]


@dataclass(frozen=True, eq=False)
class PairedLoop:
    """One pair of a linear model: measurement and input, with the input at rest [its unit]."""

    output: Signal
    input: Signal
    model: LinearModel
    resting_input: float

    @property
    def pair(self) -> str:
        """The pair as the reader sees it."""
        return f"{self.output.name} by {self.input.name}"

    @cached_property
    def element(self) -> TransferElement:
        """What is between them; refused where the input does not move the output."""
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
    return [
        PairedLoop(signal(y), signal(u), model, at[u]) for y, u in zip(outputs, inputs, strict=True)
    ]


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
        square = len(model.inputs) == len(model.outputs)
        try:
            relative = relative_gains(model if square else in_known_ranges(model) or model)
        except InputError:  # singular, as the words of an analysis say
            expected = "a pairing, since the relative gains suggest none"
            raise InputError("pairing", None, expected, example) from None
        pairing = suggest_pairing(relative, model.outputs, model.inputs)
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
