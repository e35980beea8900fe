"""Which settings of a controller the reader of a report may move, and how far."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import symbol_of
from clepsydra.base.units import unit_text
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_keys import GAINS, SHORT_NAMES
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.gain_units import gain_factor
from clepsydra.process.joined_unit import BESIDE
from clepsydra.report.facts import gain_unit
from clepsydra.report.quantities import display_factor
from clepsydra.studies.tuning.parameters import TunedParameter, around, settings_of


@dataclass(frozen=True)
class _Scale:
    """How the reader sees a parameter: by a symbol, and one SI unit of it as so many of another."""

    symbol: str
    factor: float
    unit: str


def sliders(controller: Controller) -> list[dict[str, Any]]:
    """Return the settings of each loop, or of the law where it has none, as sliders.

    Examples
    --------
    >>> import clepsydra as cl
    >>> (first, _) = sliders(cl.design.simc(cl.load("quadruple-tank")))
    >>> first["title"], [each["symbol"] for each in first["settings"]]
    ('level_1 by pump_1', ['K', 'Ti', 'b'])
    """
    tuned = {each.name: each for each in _movable(controller)}
    law = {each.name: place for place, each in enumerate(controller.law.parameters)}
    signals = {each.name: each for each in controller.law.parameters if not each.matrix}
    blocks = [each for each in controller.law.blocks if isinstance(each, PidBlock)]
    found, told = [], set[str]()
    for block in blocks:
        own = [each.name for each in block.parameters() if each.name in tuned]
        told.update(own)
        settings = [
            _slider(controller, tuned[name], signals[name], law, _of_loop(block, signals[name]))
            for name in own
        ]
        if settings:
            title = f"{block.measurement.name} by {block.moved.name}"
            found.append({"loop": block.owner, "title": title, "settings": settings})
    rest = [name for name in signals if name in tuned and name not in told]
    # By what they are of first of all: that has a part for each of several numbers.
    owners = [name.partition(".")[0] for name in rest]
    for owner in dict.fromkeys(owners):
        settings = [
            _slider(controller, tuned[name], signals[name], law, _plain(signals[name]))
            for name, own in zip(rest, owners, strict=True)
            if own == owner
        ]
        found.append({"loop": owner, "title": owner, "settings": settings})
    return found


def _movable(controller: Controller) -> list[TunedParameter]:
    """Return what may be tuned, and what else makes a law bolder, but for numbers of matrices."""
    found: list[TunedParameter] = []
    with suppress(NotApplicable):
        found += settings_of(controller)
    known = {each.name for each in found}
    more = [
        each.name
        for each in controller.law.parameters
        if each.bolder and not each.matrix
        and each.name not in known and controller.values[each.name]
    ]  # fmt: skip
    return [*found, *around(controller, more)]


def bolder(controller: Controller) -> list[tuple[int, float]]:
    """Return the parameters that grow as a controller gets bolder, each with its power.

    Examples
    --------
    >>> import clepsydra as cl
    >>> bolder(cl.design.simc(cl.load("three-tanks")))
    [(0, 1.0)]
    """
    return [
        (place, each.bolder)
        for place, each in enumerate(controller.law.parameters)
        if each.bolder and controller.values[each.name]
    ]


def _slider(
    controller: Controller,
    tuned: TunedParameter,
    signal: Signal,
    places: dict[str, int],
    scale: _Scale,
) -> dict[str, Any]:
    value = controller.values[signal.name]
    factor = -scale.factor if value < 0.0 and tuned.logarithmic else scale.factor
    low, high = sorted((tuned.low * factor, tuned.high * factor))
    # A law of a user's may have no bounds; JSON has no infinite numbers.
    least, most = sorted(
        min(max(end * factor, -LARGEST_NUMBER), LARGEST_NUMBER) for end in (signal.low, signal.high)
    )
    return {
        "symbol": scale.symbol,
        "words": signal.description,
        "unit": scale.unit,
        "value": value * factor,
        "factor": 1.0 / factor,
        "values": [places[name] for name in (signal.name, *tuned.followers)],
        "low": low,
        "high": high,
        # A gain of the other sign would be another action.
        "least": max(least, 0.0) if tuned.logarithmic else least,
        "most": most,
        "logarithmic": tuned.logarithmic,
    }


def _of_loop(block: PidBlock, signal: Signal) -> _Scale:
    symbol = symbol_of(SHORT_NAMES.get(signal.part, signal.part))
    if signal.part not in GAINS:
        return replace(_plain(signal), symbol=symbol)
    signals = block.measurement, block.moved
    unit = f"{gain_unit(*signals)}{BESIDE[GAINS[signal.part]]}".strip()
    return _Scale(symbol, gain_factor(*signals), unit)


def _plain(signal: Signal) -> _Scale:
    words = re.sub(r"[._]", " ", signal.name.partition(".")[2])
    return _Scale(words, display_factor(signal), unit_text(signal.shown_unit))
