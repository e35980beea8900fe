# How does a law of my own, P with a bias, compare with PI after a load step?
from pathlib import Path

import clepsydra as cl

Path("p_with_bias.py").write_text("""
# gain [V/m], bias [V]
inputs, outputs = ["setpoint_1", "measurement_1"], ["manipulated_1"]
parameters, state = {"gain": 200.0, "bias": 3.0}, {}
def step(state, inputs, parameters, time_step):
    error = inputs["setpoint_1"] - inputs["measurement_1"]
    return {}, {"manipulated_1": parameters["bias"] + parameters["gain"] * error}
""")
plant = cl.load(cl.new_process("tank"))
wires = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}
own = cl.design.own(plant, cl.load_law("p_with_bias.py"), **wires, name="P with bias")
load = [cl.disturbance("inflow_1", to="2 cm^3/s", at="10 s")]
for controller in (own, cl.design.simc(plant)):
    level = cl.simulate(plant, controller, load, duration="10 min").to_pandas()["level_1"]
    print(f"{controller.title}: {1000 * (level.iloc[-1] - level.iloc[0]):.2f} mm off in the end")
