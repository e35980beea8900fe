"""A printed program as a shared library with one function, that runs one scan."""

import ctypes
import math

from clepsydra.deploy.proof.instance import Instance


class ScannedLibrary(Instance):
    """`scan` takes inputs and parameters, and gives outputs and states, each as doubles."""

    def __init__(self, program) -> None:
        super().__init__(program)
        self._signals = (*program.inputs, *program.parameters)

    def _take(self, library: ctypes.CDLL, shown: int) -> None:
        """Run this library, whose `scan` gives so many numbers."""
        self._library = library
        self._given = (ctypes.c_double * max(1, len(self._signals)))()
        self._found = (ctypes.c_double * max(1, shown))()
        self._count = shown

    def __call__(self, inputs):
        """Run one scan and return the outputs in order."""
        for place, signal in enumerate(self._signals):
            value = inputs.get(signal.name, math.nan)
            printed = math.isnan(value) and place >= len(self.program.inputs)
            self._given[place] = signal.initial if printed else value
        self._library.scan(self._given, self._found)
        return self._found[: len(self.program.outputs)]

    def state(self):
        """The state after the last scan."""
        return self._found[len(self.program.outputs) : self._count]
