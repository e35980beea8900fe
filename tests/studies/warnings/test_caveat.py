"""Whose figures a caveat is about: one controller, several of them, or every one."""

import pytest

from clepsydra.studies.warnings.caveat import Caveat, told_once

SLIGHT, GRAVE = (Caveat(f"It is {x} % wrong.", "error", float(x)) for x in (1, 9))


@pytest.mark.parametrize(
    ("runs", "said"),
    [
        ({"PI": [GRAVE], "PID": [], "LQI": []}, "PI: It is 9 % wrong."),
        ({"PI": [SLIGHT], "PID": [GRAVE], "LQI": []},
         "2 of 3 controllers, most of all PID: It is 9 % wrong."),
        ({"PI": [GRAVE], "PID": [SLIGHT], "LQI": [SLIGHT]},
         "Every controller, most of all PI: It is 9 % wrong."),
        ({"PI": [GRAVE]}, "PI: It is 9 % wrong."),
    ],
)  # fmt: skip
def test_it_is_told_once_with_those_of_whom_it_is_true(runs, said):
    assert told_once(runs.items()) == (said,)


def test_two_of_another_kind_are_told_apart():
    other = Caveat("Its scenario is short.", "scenario")
    assert told_once([("PI", [SLIGHT, other])]) == ("PI: It is 1 % wrong.",
                                                    "PI: Its scenario is short.")  # fmt: skip
