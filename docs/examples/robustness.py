# Does a controller still do well when the tanks are wider or narrower than was thought?
import clepsydra as cl

plant, score = cl.load("quadruple-tank"), "iae[level_1]"
tanks = {"default": "0 %", "tank_1.area": "20 %", "tank_2.area": {"same_as": "tank_1.area"}}
events = [cl.step("level_1", "+1 V", at="10 s")]
controller = cl.design.simc(plant)
found = cl.robustness(
    controller, plant, events, duration="5 min", draws=200, uncertainty=tanks, sensitivity=False
)
worst = found.worst(score)
wide = found.values(worst.draw)["tank_1.area"] / found.values(0)["tank_1.area"]
print(f"on paper: IAE {found.nominal[score]:.2f} V s; on 95 % of the plants at most")
print(f"{found.quantile(score).value:.2f} V s; in draw {worst.draw}, tanks x {wide:.3f},")
print(f"{worst.value:.2f} V s, and run again {found.run(worst.draw).scores[score]:.2f} V s")
