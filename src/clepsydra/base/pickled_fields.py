"""Dataclasses that are pickled by their fields."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


class PickledFields:
    """A dataclass of which the fields are pickled; what follows from them is found anew.

    Examples
    --------
    >>> import pickle
    >>> from clepsydra.optimal_control.grid import Grid
    >>> grid = Grid((1, 2), period=1.0)
    >>> grid.starts.tolist(), sorted(vars(pickle.loads(pickle.dumps(grid))))
    ([0.0, 1.0], ['lengths', 'period'])
    """

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled."""
        return {each.name: getattr(self, each.name) for each in fields(self)}  # type: ignore[arg-type]
