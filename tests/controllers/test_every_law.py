"""What holds for the law of every design: its limits, finite states, changes of mode."""

from dataclasses import replace

import numpy as np
import pytest
from scan_rig import ScannedLaw, at_rest, designed

from clepsydra import Kernel, Signal
from clepsydra.studies.designs import DESIGNS

#: Where a design applies, if not to the quadruple tank.
APPLIES_TO = {
    "PI, arrest time": "wet-well",
    "PI, gain scheduling": "three-tanks",
    "PID, SIMC": "three-tanks",
    "PID, AMIGO": "three-tanks",
    "PID, Ziegler-Nichols": "three-tanks",
    "Smith predictor, LQ": "three-tanks",
    "Smith predictor, PI": "three-tanks",
    "Start/stop levels": "wet-well:start-stop",
}
#: Quick ones of different kinds, run in every round; all others with the thorough tests.
OFTEN = ("PI, SIMC", "LQI, Bryson", "2DOF polynomial, LQ", "Fuzzy PI")
EVERY = [
    pytest.param(name, marks=[] if name in OFTEN else [pytest.mark.thorough]) for name in DESIGNS
]
SCANS = 2_000
#: What a broken channel delivers.
BROKEN = (np.nan, np.inf, -np.inf, 1e301, -1e301, -0.0, 5e-324)


def held(random, mean, draw):
    """Values that stay for some scans each [scans]."""
    lengths = 1 + random.geometric(1.0 / mean, size=SCANS)
    return np.repeat(draw(SCANS), lengths)[:SCANS]


def whatever_comes(signal, random, period):
    """Values of an input: mostly what a plant shows, and now and then anything [scans]."""
    kind = signal.part
    if kind == "mode":
        modes = [1.0, 1.0, 1.0, 0.0, 2.0, 3.0, -1.0]
        return held(random, 20.0, lambda n: random.choice(modes, n))
    if kind == "good":
        return held(random, 20.0, lambda n: (random.random(n) < 0.9).astype(float))
    if signal.name == "time_step":
        steps = [period] * 40 + [0.5 * period, 3.7 * period, 0.0, -1.0, np.nan, np.inf, 1e301]
        return random.choice(steps, SCANS)
    low = signal.low if np.isfinite(signal.low) else -1.0
    high = signal.high if np.isfinite(signal.high) else low + 2.0
    beyond = 0.1 * (high - low)
    values = held(random, 10.0, lambda n: random.uniform(low - beyond, high + beyond, n))
    values += random.normal(scale=0.003 * (high - low), size=SCANS)
    spoilt = held(random, 5.0, lambda n: random.random(n)) < 0.02
    return np.where(spoilt, random.choice(BROKEN, SCANS), values)


def whatever_all_bring(program, random, period):
    """Values of all inputs; half of the time measurements are near their setpoints [scans]."""
    found = {signal.name: whatever_comes(signal, random, period) for signal in program.inputs}
    signals = {signal.name: signal for signal in program.inputs}
    for name, measured in found.items():
        asked = signals.get(name.removesuffix("pv") + "sp")
        if asked is not None and asked.name != name and asked.high == signals[name].high:
            near = held(random, 100.0, lambda n: random.random(n)) < 0.5
            measured[near] = found[asked.name][near]
    return found


def tuned(signal, random):
    """Values of a parameter that somebody changes; another limit would be another test."""
    value = signal.initial
    if "limit" in signal.name:
        return np.full(SCANS, value)
    if signal.kind != "real":
        low, high = max(signal.low, value - 2.0), min(signal.high, value + 2.0)
        return held(random, 100.0, lambda n: np.round(random.uniform(low, high, n)))
    return value * held(random, 100.0, lambda n: random.uniform(0.99, 1.01, n))


def recorded(program, inputs):
    """Outputs and states by the kernel, which gets parameters as inputs [scans, …]."""
    shown = tuple(Signal(f"{entry.name}.kept") for entry in program.state)
    block = replace(program.block, results=program.block.results + program.next_state)
    whole = replace(
        program,
        inputs=program.inputs + program.parameters,
        parameters=(),
        outputs=program.outputs + shown,
        block=block,
    )
    return Kernel(whole).run(SCANS, inputs=inputs).record_of(0)


def manipulated(controller):
    return [s for s in controller.law.outputs if s.part == "out"]


@pytest.mark.parametrize("name", EVERY)
def test_outputs_stay_within_limits_and_all_is_finite_whatever_comes_in(name):
    controller, plant = designed(name, APPLIES_TO.get(name, "quadruple-tank"))
    program, random = controller.program(), np.random.default_rng(3)
    inputs = whatever_all_bring(program, random, plant.process.sampling_period)
    inputs |= {signal.name: tuned(signal, random) for signal in program.parameters}
    found = recorded(program, inputs)
    assert np.isfinite(found).all()
    for signal, values in zip(program.outputs, found.T, strict=False):
        assert signal.low <= values.min() and values.max() <= signal.high, signal.name


@pytest.mark.parametrize("mode", ["manual", "tracking"])
@pytest.mark.parametrize("name", [p for p in EVERY if p.values[0] != "Start/stop levels"])
def test_automatic_goes_on_where_another_mode_left_the_output(name, mode):
    """At rest, a tenth of the range away; observers have settled to a thousandth by then."""
    controller, plant = designed(name, APPLIES_TO.get(name, "quadruple-tank"))
    law = ScannedLaw(controller, plant.process.sampling_period)
    at, outputs = plant.point.as_dict(), manipulated(controller)
    given = at_rest(controller, plant)
    for signal, variable in zip(outputs, controller.manipulated, strict=True):
        given[f"{variable}.{mode}"] = at[variable] + 0.1 * signal.span
        given[f"{variable}.mode"] = {"manual": 0, "tracking": 2}[mode]
    for _ in range(400):
        before = law.scan(**given)
    after = law.scan(**{key: 1 for key in given if key.endswith(".mode")})
    for signal in outputs:
        assert before[signal.name] == given[f"{signal.owner}.{mode}"]
        assert abs(after[signal.name] - before[signal.name]) <= 1e-3 * signal.span
