"""A controller that a study file writes out, in one of several ways."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.declared import read_fields, table_schema
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

#: Takes the linear model alone: all that a controller needs which is written out.
WrittenMaker = Callable[[LinearModel], Controller]


@dataclass(frozen=True)
class Written(ABC):
    """A way to write a controller out; the fields of each declare its keys.

    Parameters
    ----------
    table : TableReader
        Of the controller.
    name : str
        Of the controller.

    Raises
    ------
    InputError
        A key is wrong, or the keys do not fit together.
    """

    table: TableReader
    name: str
    process: Process

    @classmethod
    def read(cls, table: TableReader, name: str, process: Process, folder: Path) -> Self:
        """Read the keys; paths start in the folder of the study file."""
        return cls(table, name, process, **read_fields(cls, table, process=process, folder=folder))

    @classmethod
    def properties(cls) -> Mapping[str, Any]:
        """Return its keys, each with what an editor is told of it."""
        found: Mapping[str, Any] = table_schema(cls)["properties"]
        return found

    @abstractmethod
    def maker(self) -> WrittenMaker:
        """Return what makes the controller, with all checked that needs no model."""
