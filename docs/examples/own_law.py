# How does a law of my own, P with a bias, compare with PI after a load step?
from pathlib import Path

import clepsydra as cl

plant = cl.load(cl.new_process("tank"))
law = cl.load_law(Path(__file__).with_name("laws") / "p_with_bias.py")
wires = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}
own = cl.design.own(plant, law, **wires, name="P with bias")
load = [cl.disturbance("inflow_1", to="2 cm^3/s", at="10 s")]
for controller in (own, cl.design.simc(plant)):
    level = cl.simulate(plant, controller, load, duration="10 min").to_pandas()["level_1"]
    print(f"{controller.title}: {1000 * (level.iloc[-1] - level.iloc[0]):.2f} mm off in the end")
