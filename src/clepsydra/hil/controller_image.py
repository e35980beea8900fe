"""A controller program as a PLC has it loaded: a library, its ports, its state."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the process that scans imports no more than it needs
    from clepsydra.program.precision import Precision


@dataclass(frozen=True)
class ControllerImage:
    """An exported controller, compiled; it travels to the process that runs it.

    Parameters
    ----------
    title : str
        What it was made of, in words: "Structured Text in LREAL by matiec".
    label : str
        The same in a few letters: "ST".
    library : Path
        With block_size, block_power and block_scan, as `clepsydra.deploy.matiec_block` has them.
    inputs : mapping
        Input of the program, as "level_1.pv", to its value until it is wired, in its unit.
    outputs : tuple of str
    precision : {"double", "single"}
    """

    title: str
    label: str
    library: Path
    inputs: Mapping[str, float]
    outputs: tuple[str, ...]
    precision: Precision


class LoadedController:
    """One instance of a controller in the memory of a PLC.

    Parameters
    ----------
    image : ControllerImage
    """

    def __init__(self, image: ControllerImage) -> None:
        self.image = image
        self._library = ctypes.CDLL(str(image.library))
        self._library.block_size.restype = ctypes.c_ulong
        self._size = int(self._library.block_size())
        self._places = {name: place for place, name in enumerate(image.inputs)}
        self._given = (ctypes.c_double * max(len(image.inputs), 1))()
        self._found = (ctypes.c_double * max(len(image.outputs), 1))()
        self._memory = ctypes.create_string_buffer(self._size)
        self.power_cycle(retained=False)

    def power_cycle(self, *, retained: bool) -> None:
        """Begin anew, with what the program declares RETAIN as it was, or with nothing."""
        before = self._memory
        self._memory = ctypes.create_string_buffer(self._size)
        self._library.block_power(self._memory, before if retained else None)
        self._given[: len(self._places)] = list(self.image.inputs.values())

    @property
    def given(self) -> tuple[float, ...]:
        """The inputs of the last scan, those too that kept their value."""
        return tuple(self._given[: len(self._places)])

    def scan(self, given: Mapping[str, float]) -> dict[str, float]:
        """Run one scan and return the outputs.

        Parameters
        ----------
        given : mapping
            Input to its value, in its unit; one that is left out keeps the value that it has.
        """
        for name, value in given.items():
            self._given[self._places[name]] = value
        self._library.block_scan(self._memory, self._given, self._found)
        return dict(zip(self.image.outputs, self._found, strict=False))
