"""The noise that a process has, in the last stretch of a scenario."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clepsydra.loop.finite_span import finite_span
from clepsydra.loop.noise import Noise
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process

#: Standard deviation of the noise of a measurement that has none of its own, share of its range.
NOISE_SHARE = 0.005


def with_noise(
    scenario: Scenario, process: Process, first: int = 0, *, usual: bool = True
) -> Scenario:
    """Return a quiet scenario with the noise of a process from a sample on.

    Each measurement has noise, and those disturbances for which the process gives it.

    Parameters
    ----------
    usual : bool
        Whether a measurement for which the process gives none has the usual one.

    Raises
    ------
    InputError
        A measurement has neither a noise nor a finite range, or the seed is no whole number
        from 0.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.scenario import scenario_of_changes
    >>> plant = cl.load("quadruple-tank")
    >>> noisy = with_noise(scenario_of_changes(plant.point, (), 6), plant.process, first=2)
    >>> noisy.noise.any(axis=1)
    array([False, False,  True,  True,  True,  True])
    >>> noisy.noises[0]
    Noise(signal='level_1', deviation=0.05, first=2, count=4)
    """
    deviations = {
        signal.name: NOISE_SHARE * finite_span(process, signal)
        for signal in process.measurements
        if usual and signal.name not in process.noise
    } | process.noise
    noise, disturbances = scenario.noise.copy(), scenario.disturbances.copy()
    columns = (
        *zip(process.measurements, noise.T, strict=True),
        *zip(process.disturbances, disturbances.T, strict=True),
    )
    noises = []
    for signal, column in columns:
        if signal.name in deviations:
            deviation, count = deviations[signal.name], scenario.samples - first
            noises.append(Noise(signal.name, deviation, first, count))
            column[first:] += noises[-1].values(scenario.seed)
    return replace(
        scenario,
        noise=noise,
        disturbances=disturbances,
        noises=tuple(noises),
        quiet_disturbances=scenario.disturbances,
    )


def with_other_noise(scenario: Scenario, process: Process, seed: int) -> Scenario:
    """Return a scenario with the same kind of noise from another seed.

    Noise that was given by its values stays.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.scenario import scenario_of_changes
    >>> plant = cl.load("quadruple-tank")
    >>> quiet = scenario_of_changes(plant.point, (), 6, seed=1)
    >>> noisy = with_noise(quiet, plant.process)
    >>> other, again = (with_other_noise(noisy, plant.process, seed) for seed in (2, 1))
    >>> bool(np.any(other.noise == noisy.noise)), bool(np.all(again.noise == noisy.noise))
    (False, True)
    """
    noise, disturbances = scenario.noise.copy(), quiet_disturbances(scenario).copy()
    tables = ((process.measurements, noise), (process.disturbances, disturbances))
    columns = {
        s.name: row for group, table in tables for s, row in zip(group, table.T, strict=True)
    }
    for each in scenario.noises:
        stretch = slice(each.first, each.first + each.count)
        if each.signal not in {signal.name for signal in process.disturbances}:
            columns[each.signal][stretch] = 0.0
        columns[each.signal][stretch] += each.values(seed)
    return replace(scenario, noise=noise, disturbances=disturbances, seed=seed)


def quiet_disturbances(scenario: Scenario) -> np.ndarray:
    """Return the disturbances without their noise, as far as that is known [samples, k]."""
    quiet = scenario.quiet_disturbances
    return scenario.disturbances if quiet is None else quiet
