"""Signals that arrive while a solver runs, which would swallow what their handlers raise."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import casadi as ca

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption(ca.Callback):
    """What a solver asks after each iteration, and is ended by once a signal has arrived.

    Parameters
    ----------
    unknowns, constraints, parameters : int
        Of the nonlinear programme.
    """

    def __init__(self, unknowns: int, constraints: int, parameters: int = 0) -> None:
        ca.Callback.__init__(self)
        self._sizes = {"x": unknowns, "f": 1, "g": constraints, "lam_x": unknowns}
        self._sizes |= {"lam_g": constraints, "lam_p": parameters}
        self._arrived: tuple[int, FrameType | None] | None = None
        self.construct("interruption", {})

    def get_n_in(self) -> int:
        """Return how many results of the solver it takes."""
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        """Return one: whether to stop."""
        return 1

    def get_sparsity_in(self, place: int) -> ca.Sparsity:
        """Return the shape of a result of the solver."""
        return ca.Sparsity.dense(self._sizes[ca.nlpsol_out(place)], 1)

    def get_sparsity_out(self, place: int) -> ca.Sparsity:
        """Return that of a number."""
        return ca.Sparsity.dense(1, 1)

    def eval(self, results: Any) -> list[int]:
        """Return whether a signal has arrived."""
        return [int(self._arrived is not None)]

    @contextmanager
    def heeded(self) -> Iterator[None]:
        """Let signals end the solver within, and do what they do after it.

        Raises
        ------
        KeyboardInterrupt
            By control-C, or what else a handler raises.
        """
        if threading.current_thread() is not threading.main_thread():
            yield  # signals are the main thread's
            return
        handlers = {each: signal.getsignal(each) for each in _SIGNALS}
        mine = {int(each): old for each, old in handlers.items() if callable(old)}

        def keep(number: int, frame: FrameType | None) -> None:
            self._arrived = number, frame

        for number in mine:
            signal.signal(number, keep)
        try:
            yield
        finally:
            for number, old in mine.items():
                signal.signal(number, old)
        if self._arrived is not None:
            (number, frame), self._arrived = self._arrived, None
            mine[number](number, frame)
