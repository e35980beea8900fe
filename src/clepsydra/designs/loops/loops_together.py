"""The sampled loops of one law, judged together for whatever settings it is given."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.designs.designed_values import applicable_values, rounded_values
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.designs.slowing_down import OF_LOOPS, Search, SlowedDown, as_given, slow_down
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

T = TypeVar("T")


class LoopsTogether(Generic[T]):
    """All loops of a controller on one model, for any settings.

    Parameters
    ----------
    blank : Controller
        With the values that no setting changes.
    values_of : callable
        Settings to the parameters that they make.

    Raises
    ------
    NotApplicable
        A dead time leaves no sampled loop.
    """

    def __init__(
        self,
        blank: Controller,
        model: LinearModel,
        values_of: Callable[[T], Mapping[str, float]],
        search: Search = OF_LOOPS,
    ) -> None:
        self.blank, self.point = blank, operating_point_of(model)
        self._values_of, self._search = values_of, search
        self._sampled = SampledLoops(blank, model)

    def peak(self, settings: T) -> float:
        """Return the sensitivity peak of all loops closed; infinite if they are unstable."""
        return self._sampled.at(self._values(settings)).maximum_sensitivity

    def slowed_down(self, settings_at: Callable[[float], T]) -> SlowedDown[T]:
        """Return the fastest settings that the loops bear together; all as in `slow_down`."""
        return slow_down(settings_at, self.peak, self._search)

    def as_given(self, settings: T, choice: str) -> SlowedDown[T]:
        """Return settings that the user chose as they are; all as in `slowing_down.as_given`."""
        return as_given(settings, self.peak, choice)

    def timed(
        self, settings_at: Callable[[list[float]], T], shortest: Sequence[float], time: float | None
    ) -> tuple[SlowedDown[T], list[float]]:
        """Return settings by the closed-loop time constant of each loop, and these [s].

        Parameters
        ----------
        settings_at : callable
            Time constants [s] to settings.
        shortest : sequence of float
            That the input's room and the delay of each loop allow, lengthened by one factor.
        time : float or None
            One of all loops that is used as it is.

        Raises
        ------
        NotApplicable
            The loops together are unstable, or cannot be made robust.
        """
        if time is None:
            found = self.slowed_down(lambda factor: settings_at([factor * t for t in shortest]))
            return found, [found.factor * t for t in shortest]
        times = [float(time)] * len(shortest)
        choice = f"a closed-loop time constant of {time:g} s"
        return self.as_given(settings_at(times), choice), times

    def made(self, found: SlowedDown[T], design: str, notes: Sequence[str]) -> Controller:
        """Return the controller with these settings, at rest at the operating point.

        Parameters
        ----------
        design : str
            How the settings were found; the peak is added.

        Raises
        ------
        NotApplicable
            A setting is outside of what a controller takes.
        """
        law = self.blank.law
        values = applicable_values(law, self._values(found.design))
        words = f"{design}; sensitivity peak of all loops together {found.peak:.2f}."
        state = state_at_rest(law, values, self.point.as_dict())
        made = replace(self.blank, values=values, initial_state=state)
        return made.described(words, notes, found.factor)

    def _values(self, settings: T) -> dict[str, float]:
        values = {**self.blank.values, **self._values_of(settings)}
        return rounded_values(self.blank.law, values, self.point)
