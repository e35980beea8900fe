"""Settling of three tanks within both usual bands, since the document prints none."""

import re

import numpy as np
import pytest
from plain_three_tanks import optimal_poles
from scipy.signal import step


@pytest.fixture(scope="module")
def rows(audited):
    return {(row.place, row.name): row for row in audited("three-tanks").rows}


def settled_after_step(above, below, band, end):
    """When the unit step response of a transfer function without offset is within a band [s]."""
    seconds, level = step((above, below), T=np.linspace(0.0, end, 60001))
    return seconds[np.flatnonzero(np.abs(level - 1.0) > band)[-1]]


@pytest.mark.parametrize("band", [0.02, 0.05])
def test_claims_of_settling_hold_to_within_2_and_5_percent(rows, band):
    """Poles of Table 2, of least J, and (3) with the printed PID; no design of (2) has a zero."""
    placed = [np.poly([-40.0, -p + 1j * p, -p - 1j * p]).real for p in (25.0, 10.0, 5.0)]
    quadratic = [np.poly(optimal_poles(weight)).real for weight in (0.1, 0.01, 0.001)]
    fast, slow = (
        [settled_after_step([below[-1]], below, band, end) for below in group]
        for group, end in ((placed, 3.0), (quadratic, 12.0))
    )
    above = 0.054 * np.array([0.028, 0.0012, 1.3e-5])
    pid = settled_after_step(
        above, np.polyadd([1.0, 0.1272, 0.0035, 9.4e-6, 0.0], above), band, 1500.0
    )
    assert fast[0] < fast[1] < fast[2] < slow[2] < slow[1] < slow[0] < pid
    assert fast[0] < 0.2 and abs(fast[0] - 0.2) < min(abs(each - 0.2) for each in (*slow, pid))
    place = (0.02, 0.05).index(band)
    said = rows["Table 2", "speed"].computed.split("; ")[place]
    assert said == ", ".join(f"{each:.2f} s" for each in fast)
    pairs = re.findall(r"1/s, (\S+) s and (\S+) s", rows["Table 3", "speed"].computed)
    assert [float(pair[place]) for pair in pairs] == pytest.approx(slow, rel=0.01)
    row = rows["conclusion", "settling time, ISE and IAE"]
    words = row.computed if band == 0.02 else row.reason.partition("to within 5 % ")[2]
    assert words.startswith(f"{fast[0]:.2f} against {pid:.0f} s")
    words = rows["conclusion", "settling time"].computed.split(", ")
    assert f"{fast[0]:.3f} s to within {100 * band:g} %" in words
    for key in (("abstract", "FSFB over LQC"), ("conclusion", "desired specifications"),
                ("Table 2", "speed"), ("Table 3", "speed")):  # fmt: skip
        assert rows[key].verdict == "claim holds" and "5 %" in rows[key].reason


def test_both_loops_of_the_pid_are_stable(rows):
    """By the printed denominator, and by (3) with the printed settings."""
    above = 0.054 * np.array([0.028, 0.0012, 1.3e-5])
    row = rows["closed loop of the PID", "internal stability"]
    for below, words in (
        ([1.0, 0.127, 0.005, 7.5e-5, 7e-7], row.computed),
        (np.polyadd([1.0, 0.1272, 0.0035, 9.4e-6, 0.0], above), row.reason),
    ):
        slowest = np.roots(below).real.max()
        assert slowest < 0.0 and f"up to {slowest:.4f} 1/s" in words
