"""What tells a law the state of its process: sensors that show it, or an observer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.control_law import control_law
from clepsydra.program.step_law import StepLaw


class StateSource(ABC):
    """The process signals of a law that feeds a state back, and where the state comes from.

    Parameters
    ----------
    measured, controlled, manipulated : sequence of Signal
        Those that are controlled have setpoints.
    fed_back : sequence of Signal
        The quantities of the state.

    Attributes
    ----------
    feedback, integral_gain : Matrix
        F and G, from the state and from the errors to the outputs.
    """

    #: Whether what is known of the state are its deviations from the operating point.
    from_rest = False

    def __init__(
        self,
        measured: Sequence[Signal],
        controlled: Sequence[Signal],
        manipulated: Sequence[Signal],
        fed_back: Sequence[Signal],
    ) -> None:
        self.measured, self.controlled = measured, controlled
        self.manipulated, self.fed_back = manipulated, fed_back
        words = "feedback gain from {by} to {to}"
        self.feedback = Matrix("feedback", manipulated, fed_back, words)
        words = "integral gain from the error of {by} to {to}"
        self.integral_gain = Matrix("integral_gain", manipulated, controlled, words, per=("s",))

    @abstractmethod
    def parameters(self) -> list[Signal]:
        """Return what it computes with, the references of the operating point among them."""

    def state(self) -> list[Signal]:
        """Return what it keeps from sample to sample."""
        return []

    @abstractmethod
    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the state in this sample, always numbers, and what `move_on` needs beyond it."""

    def deviations(self, sample: Sample, known: Sequence[ca.SX]) -> list[ca.SX]:
        """Return the deviations of a known state from the operating point."""
        found = list(known[: len(self.fed_back)])
        if not self.from_rest:
            pairs = zip(self.fed_back, found, strict=True)
            found = [value - sample[path(x, "reference")] for x, value in pairs]
        for x, value in zip(self.fed_back, found, strict=True):
            sample.name(x, {"deviation": value})
        return found

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the state of the next sample, under the inputs that were applied; none here."""
        return

    def law(
        self,
        name: str,
        applied: Callable[[Sample, Reading, Sequence[ca.SX]], Sequence[ca.SX]],
        parameters: Sequence[Signal],
        state: Sequence[Signal] = (),
        description: tuple[str, ...] = (),
    ) -> StepLaw:
        """Write the step law of these signals, with integral and last_output of each output.

        `applied` writes the outputs from what is read and what is known of the state.
        """
        names = [y.name for y in self.measured], [y.name for y in self.controlled]

        def equations(sample: Sample) -> None:
            reading = Reading.of(sample, *names)
            known = self.known(sample, reading)
            self.move_on(sample, known, applied(sample, reading, known))

        return control_law(
            name,
            equations,
            measured=self.measured,
            controlled=self.controlled,
            manipulated=self.manipulated,
            parameters=parameters,
            state=[
                *(each for u in self.manipulated for each in signals.output_state(u)),
                *self.state(),
                *state,
            ],
            description=description,
        )
