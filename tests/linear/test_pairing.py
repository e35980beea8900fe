"""Pairings where the loops act: levels and flows, whose relative gains turn round with frequency.

A tank of area A, fed by a pump, lets q = f(u, h) through a valve. With T = A/(∂q/∂h) the level
answers to both by a lag of T, the outflow to the valve at once and to the pump by T, so that the
relative gain of the outflow by the valve is λ = sT/(1 + sT): nothing at rest, one above 1/T.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.linear.pairing import paired_gains
from clepsydra.linear.relative_gain_array import relative_gain_response, suggest_pairing

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
TEXT = (EXAMPLES / "level-and-flow.toml").read_text(encoding="utf-8")
#: A · 2h/q of 1 m², 1 m and 0.8 l/s, since q goes with the root of the level [s].
TIME = 2.0 * 1.0 / 0.8e-3


def share(omega: float) -> complex:
    return 1j * omega * TIME / (1.0 + 1j * omega * TIME)


@pytest.fixture(scope="module")
def tank():
    return cl.load(EXAMPLES / "level-and-flow.toml")


def test_the_flow_goes_to_its_valve_and_the_level_to_the_feed(tank):
    assert tank.analysis.pairing == (("level", "feed_pump"), ("flow_out", "outlet_valve"))
    slow = suggest_pairing(tank.analysis.relative_gain_array, *names(tank.analysis.model))
    assert slow == [("level", "outlet_valve"), ("flow_out", "feed_pump")]


def names(model):
    return model.outputs, model.inputs


@pytest.mark.parametrize("omega", [1e-4, 1e-3, 1e-2])
def test_relative_gains_turn_round_above_the_time_constant(tank, omega):
    gains = relative_gain_response(tank.analysis.model, omega)[0]
    np.testing.assert_allclose(gains[[0, 1], [0, 1]], share(omega), rtol=1e-9)


def test_gains_are_told_at_rest_and_where_the_loops_act(tank):
    """The pump, at 40 % of 2 l/s, has 0.8 l/s of room for a step of 0.2 m: 0.004 rad/s."""
    level, flow = tank.analysis.paired_gains
    room = 0.8e-3 / 0.2
    assert level.crossover == pytest.approx(np.sqrt(room**2 - TIME**-2), rel=1e-2)
    assert level.at_crossover == pytest.approx(share(level.crossover).real, rel=1e-9)
    # The valve's gain is never below one, so half a sampling period limits the flow.
    assert flow.crossover == pytest.approx(2.0)
    assert flow.at_crossover == pytest.approx(1.0, abs=1e-6)
    assert level.at_rest == pytest.approx(0.0, abs=1e-9) == flow.at_rest
    assert level.changed_by_others and flow.changed_by_others


def test_words_and_the_table_say_both_numbers(tank):
    said = "level with feed_pump (relative gain 0.99 at 0.0040 rad/s, 0.00 at rest)"
    assert said in " ".join(tank.analysis.words)
    assert "close flow_out, the fastest, first" in " ".join(tank.analysis.words)
    answer = " ".join(str(tank.analysis).split())
    assert "level by feed_pump" in answer and "0.99 at 0.0040 rad/s, 0.00 at rest" in answer
    pairs = tank.analysis.as_dict()["paired_gains"]
    assert pairs[1]["output"] == "flow_out" and pairs[1]["at_crossover"] > 0.99


def test_the_order_of_signals_changes_no_pairing(tmp_path):
    swap = [
        ('"level", "flow_out"', '"flow_out", "level"'),
        ('"feed_pump", "outlet_valve"', '"outlet_valve", "feed_pump"'),
    ]
    pairs = dict(plant_of(tmp_path, TEXT, *swap).analysis.pairing)
    assert pairs == {"level": "feed_pump", "flow_out": "outlet_valve"}


LONG = """
[valves.weir_valve]
source = "upper"
destination = "tank"
kv = "16 m^3/h"
range = ["0 %", "100 %"]
[tanks.upper]
area = "1 m^2"
height = "2 m"
[sensors.first]
tank = "upper"
range = ["0 m", "2 m"]
"""


@pytest.mark.parametrize(
    ("edits", "expected"),
    [
        # Ten times as wide and as narrow: the time constant moves away from the crossover.
        ([('area = "1 m^2"', 'area = "10 m^2"')], {}),
        ([('area = "1 m^2"', 'area = "0.1 m^2"')], {}),
        # Pumped out, the level integrates and nothing but the pump moves the outflow.
        (
            [
                ('kv = "16 m^3/h"', 'gain = "0.014 l/(s %)"'),
                ("[valves.outlet_valve]", "[pumps.outlet_valve]"),
            ],
            {},
        ),
        # What flows in is measured in place of what flows out: the pump's own, the valve the rest.
        (
            [
                ('flow = "outlet_valve"', 'flow = "feed_pump"'),
            ],
            {"level": "outlet_valve", "flow_out": "feed_pump"},
        ),
    ],
)  # fmt: skip
def test_levels_with_a_flow_of_any_kind(tmp_path, edits, expected):
    plant = plant_of(tmp_path, TEXT, *edits)
    right = {"level": "feed_pump", "flow_out": "outlet_valve"}
    assert dict(plant.analysis.pairing) == (expected or right)


def test_two_tanks_in_a_row_and_the_flow_behind_them(tmp_path):
    """Of three loops each valve keeps the flow, or the level, next to it."""
    text = TEXT.replace('destination = "tank"\ngain', 'destination = "upper"\ngain') + LONG
    text = text.replace(
        'controlled = ["level", "flow_out"]', 'controlled = ["first", "level", "flow_out"]'
    )
    text = text.replace(
        'manipulated = ["feed_pump", "outlet_valve"]',
        'manipulated = ["feed_pump", "weir_valve", "outlet_valve"]',
    )
    text = text.replace('level = "1 m"', 'level = "1 m"\nfirst = "1 m"')
    plant = plant_of(tmp_path, text)
    assert plant.analysis.pairing == (
        ("first", "feed_pump"),
        ("level", "weir_valve"),
        ("flow_out", "outlet_valve"),
    )


@pytest.mark.parametrize(
    "name",
    ["quadruple-tank", "quadruple-tank-nonminimum-phase", "laboratory-four-tanks",
     "laboratory-four-tanks-nonminimum-phase", "averaging-tank"],
)  # fmt: skip
def test_loops_that_are_alike_alone_and_together_are_paired_as_at_rest(name):
    analysis = cl.load(name).analysis
    at_rest = suggest_pairing(analysis.relative_gain_array, *names(analysis.model))
    assert list(analysis.pairing) == at_rest
    assert not any(pair.changed_by_others for pair in analysis.paired_gains)


def test_a_zero_in_the_right_half_plane_limits_where_loops_act():
    """Johansson (12): faster than half of the zero nothing can be, whatever the pumps could."""
    analysis = cl.load("quadruple-tank-nonminimum-phase").analysis
    zero = max(analysis.zeros.real)
    assert [pair.crossover for pair in analysis.paired_gains] == pytest.approx([zero / 2.0] * 2)


def test_a_given_pairing_is_judged_as_it_is(tank):
    slow = paired_gains(tank.analysis.model, [("level", "outlet_valve"), ("flow_out", "feed_pump")])
    assert [pair.at_rest for pair in slow] == pytest.approx([1.0, 1.0])
    assert slow[0].at_crossover < 0.02
    assert not any(pair.changed_by_others for pair in slow)
