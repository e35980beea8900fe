"""Random scans hold every kind of trouble that an input can express."""

import math

import numpy as np
import pytest

from clepsydra import Signal
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.program import Block, Program

SCANS = 10_000
INPUTS = (
    Signal("level_1.sp", "V", low=0.0, high=10.0),
    Signal("level_1.pv", "V", low=0.0, high=10.0),
    Signal("level_1.good", kind="boolean", low=0.0, high=1.0, initial=1.0),
    Signal("pump_1.mode", kind="integer", low=0.0, high=2.0, initial=1.0),
    Signal("pump_1.manual", "V", low=-2.0, high=8.0),
    Signal("pump_1.tracking", "V"),
    Signal("level_1.setpoint_source", kind="integer", low=0.0, high=1.0),
    Signal("start", kind="integer", low=0.0, high=2.0),
    Signal("acknowledge", kind="boolean", low=0.0, high=1.0),
    Signal("time_step", "s", low=0.0, initial=0.5),
)
PARAMETERS = (Signal("gain", initial=2.0), Signal("pump_1.rate_limit", "V/s", initial=1e9))
PROGRAM = Program("law", (), INPUTS, PARAMETERS, (), Block(len(INPUTS) + 2, (), ()))


def runs(flags: np.ndarray) -> np.ndarray:
    """Lengths of the stretches in which a flag is set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return edges[1::2] - edges[::2]


@pytest.mark.parametrize("period", [0.1, 0.5, 1.0, 60.0])
def test_faults_last_for_less_and_for_more_than_the_delay(period):
    scans = random_scans(PROGRAM, SCANS, 3, period)
    values = scans["level_1.pv"]
    with np.errstate(all="ignore"):
        current = 4.0 + 16.0 * values / 10.0
    fault = ~((current >= 3.6) & (current <= 21.0))
    delay = math.ceil(4.0 / period)
    lengths = runs(fault)
    assert np.any((lengths < delay) & (lengths > 0.5 * delay)) or delay == 1
    assert np.any(lengths > delay)
    assert {delay, delay + 1} & set(lengths.tolist())  # and just at it
    assert 0.01 < fault.mean() < 0.5
    uncertain = ((current >= 3.6) & (current < 3.8)) | ((current > 20.5) & (current <= 21.0))
    assert uncertain.sum() > 20
    assert np.isnan(values).sum() >= 5 and np.isinf(values).sum() >= 5


def test_every_input_shows_what_it_can_express():
    scans = random_scans(PROGRAM, SCANS, 2, 0.5)
    assert set(scans) == {signal.name for signal in (*INPUTS, *PARAMETERS)}
    assert all(len(values) == SCANS for values in scans.values())
    assert set(scans["pump_1.mode"].tolist()) == {-1.0, 0.0, 1.0, 2.0, 3.0}
    assert (scans["pump_1.mode"] == 1.0).mean() > 0.5
    assert set(scans["level_1.setpoint_source"].tolist()) == {-1.0, 0.0, 1.0, 2.0}
    assert {0.0, 1.0, 2.0} < set(scans["start"].tolist())
    assert set(scans["acknowledge"].tolist()) == set(scans["level_1.good"].tolist()) == {0.0, 1.0}
    steps = scans["time_step"]
    assert (steps == 0.5).mean() > 0.9
    assert np.isnan(steps).any() and (steps <= 0.0).any() and (steps == 1.0).any()
    manual = scans["pump_1.manual"][np.isfinite(scans["pump_1.manual"])]
    assert (manual < -2.0).any() and (manual > 8.0).any()
    setpoints = scans["level_1.sp"]
    assert np.isnan(setpoints).any() and (setpoints[np.isfinite(setpoints)] > 10.0).any()
    with np.errstate(invalid="ignore"):
        near = np.abs(scans["level_1.pv"] - setpoints) < 0.2
    assert 0.2 < near.mean() < 0.8


def test_starts_and_acknowledgements_last_for_a_scan_or_for_long():
    scans = random_scans(PROGRAM, SCANS, 1, 0.5)
    for value in (1.0, 2.0):
        lengths = runs(scans["start"] == value)
        assert (lengths == 1).sum() > 5 and lengths.max() > 100
    for value in (0.0, 1.0):
        lengths = runs(scans["acknowledge"] == value)
        assert lengths.min() < 10 and lengths.max() > 100
    assert (scans["start"] == 0.0).mean() > 0.7


@pytest.mark.parametrize("seed", range(5))
def test_starts_come_while_a_sensor_is_bad_and_while_it_is_good(seed):
    scans = random_scans(PROGRAM, SCANS, seed, 0.5)
    current = 4.0 + 16.0 * scans["level_1.pv"] / 10.0
    with np.errstate(all="ignore"):
        bad = ~((current >= 3.6) & (current <= 21.0)) | (scans["level_1.good"] == 0.0)
    for value in (1.0, 2.0):
        begins = np.flatnonzero(np.diff(scans["start"] == value) & (scans["start"][1:] == value))
        begun_bad = bad[begins + 1].sum()
        assert begun_bad >= 5 and len(begins) - begun_bad >= 2


def test_half_of_the_time_somebody_tunes():
    scans = random_scans(PROGRAM, SCANS, 1, 0.5)
    gain, rate = scans["gain"], scans["pump_1.rate_limit"]
    # Now and then one is typed wrong.
    wrong, other = (~np.isnan(x) & ~((x > 0.0) & (x < 3.0)) for x in (gain, rate))
    assert 0 < wrong.mean() < 0.002 and 0 < other.mean() < 0.002
    tuned = ~np.isnan(gain) & ~wrong
    assert 0.2 < tuned.mean() < 0.8
    same = ~wrong & ~other
    assert np.array_equal(tuned[same], ~np.isnan(rate)[same])
    assert len(np.unique(gain[tuned])) > 5
    assert np.all(np.abs(gain[tuned] - 2.0) <= 0.02)


def test_a_process_stays_within_its_ranges_and_nothing_is_broken():
    scans = random_scans(PROGRAM, SCANS, 1, 0.5, broken=False)
    assert set(scans) == {signal.name for signal in INPUTS}
    for signal in INPUTS:
        values = scans[signal.name]
        assert np.isfinite(values).all()
        if math.isfinite(signal.span):
            assert values.min() >= signal.low and values.max() <= signal.high
    assert np.all(scans["level_1.good"] == 1.0) and np.all(scans["time_step"] == 0.5)
    assert np.ptp(scans["pump_1.manual"]) > 5.0


def test_scans_depend_on_nothing_but_seed_and_name():
    first, again = (random_scans(PROGRAM, SCANS, 7, 0.5) for _ in range(2))
    other = random_scans(PROGRAM, SCANS, 8, 0.5)
    fewer = Program("other", (), INPUTS[3:], (), (), Block(7, (), ()))
    alone = random_scans(fewer, SCANS, 7, 0.5)
    for name, values in first.items():
        assert np.array_equal(values, again[name], equal_nan=True)
        assert not np.array_equal(values, other[name], equal_nan=True)
    # A start depends on the sensors too.
    same = set(alone) - {"start"}
    assert all(np.array_equal(alone[n], first[n], equal_nan=True) for n in same)
