"""A reservoir: where liquid comes from and goes to, without end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

from clepsydra.process.element import Element

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class Reservoir(Element):
    """A basin so large that its level does not change: dh/dt = 0.

    Parameters
    ----------
    name : str

    Examples
    --------
    >>> Reservoir("basin").receives
    True
    """

    kind: ClassVar[str] = "reservoir"
    table: ClassVar[str] = "reservoirs"
    keys: ClassVar[tuple[str, ...]] = ()
    receives: ClassVar[bool] = True

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the reservoir from its (empty) table of a process file."""
        return cls(name)
