"""A study of one cascade: a level loop that moves the setpoint of a flow loop."""


def flow_cascade(
    duration: str = "20 min",
    at: str = "2 min",
    by: str = "5 %",
    noise: str = "false",
    high: str = "35 l/s",
    level_time: str = "",
    flow_gain: str = "0.3 %/%",
    flow_time: str = "6 s",
) -> str:
    """Return the study file.

    `by` and `at` are of the step of the level's setpoint; `level_time` is the integral time of the
    level loop, which is a P loop without; `high` is the highest setpoint of the flow loop.
    """
    integral = f'actions = "PI"\nintegral_time = "{level_time}"' if level_time else 'actions = "P"'
    highest = f'setpoint_high = "{high}"\n' if high else ""
    return f"""
process = "wet-well:flow-meters"
[scenario]
duration = "{duration}"
noise = {noise}
[[scenario.setpoint]]
signal = "level"
at = "{at}"
by = "{by}"
[controllers.cascade.loops.level]
measurement = "level"
output = "flow.setpoint"
{integral}
action = "direct"
gain = "3 %/%"
[controllers.cascade.loops.flow]
measurement = "duty_flow"
output = "duty"
actions = "PI"
action = "reverse"
gain = "{flow_gain}"
integral_time = "{flow_time}"
{highest}"""
