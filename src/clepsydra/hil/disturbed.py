"""What disturbed a plant on wires: its noise, and its sensors that drift, sample by sample."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import path
from clepsydra.engine.white_noise import stream_of, white_noise
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.loop.alarms import acknowledging_inputs
from clepsydra.loop.faults import FORCED, READING
from clepsydra.rig.plant import DRIFT, NOISE, PlantSettings
from clepsydra.rig.tag import ACKNOWLEDGE

#: What an instructor does to what a sensor shows.
_TO_SENSOR = ("noise", FORCED, READING)


def disturbed_inputs(
    settings: PlantSettings, rows: PlantRows, *, as_told: bool
) -> dict[str, np.ndarray]:
    """Return what a plant was given but for its controller and its operator, with noise and drift.

    Parameters
    ----------
    settings : PlantSettings
        Of the plant.
    rows : PlantRows
        From its first sample on.
    as_told : bool
        Whether what is done to what a sensor shows counts from the sample on that was told with it,
        which is the next one: so it is seen on the wires. Else from the one in which it was done.

    Returns
    -------
    dict
        Disturbance, "y.noise", "y.sensor", what makes sensors and final elements fail, and what
        acknowledges alarms, to its values [SI] [samples].
    """
    process, count = settings.station.loop.process, rows.last + 1

    def seen(column: np.ndarray) -> np.ndarray:
        # The plant began to tell as it was at rest.
        return np.concatenate([column[:1], column[:-1]]) if as_told else column

    operated = {path(u, part) for u in process.inputs for part in ("mode", "manual", "tracking")}
    operated |= {path(name, "setpoint") for name in process.controlled}
    names = set(settings.station.numbers.at_rest) - operated
    found = {name: rows.column(name) for name in rows.layout.written if name in names}
    for y in process.measurements:
        for part in _TO_SENSOR:
            found[path(y, part)] = seen(found[path(y, part)])
        drift = _drift(rows.column(path(y, DRIFT)), process.sampling_period)
        found[path(y, "noise")] = found[path(y, "noise")] + drift
    pressed = rows.column(ACKNOWLEDGE)
    for each in acknowledging_inputs(process):
        found[each.name] = np.maximum(found[each.name], pressed)
    measured, noisy = {y.name for y in process.measurements}, rows.column(NOISE) != 0.0
    for name, deviation in settings.noises.items():
        enters = path(name, "noise") if name in measured else name
        white = deviation * white_noise(settings.seed, stream_of(name), 0, count)
        sounds = seen(noisy) if name in measured else noisy
        found[enters] = np.where(sounds, found[enters] + white, found[enters])
    return found


def changes_of_sensors(settings: PlantSettings, rows: PlantRows) -> np.ndarray:
    """Return in which samples something was done to a sensor after they were told [samples]."""
    process = settings.station.loop.process
    parts = [path(y, part) for y in process.measurements for part in _TO_SENSOR]
    changed = np.zeros(rows.last + 1, dtype=bool)
    for name in (*parts, NOISE):
        changed[1:] |= np.diff(rows.column(name)) != 0.0
    return changed


def _drift(rates: np.ndarray, period: float) -> np.ndarray:
    """Return by how much a sensor has drifted in each sample; without a rate it is put right."""
    found, drifted = np.zeros(len(rates)), 0.0
    for sample, rate in enumerate(rates[:-1].tolist(), 1):
        drifted = drifted + rate * period if rate else 0.0
        found[sample] = drifted
    return found
