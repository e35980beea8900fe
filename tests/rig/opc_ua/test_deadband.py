"""When a value is told again, by OPC 10000-4 and OPC 10000-8."""

import math

import pytest

from clepsydra.base.signal import Signal
from clepsydra.rig.doors.opc_ua.deadband import ChangeFilter, RefusedFilter, change_filter
from clepsydra.rig.tag import Tag, Writer


def tag(**fields):
    return Tag("level.pv", "LI1", Signal("level.pv", **fields), Writer.PLANT, "level", "1")


LEVEL = tag(low=0.0, high=200.0)


def told_of(passing, values):
    """Return which of some values are told, each with its status, the first one in any case."""
    told = []
    for value in values:
        if not told or passing.passes(told[-1], value):
            told.append(value)
    return told


def test_slow_drift_is_told_for_it_is_compared_with_what_was_told_last():
    passing = change_filter(LEVEL, 1, 1, 5.0)
    levels = [(float(level), 0) for level in range(51)]
    assert [value for value, _ in told_of(passing, levels)] == [0, *range(6, 51, 6)]


def test_the_edge_of_a_deadband_is_in_it():
    assert not ChangeFilter(deadband=5.0).passes((10.0, 0), (15.0, 0))
    assert ChangeFilter(deadband=5.0).passes((10.0, 0), (math.nextafter(15.0, 16.0), 0))
    assert ChangeFilter(deadband=5.0).passes((10.0, 0), (math.nextafter(5.0, 4.0), 0))


def test_a_deadband_in_percent_is_of_the_range():
    assert change_filter(LEVEL, 1, 2, 2.5).deadband == 5.0


def test_a_change_of_status_is_told_within_the_deadband_and_without_values():
    for trigger in (0, 1, 2):
        passing = change_filter(LEVEL, trigger, 1, 50.0)
        assert passing.passes((10.0, 0), (10.0, 1))
        assert not passing.passes((10.0, 1), (10.0, 1))
        assert passing.passes((10.0, 0), (80.0, 0)) is (trigger != 0)


@pytest.mark.parametrize(
    ("of", "kind", "deadband", "code"),
    [
        (tag(low=0.0), 2, 5.0, "BadMonitoredItemFilterUnsupported"),
        (tag(low=0.0, high=9.0, kind="integer"), 2, 5.0, "BadMonitoredItemFilterUnsupported"),
        (tag(low=0.0, high=1.0, kind="boolean"), 1, 0.5, "BadMonitoredItemFilterUnsupported"),
        (LEVEL, 3, 5.0, "BadMonitoredItemFilterUnsupported"),
        (LEVEL, 2, 100.5, "BadDeadbandFilterInvalid"),
        (LEVEL, 2, -1.0, "BadDeadbandFilterInvalid"),
        (LEVEL, 1, math.nan, "BadDeadbandFilterInvalid"),
        (LEVEL, 1, -0.1, "BadDeadbandFilterInvalid"),
    ],
)
def test_a_deadband_that_a_tag_does_not_have_is_refused(of, kind, deadband, code):
    with pytest.raises(RefusedFilter) as refused:
        change_filter(of, 1, kind, deadband)
    assert refused.value.code == code
