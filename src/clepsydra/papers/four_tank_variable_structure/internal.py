"""The non-minimum-phase trap: E is regular, the outputs are held, and a tank runs over.

The document speaks of its tanks in general and not of these valves, so that no row judges it.
"""

from __future__ import annotations

from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.profile import Change
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_variable_structure.rig import VOLTS_PER_METRE, plant

#: The setpoint of h1 steps by half a centimetre.
STEP = 0.005
BEFORE, DURATION = 30.0, 900.0


def run() -> Found:
    """Return a picture of P+ after a step, decoupled and under PI of the other pairing."""
    analysis = analyse(plant("nonminimum-phase"))
    model, point = analysis.model, analysis.operating_point
    decoupled = design_feedback_linearisation(model, despite_unstable_internal_dynamics=True)
    swapped = design_simc(model, analysis.pairing)
    step = Change("level_1", point.as_dict()["level_1"] + VOLTS_PER_METRE * STEP, BEFORE, BEFORE)
    samples = round(DURATION / point.process.sampling_period)
    panels = []
    for name, controller in (("decoupled by (9)", decoupled), ("PI, other pairing", swapped)):
        run = Loop(controller, model).run(scenario_of_changes(point, [step], samples))
        levels = {f"h{j}": 100.0 * run.values[f"tank_{j}.level"][::10] for j in range(1, 5)}
        volts = {f"v{i}": run.values[f"pump_{i}"][::10] for i in (1, 2)}
        panels.append(Panel(f"{name}: levels", "[cm]", curves(run.time[::10], levels)))
        panels.append(Panel(f"{name}: pumps", "[V]", curves(run.time[::10], volts, "held")))
    yield Figure(
        "",
        "P+ after a step of h1 by half a centimetre",
        panels,
        "The decoupled loop holds h1 and h2 exactly while h3 and h4 run away, until a pump "
        "stands at its limit and a tank runs over. PI controllers of the other pairing (SIMC, "
        "slowed down to a sensitivity peak of 2) make the same step, slowly.",
    )
