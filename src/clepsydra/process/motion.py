"""How a process moves: what is integrated, what is remembered, delayed and switched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Delay


class FlowPath(NamedTuple):
    """Where a flow runs: the element that causes it, and its ends; empty outside the plant."""

    element: str
    source: str
    destination: str


class MotionEvent(NamedTuple):
    """An event as a run records it, see `clepsydra.process.hybrid.Event`."""

    name: str
    words: str
    harm: str = ""
    ends: bool = False

    @property
    def counted(self) -> str:
        """The name of the number of times that it has happened."""
        return f"{self.name}.count"

    @property
    def dated(self) -> str:
        """The name of the time at which it happened last."""
        return f"{self.name}.time"


@dataclass(frozen=True)
class Motion:
    """The equations of a process in the form that an integrator needs.

    With contents c, delayed quantities z, memories m, inputs u, disturbances d, parameters p:

    - dc/dt = f(c, z, m, u, d, p), w = what enters the delays, z(t) = w(t - τ);
    - when a guard g(c, z, m, u, d, p) becomes zero or positive, m takes the values that the
      events that fired reset it to; at the end of every step m takes its update;
    - states x = x(c, p) and back c = c(x, p): a level may be integrated as a volume and a
      concentration as an amount, so that what is conserved is conserved to rounding.

    Parameters
    ----------
    contents, totals, memories : tuple of Signal
        Integrated; integrated without an effect; held.
    to_contents : casadi.Function
        (x, p) → c
    to_state : casadi.Function
        (c, p) → x
    rates : casadi.Function
        (c, z, m, u, d, p) → (dc/dt, w, dt/dt), the last the rates of the totals.
    guards : casadi.Function
        (c, z, m, u, d, p) → g [events]
    resets : casadi.Function
        (fired [events], c, z, m, u, d, p) → m
    updates : casadi.Function
        (c, z, m, u, d, p) → m
    stored : casadi.Function
        (c, p) → liquid in the tanks [m³], then the amount of each component.
    stored_names : tuple of str
        "liquid", then the components.
    flows : casadi.Function
        (c, z, m, u, d, p) → every flow [m³/s], for those who look at a motion from outside.
    flow_paths : tuple of FlowPath
        Where each of the flows runs.
    """

    contents: tuple[Signal, ...]
    totals: tuple[Signal, ...]
    memories: tuple[Signal, ...]
    delays: tuple[Delay, ...]
    events: tuple[MotionEvent, ...]
    to_contents: ca.Function
    to_state: ca.Function
    rates: ca.Function
    guards: ca.Function
    resets: ca.Function
    updates: ca.Function
    stored: ca.Function
    stored_names: tuple[str, ...]
    flows: ca.Function
    flow_paths: tuple[FlowPath, ...]

    def at_rest(
        self, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray, p: np.ndarray
    ) -> list[np.ndarray]:
        """Return (c, z, m, u, d, p) where what leaves the delays has entered them for ever.

        Every memory is as it is at first.
        """
        contents = np.array(self.to_contents(state, p)).ravel()
        memories = np.array([signal.initial for signal in self.memories])
        held = [contents, np.zeros(len(self.delays)), memories, inputs, disturbances, p]
        for _ in self.delays:  # one delay may feed the next
            held[1] = np.array(self.rates(*held)[1]).ravel()
        return held

    @property
    def plain(self) -> bool:
        """Nothing is remembered, delayed or switched: dc/dt = f(c, u, d, p)."""
        return not (self.memories or self.delays or self.events)
