"""What holds for the law of every design: its limits, finite states, changes of mode."""

from functools import cache

import numpy as np
import pytest
from scan_rig import ScannedLaw, at_rest

from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process
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


@cache
def analysed(process):
    return analyse(load_process(process))


@cache
def designed(name):
    analysis = analysed(APPLIES_TO.get(name, "quadruple-tank"))
    return DESIGNS[name](analysis), analysis.model


def manipulated(controller):
    return [s for s in controller.law.outputs if s.name.startswith("manipulated_")]


@pytest.mark.parametrize("name", EVERY)
def test_outputs_stay_within_limits_and_all_is_finite_whatever_comes_in(name):
    controller, model = designed(name)
    program = controller.program()
    inputs = random_scans(program, SCANS, 3, model.point.process.sampling_period)
    for key in inputs:
        if "limit" in key:  # what is tuned by chance would be another limit
            inputs[key] = np.full(SCANS, np.nan)
    found = engine_run(program, inputs)
    assert np.isfinite(found).all()
    for signal, values in zip(program.outputs, found.T, strict=False):
        assert signal.low <= values.min() and values.max() <= signal.high, signal.name


@pytest.mark.parametrize("mode", ["manual", "tracking"])
@pytest.mark.parametrize("name", [p for p in EVERY if p.values[0] != "Start/stop levels"])
def test_automatic_goes_on_where_another_mode_left_the_output(name, mode):
    """At rest, a tenth of the range away; observers have settled to a thousandth by then."""
    controller, model = designed(name)
    law = ScannedLaw(controller, model.point.process.sampling_period)
    at, outputs = model.point.as_dict(), manipulated(controller)
    given = at_rest(controller, model)
    for number, (signal, variable) in enumerate(
        zip(outputs, controller.manipulated, strict=True), start=1
    ):
        given[f"{mode}_{number}"] = at[variable] + 0.1 * signal.span
        given[f"mode_{number}"] = {"manual": 0, "tracking": 2}[mode]
    for _ in range(400):
        before = law.scan(**given)
    after = law.scan(**{key: 1 for key in given if key.startswith("mode_")})
    for number, signal in enumerate(outputs, start=1):
        assert before[signal.name] == given[f"{mode}_{number}"]
        assert abs(after[signal.name] - before[signal.name]) <= 1e-3 * signal.span
