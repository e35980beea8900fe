"""The inputs of a rig over a session, as its touches say."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import path
from clepsydra.engine.white_noise import stream_of, white_noise
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import Session
from clepsydra.laboratory.touch import DriftTouch, InputTouch, NoiseTouch


def input_columns(rig: Rig, session: Session) -> dict[str, np.ndarray]:
    """Return every input that all controllers of a rig share, by name [samples].

    A touch holds until the next one of the same input. Where a disturbance is noisy, its noise is
    added to what hands have set; that of a sensor, and its drift, enter its own input.
    """
    samples = session.samples
    given = {name: [(0, value)] for name, value in rig.inputs.items()}
    for touch in session.touches:
        if isinstance(touch, InputTouch):
            given[touch.input].append((touch.sample, touch.value))
    columns = {}
    for name, changes in given.items():
        starts, values = zip(*changes, strict=True)
        columns[name] = np.repeat(np.array(values), np.diff([*starts, samples]))
    noisy = _noisy(session)
    measured = [signal.name for signal in rig.process.measurements]
    for name, deviation in rig.noises.items():
        if noisy.any():
            noise = deviation * white_noise(session.seed, stream_of(name), 0, samples)
            column = path(name, "noise") if name in measured else name
            columns[column] += np.where(noisy, noise, 0.0)
    for name in measured:
        columns[path(name, "noise")] += _drift(session, name, rig.process.sampling_period)
    return columns


def _noisy(session: Session) -> np.ndarray:
    """Return where there is noise [samples]."""
    noisy = np.zeros(session.samples, bool)
    for touch in session.touches:
        if isinstance(touch, NoiseTouch):
            noisy[touch.sample :] = touch.is_noisy
    return noisy


def _drift(session: Session, name: str, period: float) -> np.ndarray:
    """Return what a sensor has drifted by [samples]."""
    drift = np.zeros(session.samples)
    for touch in session.touches:
        if isinstance(touch, DriftTouch) and touch.measurement == name:
            passed = np.arange(session.samples - touch.sample) * period
            drift[touch.sample :] = touch.rate * passed
    return drift
