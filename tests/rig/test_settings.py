"""What a rig is asked for, refused where it cannot be."""

import pytest

import clepsydra as cl
from clepsydra.rig.deadlines import Deadlines
from clepsydra.rig.retention import Retention, read_retention


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"speed": 2000.0}, "take 1000 or less"),
        ({"speed": 0.0}, "from 0.01 to 10000"),
        ({"fail_safe": {"pump_3": "1 V"}}, "pump_3"),
        ({"fail_safe": {"pump_1": "1 cm"}}, "pump_1"),
        ({"silence": "5 V"}, "silence"),
        ({"keep": "3 kB"}, "at least 1 MB"),
        ({"keep": "1 s"}, "at least 10 s"),
        ({"keep": "7 apples"}, "keep"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, asked, said):
    with pytest.raises(cl.InputError) as refused:
        cl.run_rig("quadruple-tank", folder=tmp_path, **asked)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("given", "kept"),
    [("2 h", Retention(age=7200.0)), ("1.5 GB", Retention(size=1_500_000_000))],
)
def test_a_retention_is_a_time_or_a_size(given, kept):
    assert read_retention(given) == kept


def test_deadlines_stay_at_their_places_however_late_one_was():
    now = [0.0]
    slept = []

    def sleep(seconds):
        slept.append(seconds)
        now[0] += seconds + (0.3 if len(slept) == 2 else 0.01)

    deadlines = Deadlines(1.0, now=lambda: now[0], sleep=sleep)
    late = []
    for _ in range(4):
        deadlines.wait()
        late.append(round(deadlines.lateness, 9))
    assert late == [0.01, 0.3, 0.01, 0.01] and deadlines.missed == 0
    assert now[0] == pytest.approx(4.01)
