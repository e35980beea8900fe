# %% What does a setpoint step look like with PI and with LQI? (cells for a notebook)
import pandas as pd

import clepsydra as cl

plant = cl.load("quadruple-tank")
event = cl.step("level_1", "+1 V", at="30 s")
controllers = {"PI": cl.design.simc(plant), "LQI": cl.design.lqi(plant)}
runs = {n: cl.simulate(plant, c, [event], duration="4 min") for n, c in controllers.items()}
# %% All signals of one
runs["PI"].plot().savefig("pi.png")
# %% One signal of both
both = pd.DataFrame({name: run.to_pandas()["level_1"] for name, run in runs.items()})
both.plot(xlabel="time [s]", ylabel="level_1 [V]").figure.savefig("both.png")
print(both.max().round(2).to_dict())
