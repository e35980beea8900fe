"""A record of a simulation, to try an experiment before it is made."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.identification.record import Record
from clepsydra.loop.open_loop import Simulation


def record_of(
    run: Simulation, noise: Mapping[str, float] | None = None, *, seed: int = 1
) -> Record:
    """Return the signals of a simulation as a record, with white noise on some.

    Parameters
    ----------
    run : Simulation
    noise : mapping, optional
        Signal to the standard deviation of its noise [SI].
    seed : int
        Of the noise.

    Raises
    ------
    InputError
        It has fewer than 30 samples.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> moves = {"1 min": "3.5 V", "8 min": "2.5 V", "14 min": "3.2 V"}
    >>> steps = [cl.step("pump_1", to=value, at=time) for time, value in moves.items()]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, steps, duration="20 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> found.best.name, round(found.best.estimates[0].value, 1)  # [V/V]
    ('FOPDT', 2.6)
    """
    random = np.random.default_rng(seed)
    values = dict(run.values)
    for name, deviation in (noise or {}).items():
        values[name] = values[name] + random.normal(0.0, deviation, len(run.time))
    period = run.process.sampling_period
    return Record(f"simulation of {run.process.name}", run.signals, values, period)
