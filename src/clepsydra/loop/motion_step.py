"""One integration step of a process, with what comes out of its delays."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.process.motion import Motion


class MotionStep:
    """The functions of one integration step of length h, over fractions of it.

    The integral is the vector of contents, some totals, and the sums of what entered the delays
    during the step. It is carried from a fraction s₀ to s₁ by the classical Runge-Kutta method.
    During a step a delayed quantity is the parabola through its values at start and end with
    its mean, and the mean of a flow is its own integral over the step at which it entered: so a
    delay loses no liquid, and what comes out is right to h⁴, which keeps the method's order.

    Parameters
    ----------
    motion : Motion
    totals : sequence of str
        Those totals that are integrated.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> step = MotionStep(load_process("quadruple-tank").motion)
    >>> step.size, step.advance.n_in()
    (4, 9)
    """

    def __init__(self, motion: Motion, totals: Sequence[str] = ()) -> None:
        self.motion = motion
        self.contents = len(motion.contents)
        self.totals = [i for i, s in enumerate(motion.totals) if s.name in totals]
        self.size = self.contents + len(self.totals) + len(motion.delays)
        self.held = [
            ca.SX.sym(name, motion.rates.numel_in(index)) for index, name in enumerate("mudp", 2)
        ]
        events = len(motion.events)
        #: Sizes of what an event changes: integral, counts, dates, memories.
        self.located = self.size, events, events, self.held[0].numel()
        self.ring = ca.SX.sym("ring", 3 * len(motion.delays))
        self.integral = ca.SX.sym("integral", self.size)
        self.advance = self._advance()
        self.guards = self._at_fraction("guards", self.motion.guards)
        self.sent = self._at_fraction("sent", self.motion.rates, result=1)
        self.updates = self._at_fraction("updates", self.motion.updates)

    def delayed(self, ring: ca.SX, fraction: ca.SX | float) -> ca.SX:
        """Return what comes out of the delays at a fraction of the step [delays].

        Parameters
        ----------
        ring : casadi.SX [3 delays]
            Start, mean and end of each delayed quantity during the step.
        fraction : casadi.SX or float
        """
        parts = []
        for index in range(len(self.motion.delays)):
            start, mean, end = ring[3 * index], ring[3 * index + 1], ring[3 * index + 2]
            # Simpson's rule is exact: mean = (start + 4 middle + end) / 6.
            middle = (6 * mean - start - end) * 0.25
            rest = 1 - fraction
            parts.append(
                start * (rest * (1 - 2 * fraction))
                + middle * (4 * fraction * rest)
                + end * (fraction * (2 * fraction - 1))
            )
        return ca.vertcat(*parts) if parts else ca.SX(0, 1)

    def stages(self, length: ca.SX, first: ca.SX, last: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """Return the stages k₁ to k₄ of a part of a step [integral per second].

        Parameters
        ----------
        length : casadi.SX
            Of the part [s].
        first, last : casadi.SX
            Fractions of the step between which it lies.
        """
        start, half, between = self.integral, length / 2, (first + last) / 2
        k1 = self._rates(start, first)
        k2 = self._rates(start + half * k1, between)
        k3 = self._rates(start + half * k2, between)
        return k1, k2, k3, self._rates(start + length * k3, last)

    def _rates(self, integral: ca.SX, fraction: ca.SX) -> ca.SX:
        z = self.delayed(self.ring, fraction)
        contents, entering, totals = self.motion.rates(integral[: self.contents], z, *self.held)
        chosen = [totals[index] for index in self.totals]
        return ca.densify(ca.vertcat(contents, *chosen, entering))

    def _advance(self) -> ca.Function:
        """(h, s₀, s₁, integral, ring, m, u, d, p) → integral after (s₁ - s₀) h."""
        h, first, last = ca.SX.sym("h"), ca.SX.sym("first"), ca.SX.sym("last")
        start, length = self.integral, (last - first) * h
        k1, k2, k3, k4 = self.stages(length, first, last)
        after = start + length / 6 * (k1 + 2 * (k2 + k3) + k4)
        return ca.Function("advance", [h, first, last, start, self.ring, *self.held], [after])

    def _at_fraction(self, name: str, function: ca.Function, result: int = 0) -> ca.Function:
        """(s, integral, ring, m, u, d, p) → a function of the motion at a fraction of the step."""
        fraction = ca.SX.sym("fraction")
        contents = self.integral[: self.contents]
        values = function(contents, self.delayed(self.ring, fraction), *self.held)
        value = values[result] if isinstance(values, tuple) else values
        arguments = [fraction, self.integral, self.ring, *self.held]
        return ca.Function(name, arguments, [ca.densify(value)])
