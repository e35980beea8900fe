"""A controller with other settings starts at rest, whatever its law."""

import pytest

import clepsydra as cl

LOOPS = {"simc", "amigo", "variable_structure_pid"}
STATES = {
    "lqi", "lqi_kalman", "lqi_extended_kalman", "lqr", "pole_placement",
    "gain_scheduled_lqi", "glover_mcfarlane", "feedback_linearisation", "fuzzy_pi", "polynomial",
}  # fmt: skip


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.mark.parametrize("name", sorted(LOOPS | STATES))
def test_nothing_moves_before_the_setpoint_does(plant, name):
    given = getattr(cl.design, name)(plant)
    if name in LOOPS:
        values = {f"level_{i}": {"K": 1.3, "b": 0.4} for i in (1, 2)}
    else:
        values = {
            signal.name: f"{factor * given.values[signal.name]!r} {signal.unit}".removesuffix(" 1")
            for signal in given.law.parameters
            for word, factor in (("weight", 0.6), ("gain", 1.1), ("feedback", 1.1))
            if word in signal.name and not signal.name.startswith("model.")
        }
    assert values
    changed = given.with_values(values)
    event = cl.step("level_1", "+1 V", at="20 s")
    table = cl.simulate(plant, changed, [event], duration="40 s").to_pandas()
    before = table.loc[:19.5, ["level_1", "level_2", "pump_1", "pump_2"]]
    assert (before - before.iloc[0]).abs().max().max() < 1e-5  # [V], a millionth of the range
    assert abs(before["pump_1"].iloc[0] - 3.0) < 1e-5
    assert (table["pump_1"] - 3.0).abs().max() > 0.1  # the controller is at work
