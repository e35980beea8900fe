"""Parameters of a law that a user wrote, tuned within what that law takes."""

import pytest

import clepsydra as cl
from tests.refusals import refused

LAW = """
from clepsydra import Signal
from clepsydra.program.step_law import Equations, step_law

def equations(s):
    error = s["level.sp"] - s["level.pv"]
    asked = s["integral"] + s["level.proportional_gain"] * error
    back = (s["pump.last_output"] - asked) / s["level.tracking_time"]
    moves = s["level.proportional_gain"] / s["level.integral_time"] * error + back
    following = {{"integral": s["integral"] + moves * s["time_step"]}}
    return Equations(following, {{"pump.out": asked}})

def time(name, low, high):
    return Signal(f"level.{{name}}_time", "s", low=low, high=high, initial=30.0)

law = step_law(
    "own_pi",
    inputs=[Signal(n) for n in ("level.sp", "level.pv", "pump.last_output", "time_step")],
    parameters=[
        Signal("level.proportional_gain", initial=3.0),
        time("integral", *{integral}),
        time("tracking", *{tracking}),
    ],
    state=[Signal("integral")],
    outputs=[Signal("pump.out")],
    equations=equations,
)
"""


@pytest.mark.parametrize(
    ("integral", "tracking", "parameters", "value", "expected"),
    [
        ((1, 900), (1, 40), None, "bounds 3 to 300", "within 1 to 40 s, for level.tracking_time"),
        ((1, 900), (9, 900), ("5 s", "50 s"), "bounds 5 to 50", "within 9 to 900 s"),
        ((30, 30), (1, 900), None, "bounds 30 to 30", "a low bound below the high"),
    ],
)
def test_bounds_that_the_law_does_not_bear(
    integral, tracking, parameters, value, expected, tmp_path
):
    path = tmp_path / "own_pi.py"
    path.write_text(LAW.format(integral=integral, tracking=tracking))
    plant = cl.load("quadruple-tank")
    wired = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}
    start = cl.design.own(plant, cl.load_law(path), **wired, initial_state={"integral": 3.0})
    wanted = parameters and {"level.integral_time": parameters}
    with refused(place="level.integral_time", value=value, expected=expected):
        cl.tune(start, plant, parameters=wanted)
