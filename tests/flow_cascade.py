"""A study of one cascade: a level loop that moves the setpoint of a flow loop."""


def flow_cascade(
    duration: str = "20 min",
    at: str = "2 min",
    by: str = "5 %",
    noise: str = "false",
    high: str = "35 l/s",
) -> str:
    """Return the study file; `by` and `at` are of the step of the level's setpoint."""
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
actions = "P"
action = "direct"
gain = "3 %/%"
[controllers.cascade.loops.flow]
measurement = "duty_flow"
output = "duty"
actions = "PI"
action = "reverse"
gain = "0.3 %/%"
integral_time = "6 s"
setpoint_high = "{high}"
"""
