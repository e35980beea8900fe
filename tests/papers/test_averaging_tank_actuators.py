"""The averaging tank behind actuators and a pipe, beside the phase margins of its loops."""

import numpy as np
import pytest

from clepsydra.papers.averaging_tank import actuators
from clepsydra.papers.averaging_tank.fuzzy import LITERAL

pytestmark = pytest.mark.thorough

OMEGA = np.logspace(-1, 3, 200_001)  # [rad/s]
#: Gain and integral gain of C and of V, of (80) to (83), and of F and Fi in (97b) and (98b) and, by
#: the weights (100a) and (101a), sqrt(Q4/R1) and so on.
GAINS = {
    "PI, f_out constant, by hand": ((50.0, 50.0), (8.0, 4.0)),
    "PI, f_out constant, optimal": ((74.37, 74.37 / 8.325e-4), (8.0, 16.0)),
    "PI, f_in constant, by hand": ((50.0, 5.0), (5.0, 5.0 / 30.0)),
    "PI, f_in constant, optimal": ((61.5, 61.5 / 7.641e-4), (5.034, 5.034 / 3.208e-2)),
    "LQI, f_out constant, by hand": ((13.8661, 10.0), (3.0536, 10.0**0.5)),
    "LQI, f_out constant, optimal": ((262.4, 12.04e6**0.5), (370.77, 10.88e6**0.5)),
    "LQI, f_in constant, by hand": ((14.1987, 10.0), (1.7174, 1.2247)),
    "LQI, f_in constant, optimal": ((256.1, 10.92e6**0.5), (8.6885, (4.528 / 0.0113) ** 0.5)),
}
#: Each lag, and the delay [s].
TIMES = {"hundredth": 0.01, "tenth": 0.1}


def phase_margins(gains, plant, lag, delay):
    """Of a loop at each frequency where its gain is one [°]."""
    s = 1j * OMEGA
    opened = (gains[0] + gains[1] / s) * plant(s) / (1.0 + lag * s)
    crossed = np.flatnonzero(np.diff(np.abs(opened) > 1.0))
    phase = np.unwrap(np.angle(opened))
    phase -= 2.0 * np.pi * np.round((phase[0] + np.pi / 2.0) / (2.0 * np.pi)) + OMEGA * delay
    return 180.0 + np.degrees(phase[crossed])


@pytest.fixture(scope="module")
def row(audited):
    (found,) = audited("averaging-tank").experiments["actuators"].rows
    return found


def bearing(name, *, full_pipe):
    """Tell behind which sizes a loop is stable; a full pipe delays C_in and not f_in."""
    of_c, of_v = GAINS[name]
    stable = [
        words
        for size, words in actuators.SIZES.items()
        for time in [TIMES[size]]
        for of_flow in [time if "f_out constant" in name and not full_pipe else 0.0]
        if min(phase_margins(of_c, lambda s: 0.1 / (s + 0.1), time, time)) > 0.0
        and min(phase_margins(of_v, lambda s: 1.0 / s, time, of_flow)) > 0.0
    ]
    return " and ".join(stable) or "neither"


def test_a_loop_comes_to_rest_where_its_phase_margins_are_positive(row):
    """f_in and C_in pass the lag and the pipe, f_out a lag alone."""
    assert row.verdict == "remark"
    said = dict(each.split(": ") for each in row.computed.split("; "))
    assert said.pop("fuzzy") == "neither"
    assert said == {name: bearing(name, full_pipe=False) for name in GAINS}


def test_a_full_pipe_is_borne_by_one_loop_more(row):
    said = dict(each.split(": ") for each in row.computed.split("; "))
    found = {name: bearing(name, full_pipe=True) for name in GAINS}
    assert {name: each for name, each in found.items() if each != said[name]} == {
        "LQI, f_out constant, optimal": "10 ms"
    }
    assert "C_in alone, as a full one does, LQI with f_out constant, optimal, rests" in row.reason


@pytest.mark.parametrize("size", actuators.SIZES)
def test_fuzzy_control_does_not_hang_on_the_filter_that_is_not_printed(size):
    *_, (_, controller, model) = actuators.loops(size, LITERAL._replace(outflow_unit="1"))
    assert not actuators.comes_to_rest(controller, model)
