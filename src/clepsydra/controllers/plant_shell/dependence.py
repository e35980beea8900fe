"""Which signals an output of a step law depends on, from the structure of its equations."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clepsydra.program.step_law import StepLaw


def needed_by_outputs(law: StepLaw, outputs: int, stems: Iterable[str]) -> list[tuple[int, ...]]:
    """Return for output i the numbers j of the signals stem_j that it needs.

    An output needs a signal if manipulated_i or status_i depends on it in the same sample. A
    signal that no output depends on so, but by what is remembered of it, is needed by all
    outputs that this reaches in the end.

    Parameters
    ----------
    law : StepLaw
    outputs : int
        Number of outputs.
    stems : iterable of str
        "measurement" and "sensor", say.

    Examples
    --------
    >>> from clepsydra.controllers.linear_quadratic_integral import lqi_law
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> needed_by_outputs(multiloop_pid_law(2), 2, ["measurement", "sensor"])
    [(1,), (2,)]
    >>> needed_by_outputs(lqi_law(3, 2, [1, 2]), 2, ["measurement", "sensor"])
    [(1, 2, 3), (1, 2, 3)]
    """
    columns: dict[int, list[int]] = {}
    for place, signal in enumerate(law.inputs):
        stem, _, number = signal.name.rpartition("_")
        if stem in stems and number.isdigit():
            columns.setdefault(int(number), []).append(place)
    names = [signal.name for signal in law.outputs]
    rows = [
        [names.index(name) for name in (f"manipulated_{i}", f"status_{i}") if name in names]
        for i in range(1, outputs + 1)
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
    return [tuple(sorted(needed)) for needed in found]


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
