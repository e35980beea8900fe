# How fast can a PI loop be if a step may overshoot by 5 % and no more?
import clepsydra as cl

plant = cl.load("quadruple-tank")
start = cl.design.simc(plant, closed_loop_time_constant="30 s")
step = [cl.step("level_1", "+0.5 V", at="10 s")]
limits = {"overshoot": "5 %", "max|S|": 1.6}
best = cl.tune(start, plant, goal="iae[level_1]", limits=limits, events=step, duration="3 min")
before, after = (cl.simulate(plant, c, step, duration="3 min") for c in (start, best))
level = after.to_pandas()["level_1"]
overshoot = 100.0 * (level.max() - level.iloc[0] - 0.5) / 0.5
print(best)
print(f"IAE {before.scores['iae[level_1]']:.2f} V s, tuned {after.scores['iae[level_1]']:.2f} V s")
print(f"overshoot {overshoot:.1f} %")
