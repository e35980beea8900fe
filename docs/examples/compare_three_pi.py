# Which of three PI controllers follows the setpoints of the quadruple tank best?
import clepsydra as cl

plant = cl.load("quadruple-tank")
calm = cl.design.simc(plant, closed_loop_time_constant="60 s").named("calm")
usual = cl.design.simc(plant).named("usual")
bold = usual.with_values({"level_1": {"K": 6.0}, "level_2": {"K": 6.0}}, name="bold")
events = [cl.step("level_1", "+1 V", at="10 s"), cl.step("level_2", "+1 V", at="5 min")]
study = cl.study(plant, [calm, usual, bold], events, duration="10 min")
for candidate in study.ranking:
    iae = candidate.run.scores["iae[level_1]"]
    peak = candidate.maximum_sensitivity
    print(f"{candidate.controller.name:6} IAE of level_1 {iae:5.1f} V s, max|S| {peak:.2f}")
