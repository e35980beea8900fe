"""The verb that tells how good control could be."""

import json

import pytest

#: A centimetre above rest.
STEP = ("three-tanks", "--input", "level_3=6.09684 cm@10 s")


def test_it_tells_the_published_limit_with_its_proofs(command):
    status, text, _ = command("limit", *STEP, "--json")
    (event,) = json.loads(text)["events"]
    assert status == 0 and event["accepted"]
    assert event["errors"]["level_3"] == pytest.approx(0.354, rel=0.005)  # [m s]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--duration", "x"), "--duration: got 'x', expected a quantity convertible to s"),
        (("--duration=-5s",), "--duration: got '-5s', expected a time from 0 s on"),
        (("--within", "3kg"), "--within 3kg: got '3kg', expected an input, '=' and its value"),
        (("--within", "inflow_3=1..2"), "--within: got 'inflow_3', expected an input (feed)"),
        (
            ("--input", "level_3=3 kg"),
            "step of level_3, to: got '3 kg', expected a value of level_3",
        ),
    ],
)
def test_a_mistake_is_told_by_its_option(command, arguments, said):
    status, output, errors = command("limit", "three-tanks", *arguments)
    assert (status, output) == (2, "")
    assert said in errors and errors.startswith("clepsydra: ") and "Traceback" not in errors
