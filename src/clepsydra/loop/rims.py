"""What comes over the rim of an open tank without a weir: it spills between two samples."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.elements.tank import Tank
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline


def open_rims(process: Process) -> dict[str, Signal]:
    """Return the tanks that spill without a weir, each with the volume that it has spilt [m³].

    Examples
    --------
    >>> import clepsydra as cl
    >>> [signal.name for signal in open_rims(cl.load("quadruple-tank").process).values()][:2]
    ['tank_1.spilt', 'tank_2.spilt']
    >>> open_rims(cl.load("wet-well").process)
    {}
    """
    return {
        tank.name: Signal(f"{tank.name}.spilt", "m^3", description=f"volume spilt over {tank.name}")
        for tank in _tanks(process)
    }


def append_rims(
    builder: BlockBuilder, process: Process, value: Mapping[str, int], contents: Mapping[str, int]
) -> tuple[dict[str, int], list[int]]:
    """Append to a program what spills where a level has come above its rim.

    The rest stands at the rim and is as concentrated as before.

    Parameters
    ----------
    value : mapping
        Values by name: parameters, and what has been spilt so far.
    contents : mapping
        Of the process, before anything spills.

    Returns
    -------
    contents : dict
        With what is left of those of these tanks.
    spilt : list of int
        The next values of `open_rims`.
    """
    left, spilt = dict(contents), []
    for tank, total in zip(_tanks(process), open_rims(process).values(), strict=True):
        held = [signal.name for signal in tank.contents()]
        names = [*held, *(signal.name for signal in tank.parameters()), total.name]
        symbols = {name: ca.SX.sym(name) for name in names}
        rest = ca.Function(
            "rim", [ca.vertcat(*symbols.values())], [_spilling(tank, symbols, total)]
        )
        arguments = [left[name] if name in left else value[name] for name in names]
        *after, now = inline(builder, rest, arguments, fused=True)
        left |= dict(zip(held, after, strict=True))
        spilt.append(now)
    return left, spilt


def _tanks(process: Process) -> list[Tank]:
    tanks = (each for each in process.elements if isinstance(each, Tank))
    return [tank for tank in tanks if not tank.spilt and tank.lid is None]


def _spilling(tank: Tank, symbols: Mapping[str, ca.SX], total: Signal) -> ca.SX:
    """Return the contents that a tank keeps, and what it has spilt then."""
    sizes = tank.vessel.sizes(tank.name, symbols)
    states, rim = tank.to_states(symbols), tank.vessel.rim(sizes)
    full = tank.to_contents({**symbols, **states, tank.level: rim})
    first, *_ = full
    above = symbols[first] > full[first]
    lost = tank.vessel.volume(states[tank.level], sizes) - tank.vessel.volume(rim, sizes)
    kept = (ca.if_else(above, full[name], symbols[name]) for name in full)
    return ca.vertcat(*kept, symbols[total.name] + ca.if_else(above, lost, 0))
