# %% What does a setpoint step look like with PI and with LQI? (cells for a notebook)
import matplotlib.pyplot as plt

import clepsydra as cl

plant = cl.load("quadruple-tank")
events = [cl.step("level_1", "+1 V", at="30 s")]
# %% Both runs
runs = {
    c.title: cl.simulate(plant, c, events, duration="4 min")
    for c in (cl.design.simc(plant), cl.design.lqi(plant))
}
# %% All signals of one
runs["PI, SIMC"].plot().savefig("pi.png")
# %% One signal of both
figure, axes = plt.subplots()
for name, run in runs.items():
    run.to_pandas()["level_1"].plot(ax=axes, label=name, xlabel="time [s]", ylabel="level_1 [V]")
axes.legend()
figure.savefig("both.png")
print({name: float(run.to_pandas()["level_1"].max().round(2)) for name, run in runs.items()})
