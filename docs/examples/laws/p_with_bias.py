# P control with a bias: gain [V/m], bias [V]
inputs, outputs = ["level.sp", "level.pv"], ["pump.out"]
parameters, state = {"gain": 200.0, "bias": 6.0}, {}


def step(state, inputs, parameters, time_step):
    error = inputs["level.sp"] - inputs["level.pv"]
    return {}, {"pump.out": parameters["bias"] + parameters["gain"] * error}
