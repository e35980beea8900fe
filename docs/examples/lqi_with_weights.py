# What does LQI do when an error of level_1 is to cost more than one of level_2?
import clepsydra as cl

plant = cl.load("quadruple-tank")
even = cl.design.lqi(plant, maximum_errors={"level_1": "5 %", "level_2": "5 %"})
uneven = cl.design.lqi(plant, maximum_errors={"level_1": "1 %", "level_2": "20 %"})
events = [cl.disturbance("inflow_1", "+10 %", at="10 s"), cl.disturbance("inflow_2", "+10 %")]
for name, controller in {"even": even, "uneven": uneven}.items():
    scores = cl.simulate(plant, controller, events).scores
    print(name, {level: round(scores[f"iae[{level}]"], 2) for level in ("level_1", "level_2")})
print(uneven)
