# Does a Smith predictor follow faster than PI where eight tanks in series act like dead time?
import clepsydra as cl

plant = cl.load("eight-tanks")
smith, pi = cl.design.smith_predictor(plant), cl.design.simc(plant)
print(smith)
step = [cl.step("level_8", "+10 cm", at="1 min")]
study = cl.study(plant, [smith, pi], step)
for candidate in study.ranking:
    scores = candidate.run.scores
    print(
        f"{candidate.controller.name}: IAE {scores['iae[level_8]'] / 60:.2f} m min, "
        f"max|S| {candidate.maximum_sensitivity:.2f}"
    )
