"""The state of a linear model: measured as a whole, or estimated by an observer."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.observers.current_observer import CurrentObserver
from clepsydra.controllers.observers.state_source import StateSource
from clepsydra.controllers.observers.structure import ObserverStructure


class LinearState(StateSource):
    """The measurements themselves, or what an observer estimates from them.

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        A signal that has but a name is of unit 1.
    controlled : sequence of str
        The measurements that have setpoints.
    structure : ObserverStructure or None
        None where the measurements show the whole state.
    place : str
        Of the law, for a message.

    Raises InputError: A setpoint belongs to no measurement, a signal is named twice, or the
    observer is for other signals.
    """

    from_rest = True

    def __init__(
        self,
        measured: Sequence[Signal | str],
        manipulated: Sequence[Signal | str],
        controlled: Sequence[str],
        structure: ObserverStructure | None,
        place: str,
    ) -> None:
        shown = signals.process_signals(measured, f"{place}, measured")
        moved = signals.process_signals(manipulated, f"{place}, manipulated")
        known = {signal.name: signal for signal in shown}
        if not controlled or any(name not in known for name in controlled):
            raise InputError(
                "state feedback, controlled",
                tuple(controlled),
                f"some of the measurements {', '.join(known)}",
                "give for each setpoint the measurement that follows it",
            )
        self.observer = structure and CurrentObserver(structure, shown, moved)
        if structure and (structure.measurements, structure.inputs) != (len(shown), len(moved)):
            raise InputError(
                "state feedback, observer",
                (structure.measurements, structure.inputs),
                f"an observer for {len(shown)} measurements and {len(moved)} inputs",
                "give it the measurements and inputs of the law",
            )
        fed_back = structure.estimated if structure else shown
        super().__init__(shown, [known[name] for name in controlled], moved, fed_back)

    def parameters(self) -> list[Signal]:
        """Return reference of each measurement, and the matrices of the observer."""
        references = [signals.at_rest(y, "reference") for y in self.measured]
        return references + (self.observer.parameters() if self.observer else [])

    def state(self) -> list[Signal]:
        """Return the estimates."""
        return self.observer.state() if self.observer else []

    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the deviations of the state from the operating point."""
        found = [reading.measurements[y.name] - sample[path(y, "reference")] for y in self.measured]
        return self.observer.correct(sample, found, reading.known) if self.observer else found

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the next estimate, under the inputs that were applied."""
        if self.observer:
            pairs = zip(self.manipulated, applied, strict=True)
            moves = [output - sample[path(u, "bias")] for u, output in pairs]
            self.observer.predict(sample, known, moves)
