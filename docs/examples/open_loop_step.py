# Where do the levels come to rest after a step of one pump, and how long does it take?
import clepsydra as cl

plant = cl.load("quadruple-tank")
run = cl.simulate(plant, None, [cl.step("pump_1", "+0.2 V", at="1 min")], duration="20 min")
levels = run.to_pandas()[["level_1", "level_2"]]
start, end = levels.iloc[0], levels.iloc[-1]
for name in levels:
    rise = (levels[name] - start[name]) / (end[name] - start[name])
    after = rise[rise > 0.63].index[0] - 60.0
    print(f"{name}: {start[name]:.2f} V to {end[name]:.2f} V, 63 % after {after:.0f} s")
print("V/V by the run: ", ((end - start) / 0.2).round(2).tolist())
print("V/V of the linear model:", cl.analyse(plant).static_gain[:, 0].round(2).tolist())
