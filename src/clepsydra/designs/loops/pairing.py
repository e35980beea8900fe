"""Which input controls which output, checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.relative_gain_array import relative_gains, suggest_pairing

Pairing = Sequence[tuple[str, str]] | Mapping[str, str]


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
    if pairing is None:
        pairing = _suggested(model)
    pairing = list(pairing.items()) if isinstance(pairing, Mapping) else pairing
    whole = isinstance(pairing, (list, tuple)) and all(
        isinstance(pair, (list, tuple)) and len(pair) == 2 for pair in pairing
    )
    if not whole or not pairing:
        raise InputError(
            "pairing",
            pairing,
            "at least one pair (output, input), in a list or a dictionary",
            f'write as in [("{model.outputs[0]}", "{model.inputs[0]}")]',
        )
    outputs, inputs = zip(*pairing, strict=True)
    model.select(outputs, inputs)
    return outputs, inputs


def _suggested(model: LinearModel) -> Pairing:
    """Return the pairing that `linear.analysis.analyse` suggests."""
    square = len(model.inputs) == len(model.outputs)
    try:
        relative = relative_gains(model if square else in_known_ranges(model) or model)
    except InputError:  # singular, as the words of an analysis say
        raise InputError(
            "pairing",
            None,
            "a pairing, since the relative gains suggest none",
            f'write as in [("{model.outputs[0]}", "{model.inputs[0]}")]',
        ) from None
    return suggest_pairing(relative, model.outputs, model.inputs)
