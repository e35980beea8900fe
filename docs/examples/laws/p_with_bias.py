# P control with a bias: gain [V/m], bias [V]
inputs, outputs = ["setpoint_1", "measurement_1"], ["manipulated_1"]
parameters, state = {"gain": 200.0, "bias": 3.0}, {}


def step(state, inputs, parameters, time_step):
    error = inputs["setpoint_1"] - inputs["measurement_1"]
    return {}, {"manipulated_1": parameters["bias"] + parameters["gain"] * error}
