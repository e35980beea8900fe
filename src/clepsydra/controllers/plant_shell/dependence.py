"""Which signals an output of a step law depends on, from the structure of its equations."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.signals import owners
from clepsydra.program.step_law import StepLaw


def needed_by_outputs(law: StepLaw, parts: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return for each output whose inputs it needs, of these parts.

    An output needs a signal if out or status depends on it in the same sample. A signal that no
    output depends on so, but by what is remembered of it, is needed by all outputs that this
    reaches in the end.

    Parameters
    ----------
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
    columns = _places(s if s.part in parts else None for s in law.inputs)
    rows = {u: _places(law.outputs)[u] for u in owners(law.outputs, "out")}
    direct, moved, kept = (_structure(law, *each) for each in ((1, 1), (0, 1), (0, 0)))
    while not np.array_equal(wider := moved | kept @ moved, moved):
        moved = wider
    ever = direct | _structure(law, 1, 0) @ moved

    def needs(output: str, owner: str, where: np.ndarray) -> bool:
        return bool(where[np.ix_(rows[output], columns[owner])].any())

    at_once = {y for y in columns if any(needs(u, y, direct) for u in rows)}
    return {
        u: tuple(y for y in columns if needs(u, y, direct if y in at_once else ever)) for u in rows
    }


def _places(signals: Iterable[Signal | None]) -> dict[str, list[int]]:
    """Return where the signals of each owner stand."""
    found: dict[str, list[int]] = {}
    for place, signal in enumerate(signals):
        if signal is not None:
            found.setdefault(signal.owner, []).append(place)
    return found


def _structure(law: StepLaw, result: int, argument: int) -> np.ndarray:
    """Return where a result of the law's function depends on an argument."""
    sparsity = law.function.jac_sparsity(result, argument)
    found = np.zeros((sparsity.size1(), sparsity.size2()), dtype=bool)
    found[sparsity.row(), sparsity.get_col()] = True
    return found
