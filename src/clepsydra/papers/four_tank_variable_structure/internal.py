"""The non-minimum-phase trap: E is regular, the outputs are held, and a tank runs over.

The document speaks of its tanks in general and not of these valves, so that all here is remarked.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.internal_dynamics import internal_dynamics
from clepsydra.linear.relative_degree import relative_degree
from clepsydra.linear.zeros import zeros
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.papers.comparison import remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.rig import VOLTS_PER_METRE, plant
from clepsydra.papers.row import Row

VOLTS_PER_CENTIMETRE = VOLTS_PER_METRE / 100.0
#: The setpoint of h1 steps by half a centimetre.
STEP = 0.005
#: One so small that the upper tanks stay near to rest for minutes [m].
SMALL_STEP = 1e-5
BEFORE, DURATION = 30.0, 900.0
_TEXT = "E is non-singular; the internal dynamics are not spoken of"


def internal() -> Findings:
    """Look at the internal dynamics of P− and P+, and run P+ regardless."""
    rows = []
    for variant, sign in (("minimum-phase", "P−"), ("nonminimum-phase", "P+")):
        rows.append(_decoupled(_analysis(variant), sign))
    run, swapped = _regardless(STEP), _swapped()
    rows += _shown(run)
    return Findings(tuple(rows), (_figure(run, swapped),))


@cache
def _analysis(variant: str) -> Analysis:
    return analyse(plant(variant))


def _decoupled(analysis: Analysis, sign: str) -> Row:
    model = analysis.model
    determinant = float(np.linalg.det(relative_degree(model).at_point))
    found = internal_dynamics(model)
    shown = ", ".join(f"{zero.real:+.4f}" for zero in zeros(model))
    try:
        design_feedback_linearisation(model)
        said = "it is accepted"
    except NotApplicable as refusal:
        said = f"it is refused before any simulation: {refusal.reason}"
    return remark(
        "section 3",
        f"decoupling of {sign}",
        _TEXT,
        f"zeros {shown}",
        "rad/s",
        reason=f"The split of the flows only scales E, which is regular (determinant "
        f"{determinant / VOLTS_PER_CENTIMETRE**2:.3g} cm²/(V² s²) for levels in cm; "
        f"{determinant:.2g} 1/s² for outputs in volts at {VOLTS_PER_CENTIMETRE:g} V/cm); "
        "what the feedback hides are the transmission zeros, "
        f"{'all in the left half-plane' if found.stable else 'one in the right half-plane'}, and "
        f"{said}.",
    )


def _scenario(step: float) -> Scenario:
    point = _analysis("nonminimum-phase").operating_point
    process = point.process
    period = process.sampling_period
    samples = round(DURATION / period)
    rest = [point.as_dict()[name] for name in process.controlled]
    setpoints = np.tile(rest, (samples, 1))
    setpoints[round(BEFORE / period) :, 0] += VOLTS_PER_METRE * step
    none = np.zeros((samples, len(process.disturbances)))
    return Scenario(period, setpoints, none, np.zeros((samples, len(process.measurements))), (), 1)


def _run(controller: Controller, step: float) -> Run:
    return Loop(controller, _analysis("nonminimum-phase").model).run(_scenario(step))


def _regardless(step: float) -> Run:
    model = _analysis("nonminimum-phase").model
    controller = design_feedback_linearisation(model, despite_unstable_internal_dynamics=True)
    return _run(controller, step)


def _swapped() -> Run:
    analysis = _analysis("nonminimum-phase")
    return _run(design_simc(analysis.model, analysis.pairing), STEP)


def _shown(run: Run) -> list[Row]:
    process = run.process
    at_limit = [
        float(run.time[np.argmax((run.values[u.name] <= u.low) | (run.values[u.name] >= u.high))])
        for u in process.inputs
        if np.any((run.values[u.name] <= u.low) | (run.values[u.name] >= u.high))
    ]
    end = min(at_limit, default=float(run.time[-1]))
    # After the step has settled and before a pump saturates nothing is to be seen in the outputs.
    start = BEFORE + 100.0
    held = (run.time > start) & (run.time < end)
    errors = [
        float(np.max(np.abs(run.values[f"{y}.setpoint"] - run.values[y])[held]))
        for y in process.controlled
    ]
    growth = _growth(_regardless(SMALL_STEP))
    expected = float(zeros(_analysis("nonminimum-phase").model)[0].real)
    spilt = 1e6 * sum(float(run.values[f"tank_{j}.spilt"][-1]) for j in range(1, 5))
    last = [
        100.0 / VOLTS_PER_METRE * float(abs(run.values[f"{y}.setpoint"] - run.values[y])[-1])
        for y in process.controlled
    ]
    return [
        remark(
            "section 3",
            "outputs of P+ under (9) until a pump saturates",
            _TEXT,
            f"{100 * max(errors) / VOLTS_PER_METRE:.1e} cm for {end - start:.0f} s",
            reason="From 100 s after a step of h1 by half a centimetre until a pump is at its "
            "limit. Both lower levels stand at their setpoints, and a table of them shows nothing "
            "wrong.",
        ),
        remark(
            "section 3",
            "upper levels of P+ near rest",
            _TEXT,
            f"{growth:+.4f}",
            "1/s",
            reason="They run away at this rate after a step of a hundredth of a millimetre, as the "
            f"zero at {expected:+.4f} rad/s of the linear model says.",
        ),
        remark(
            "section 3",
            "outputs of P+ in the end",
            _TEXT,
            f"pump at its limit after {end - BEFORE:.0f} s, error {max(last):.1f} cm, "
            f"{spilt:.0f} cm³ spilt",
            reason="The same step of half a centimetre, 870 s after it. With a pump at its limit "
            "the outputs are lost as well.",
        ),
    ]


def _growth(run: Run) -> float:
    """Return the rate at which the upper levels run away while they are near to rest [1/s]."""
    level = run.values["tank_3.level"]
    away = np.abs(level / level[0] - 1.0)
    near = (run.time > BEFORE + 100.0) & (np.maximum.accumulate(away) < 0.01)
    # The slope grows alike, and knows nothing of where the levels would rest.
    slope = np.abs(np.gradient(level, run.time))[near]
    return float(np.polyfit(run.time[near], np.log(slope), 1)[0])


def _figure(run: Run, swapped: Run) -> Figure:
    every = slice(None, None, 10)

    def level(found: Run, tank: int) -> np.ndarray:
        return 100.0 * found.values[f"tank_{tank}.level"][every]

    time = run.time[every]
    panels = []
    for name, found in (
        ("decoupled by (9)", run),
        ("PI, other pairing", swapped),
    ):
        curves = [Curve(f"h{j}", time, level(found, j)) for j in range(1, 5)]
        panels.append(Panel(f"{name}: levels", "[cm]", tuple(curves)))
        voltages = [Curve(f"v{i}", time, found.values[f"pump_{i}"][every], "held") for i in (1, 2)]
        panels.append(Panel(f"{name}: pumps", "[V]", tuple(voltages)))
    return Figure(
        "",
        "P+ after a step of h1 by half a centimetre",
        tuple(panels),
        "The decoupled loop holds h1 and h2 exactly while h3 and h4 run away, until a pump "
        "stands at its limit and a tank runs over. PI controllers of the other pairing (SIMC, "
        "slowed down to a sensitivity peak of 2) make the same step, slowly.",
    )
