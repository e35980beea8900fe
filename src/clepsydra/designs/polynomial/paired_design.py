"""What the designs of paired polynomial loops share: slowed down or as given, with its notes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from clepsydra.controllers.controller import Controller
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.gain_units import percent_gain
from clepsydra.designs.loops.loops_together import LoopsTogether
from clepsydra.designs.loops.words import by_pair
from clepsydra.designs.polynomial.paired_models import LoopGains, ModelledPair
from clepsydra.designs.slowing_down import OF_STATE_FEEDBACK, note_on_peak, note_on_slowing
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import StepLaw


def paired_controller(
    name: str,
    family: str,
    model: LinearModel,
    pairs: Sequence[ModelledPair],
    law: StepLaw,
    gains_at: Callable[[float], list[LoopGains]],
    source: str,
    given: str,
    notes: Sequence[str] = (),
    fixed: Mapping[str, float] = MappingProxyType({}),
) -> Controller:
    """Return the controller of paired loops, at rest at the operating point.

    Parameters
    ----------
    gains_at : callable
        The factor by which the loops are slower to the gains of each.
    given : str
        What the user asked for, which is not slowed down; empty for nothing.
    fixed : mapping
        Parameters that no gain changes.

    Raises
    ------
    NotApplicable
        The loops are unstable together, or no slowing down brings their peak to 2.
    """

    def values_of(gains: Sequence[LoopGains]) -> dict[str, float]:
        values: dict[str, float] = {}
        for loop, pair in zip(gains, pairs, strict=True):
            values |= loop.values(pair.output)
        return values

    point, first = operating_point_of(model), gains_at(1.0)
    values = {**numbers_at(point, law.parameters), **fixed, **values_of(first)}
    blank = controller_at(point, name, family, law, values)
    loops = LoopsTogether(blank, model, values_of, OF_STATE_FEEDBACK)
    if given:
        found = loops.as_given(first, f"{given}; ask for less")
        more = note_on_peak(found.peak, "choose a larger q_u or slower assigned poles")
    else:
        found = loops.slowed_down(gains_at)
        more = note_on_slowing(found, "the controller")
    words = "; ".join(
        f"{pair.pair}: {loop.words}, gain on a sudden rise "
        f"{percent_gain(loop.error + sum(loop.measurement[:1]), pair.output, pair.input):.3g} "
        "%/%"
        for pair, loop in zip(pairs, found.design, strict=True)
    )
    models = by_pair(pairs, (pair.sampled.in_words() for pair in pairs))
    period = point.process.sampling_period
    holds = f"Its gains hold for a sampling period of {period:g} s and no other."
    said = f"Sampled models: {models}.", *notes, *more, holds
    made = loops.made(found, f"{source}: {words}", said)
    # Minus zeros as zeros.
    state = {name: value + 0.0 for name, value in made.initial_state.items()}
    return replace(made, initial_state=state)
