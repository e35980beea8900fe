# Does a controller still do well when the tanks are wider or narrower than was thought?
import clepsydra as cl

plant = cl.load("quadruple-tank")
controller = cl.design.simc(plant)
events = [cl.step("level_1", "+1 V", at="10 s")]
for factor in (0.8, 1.0, 1.25):
    values = {f"tank_{i}.area": f"{factor * area} cm^2" for i, area in enumerate((28, 32), 1)}
    changed = plant.with_values(values)
    run = cl.simulate(changed, controller, events, duration="5 min")
    peak = cl.margins(controller, changed)["max|S|"].max()
    print(f"areas x {factor}: IAE {run.scores['iae[level_1]']:.1f} V s, max|S| {peak:.2f}")
