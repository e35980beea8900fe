"""A Mamdani controller: 27 rules, three outputs on 101 points, beside scikit-fuzzy.

The averaging tank's controller of M. Kolankowski and R. Piotrowski (2022), section 3.3. An
evaluation takes four crisp inputs, each different, to three centroids. Clepsydra's whole law adds
two derivatives, dead zones, modes, limits and status words.

Two pairs of routes must agree: the kernel's sums with those of plain Python, rule by rule; and the
centroid of scikit-fuzzy, which joins the points by straight lines, with that of such lines here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.experiments import AGREEMENT, Disagreement
from benchmarks.measure import Spread, Way, interleave, on_one_core
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.fuzzy.file import WiredFuzzy, load_fuzzy
from clepsydra.controllers.fuzzy.inference import rule_base
from clepsydra.controllers.fuzzy.rule import firing
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.engine.kernel import Job, Kernel
from clepsydra.papers.averaging_tank.fuzzy import RULES
from clepsydra.process.reader import load_process
from clepsydra.program.reader import program_of
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

SCENARIOS, SAMPLES = 1024, 1000
#: Evaluations that are compared, and that scikit-fuzzy is timed on.
FEW = 20


@dataclass(frozen=True)
class FuzzyTimes:
    """What was measured on one core.

    Parameters
    ----------
    inference : Spread
        Crisp inputs to three centroids in a batch [s an evaluation].
    law : Spread
        The whole step law in a batch [s a sample].
    scikit_fuzzy : Spread or None
        [s an evaluation]; None where it is not installed.
    difference : float
        Largest between the kernel and plain Python, as a share of an output's range.
    scikit_difference : float or None
        The same of scikit-fuzzy.
    """

    inference: Spread
    law: Spread
    scikit_fuzzy: Spread | None
    difference: float
    scikit_difference: float | None


def measure(rounds: int) -> FuzzyTimes:
    """Check that all ways agree, then time them.

    Raises
    ------
    Disagreement
    """
    system = load_fuzzy(RULES).system
    random = np.random.Generator(np.random.PCG64(20240229))
    inputs = {
        v.name: np.sign(x) * x**2
        for v in system.inputs
        for x in [random.uniform(-1.0, 1.0, (SCENARIOS, SAMPLES))]
    }
    few = [{name: float(column[k, 0]) for name, column in inputs.items()} for k in range(FEW)]
    expected = [_heights(system, values) for values in few]
    with on_one_core():
        kernel = Kernel(program_of(_law(system)), individual=tuple(inputs))
        job = kernel.prepare(SAMPLES, inputs=inputs)
        run = job.run()
        difference = max(
            abs(run.output(u.name)[k, 0] - _sums(u, heights[u.name], system.points_of(u)))
            / (u.high - u.low)
            for u in system.outputs
            for k, heights in enumerate(expected)
        )
        if not difference <= AGREEMENT:
            raise Disagreement(f"fuzzy: the kernel differs from plain Python by {difference:.1e}")
        ways = [Way("inference", job.run), Way("law", _whole_law(inputs).run)]
        scikit = _scikit_fuzzy(system)
        scikit_difference = None
        if scikit is not None:
            scikit_difference = max(
                abs(scikit(values)[u.name] - _lines(u, heights[u.name], system.points_of(u)))
                / (u.high - u.low)
                for u in system.outputs
                for values, heights in zip(few, expected, strict=True)
            )
            if not scikit_difference <= AGREEMENT:
                raise Disagreement(f"fuzzy: scikit-fuzzy differs by {scikit_difference:.1e}")
            ways.append(Way("scikit-fuzzy", lambda: [scikit(values) for values in few]))
        timings = interleave(ways, rounds)
    evaluations = SCENARIOS * SAMPLES
    return FuzzyTimes(
        timings.of("inference").times(1.0 / evaluations),
        timings.of("law").times(1.0 / evaluations),
        None if scikit is None else timings.of("scikit-fuzzy").times(1.0 / FEW),
        difference,
        scikit_difference,
    )


def _law(system: FuzzySystem) -> StepLaw:
    names, rules = [variable.name for variable in system.inputs], rule_base(system, "rules")

    def equations(s: Symbols) -> Equations:
        found = rules("inference", s, {}).outputs
        return Equations({}, {u.name: found[path(u.name, "centroid")] for u in system.outputs})

    return step_law(
        "inference",
        inputs=[Signal(name) for name in names],
        parameters=[],
        state=[],
        outputs=[Signal(output.name) for output in system.outputs],
        equations=equations,
    )


def _whole_law(inputs: dict[str, np.ndarray]) -> Job:
    """Return a batch of the whole step law; measurements differ, the rest is at its nominal."""
    process = load_process("averaging-tank:all-inputs")
    wired = WiredFuzzy(load_fuzzy(RULES), process)
    program = program_of(wired.law)
    concentration, volume = 5000.0 + 20.0 * inputs["e_C"], 2.0 + 0.02 * inputs["e_V"]
    kernel = Kernel(program, individual=("concentration.pv", "volume.pv"), record=False)
    values = {"concentration": concentration, "volume": volume}
    setpoints = {"concentration": 5000.0, "volume": 2.0}
    return kernel.prepare(
        SAMPLES,
        inputs={path(name, "pv"): values[name] for name in wired.measurements}
        | {path(name, "sp"): setpoints[name] for name in wired.setpoints}
        | {"time_step": 0.1},
        parameters=wired.values,
    )


def _heights(system: FuzzySystem, values: dict[str, float]) -> dict[str, dict[str, float]]:
    degrees = {
        (v.name, name): float(d)
        for v in system.inputs
        for name, d in v.degrees(values[v.name]).items()
    }
    found: dict[str, dict[str, float]] = {output.name: {} for output in system.outputs}
    for rule in system.rules:
        fired = firing(rule.condition, degrees, min, max)
        for each in rule.conclusions:
            known = found[each.variable]
            known[each.set] = max(known.get(each.set, 0.0), fired)
    return found


def _sums(u: LinguisticVariable, heights: dict[str, float], points: np.ndarray) -> float:
    clipped = [np.minimum(height, u.sets[name].degrees(points)) for name, height in heights.items()]
    degrees = np.max(clipped, axis=0)
    return float(points @ degrees / degrees.sum())


def _lines(u: LinguisticVariable, heights: dict[str, float], points: np.ndarray) -> float:
    """Return the centroid of what lies below straight lines from point to point.

    As in scikit-fuzzy the sets are straight between the points, and where a set meets its height
    there is one more point.
    """
    tables = {name: u.sets[name].degrees(points) for name in heights}
    places = [points]
    for name, height in heights.items():
        above = tables[name] - height
        k = np.flatnonzero(above[:-1] * above[1:] < 0.0)
        places.append(
            points[k] + above[k] / (above[k] - above[k + 1]) * (points[k + 1] - points[k])
        )
    x = np.unique(np.concatenate(places))
    y = np.max([np.minimum(h, np.interp(x, points, tables[n])) for n, h in heights.items()], axis=0)
    width, left, right = np.diff(x), y[:-1], y[1:]
    area = width * (left + right) / 2
    moment = width * (x[:-1] * (2 * left + right) + x[1:] * (left + 2 * right)) / 6
    return float(moment.sum() / area.sum())


def _scikit_fuzzy(
    system: FuzzySystem,
) -> Callable[[dict[str, float]], dict[str, float]] | None:
    """Return an evaluation as a user of scikit-fuzzy would write it, or None without it."""
    try:
        from skfuzzy import control
    except ModuleNotFoundError:
        return None
    inputs = {}
    for v in system.inputs:
        # Its sets are tables over these points: the corners make them exact.
        points = np.union1d(np.linspace(v.low, v.high, 101), v.samples)
        inputs[v.name] = control.Antecedent(points, v.name)
    outputs = {
        u.name: control.Consequent(system.points_of(u), u.name, defuzzify_method="centroid")
        for u in system.outputs
    }
    for variable in (*system.inputs, *system.outputs):
        its = inputs.get(variable.name) or outputs[variable.name]
        for name, member in variable.sets.items():
            its[name] = member.degrees(its.universe)
    rules = []
    for rule in system.rules:
        degrees = {(v.name, name): inputs[v.name][name] for v in system.inputs for name in v.sets}
        condition = firing(rule.condition, degrees, lambda a, b: a & b, lambda a, b: a | b)
        rules.append(
            control.Rule(condition, [outputs[c.variable][c.set] for c in rule.conclusions])
        )
    simulation = control.ControlSystemSimulation(control.ControlSystem(rules), cache=False)

    def evaluate(values: dict[str, float]) -> dict[str, float]:
        simulation.inputs(values)
        simulation.compute()
        return {name: float(simulation.output[name]) for name in outputs}

    return evaluate
