"""Which signals an output of a step law depends on, from the structure of its equations."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clepsydra.controllers.signals import owners
from clepsydra.program.step_law import StepLaw


def needed_by_outputs(law: StepLaw, parts: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return for each output whose inputs it needs, of these parts.

    An output needs a signal if out or status depends on it in the same sample. A signal that no
    output depends on so, but by what is remembered of it, is needed by all outputs that this
    reaches in the end.

    Parameters
    ----------
    law : StepLaw
    parts : iterable of str
        "pv" and "good", say.

    Examples
    --------
    >>> from clepsydra.controllers.linear_quadratic_integral import lqi_law
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> levels, pumps = ["level_1", "level_2"], ["pump_1", "pump_2"]
    >>> needed_by_outputs(multiloop_pid_law(levels, pumps), ["pv", "good"])
    {'pump_1': ('level_1',), 'pump_2': ('level_2',)}
    >>> needed_by_outputs(lqi_law(levels, pumps, levels), ["pv", "good"])["pump_1"]
    ('level_1', 'level_2')
    """
    columns: dict[str, list[int]] = {}
    for place, signal in enumerate(law.inputs):
        if signal.part in parts:
            columns.setdefault(signal.owner, []).append(place)
    outputs = owners(law.outputs, "out")
    rows = [
        [k for k, signal in enumerate(law.outputs) if signal.owner == output] for output in outputs
    ]
    direct = _structure(law, 1, 1)
    found = [
        {j for j, places in columns.items() if direct[np.ix_(own, places)].any()} for own in rows
    ]
    reached = _through_state(law, direct)
    for j, places in columns.items():
        if not any(j in needed for needed in found):
            for needed, own in zip(found, rows, strict=True):
                if reached[np.ix_(own, places)].any():
                    needed.add(j)
    return {
        output: tuple(owner for owner in columns if owner in needed)
        for output, needed in zip(outputs, found, strict=True)
    }


def _through_state(law: StepLaw, direct: np.ndarray) -> np.ndarray:
    """Return which outputs an input reaches in any sample."""
    moved, kept = _structure(law, 0, 1), _structure(law, 0, 0)
    shown = _structure(law, 1, 0)
    for _ in range(len(law.state)):
        wider = moved | _product(kept, moved)
        if np.array_equal(wider, moved):
            break
        moved = wider
    return direct | _product(shown, moved)


def _product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return (first.astype(int) @ second.astype(int)) > 0


def _structure(law: StepLaw, result: int, argument: int) -> np.ndarray:
    """Return where a result of the law's function depends on an argument."""
    sparsity = law.function.jac_sparsity(result, argument)
    found = np.zeros((sparsity.size1(), sparsity.size2()), dtype=bool)
    found[sparsity.row(), sparsity.get_col()] = True
    return found
