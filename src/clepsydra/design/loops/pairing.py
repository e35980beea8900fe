"""Which input controls which output, checked."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel

Pairing = Sequence[tuple[str, str]]


def checked_pairing(
    pairing: Pairing, model: LinearModel
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the outputs and the inputs of a pairing.

    Raises
    ------
    InputError
        It is no sequence of pairs, is empty, names an unknown signal or one signal twice.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("wet-well"))
    >>> checked_pairing([("level", "duty")], analysis.model)
    (('level',), ('duty',))
    """
    whole = isinstance(pairing, (list, tuple)) and all(
        isinstance(pair, (list, tuple)) and len(pair) == 2 for pair in pairing
    )
    if not whole or not pairing:
        raise InputError(
            "pairing", pairing, "at least one pair (output, input)", "pair output and input"
        )
    outputs, inputs = zip(*pairing, strict=True)
    model.select(outputs, inputs)
    return outputs, inputs
