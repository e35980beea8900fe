# Does a PI loop closed in python-control overshoot as the simulation says?
import control as ct

import clepsydra as cl

plant = cl.load(cl.new_process("tank"))
pi = cl.design.simc(plant)
tank = plant.linear.select(outputs=["level_1"], inputs=["pump_1"]).to_control()  # SI: m by V
gain, time = (pi.values[f"level_1.{name}"] for name in ("proportional_gain", "integral_time"))  # SI
loop = ct.feedback(gain * ct.tf([time, 1.0], [time, 0.0]) * ct.ss2tf(tank)[0, 0])
run = cl.simulate(plant, pi, [cl.step("level_1", "+1 cm", at="10 s")], duration="3 min")
level = run.to_pandas()["level_1"]
print("poles", loop.poles().round(3), "1/s")
print(f"overshoot {ct.step_info(loop)['Overshoot']:.1f} % in python-control")
print(f"overshoot {100 * (level.max() - level.iloc[0] - 0.01) / 0.01:.1f} % simulated, sampled")
