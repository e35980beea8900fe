"""A design's numbers are rounded as they are read, and its loop does not notice."""

import math

import numpy as np
import pytest

from clepsydra import ClepsydraError
from clepsydra.base.rounding import rounded, rounded_matrix
from clepsydra.designs.gain_units import percent_gain
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.simc import design_simc
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS
from clepsydra.studies.trial import scores_of

SCHEDULED = "gain scheduling"


@pytest.mark.parametrize("value", [2.0 / 3.0, -1e-17 / 3.0, 123456.75, 1e300 / 3.0, 9.999999e-5])
@pytest.mark.parametrize("digits", [1, 6, 15])
def test_a_rounded_number_is_the_decimal_of_so_many_digits(value, digits):
    assert rounded(value, digits) == float(f"{value:.{digits - 1}e}")


@pytest.mark.parametrize("value", [0.0, math.inf, -math.inf])
def test_what_has_no_digits_stays(value):
    assert rounded(value, 6) == value


def test_what_is_nothing_beside_the_others_is_zero():
    matrix = np.array([[1.0, 1e-12], [1e-12, 1e-12]])
    assert rounded_matrix(matrix, 6, np.ones((2, 2))).tolist() == [[1.0, 0.0], [0.0, 0.0]]
    sizes = np.array([[1.0, 1e-6], [1e-6, 1e-12]])
    assert rounded_matrix(matrix, 6, sizes).tolist() == matrix.tolist()


@pytest.mark.parametrize("process", ["wet-well", "laboratory-four-tanks-nonminimum-phase"])
def test_what_is_read_of_a_loop_is_what_runs(process):
    """Six digits of K in %/% and of Ti in s are the whole number."""
    analysis = analyse(load_process(process))
    controller = design_simc(analysis.model, analysis.pairing)
    signal = analysis.operating_point.process.signal
    pairs = zip(controller.measurements, controller.manipulated, strict=True)
    for number, names in enumerate(pairs, start=1):
        gain = controller.values[f"proportional_gain_{number}"]
        percent = percent_gain(gain, *map(signal, names))
        assert percent == pytest.approx(float(f"{percent:.5e}"), rel=1e-14)
        time = controller.values[f"integral_time_{number}"]
        assert time == float(f"{time:.5e}")


@pytest.mark.thorough
@pytest.mark.parametrize("process", catalogue_names())
def test_no_loop_and_no_score_changes_by_a_thousandth(process, monkeypatch):
    """max|S|, errors and moves of the law as it is and as the design found it."""
    analysis = analyse(load_process(process))
    model = linearise(analysis.operating_point)
    scenario = default_scenario(analysis.model)

    def found(name):
        controller = DESIGNS[name](analysis)
        loop = sampled_loop(controller, with_outputs(analysis.model, controller.measurements))
        scores = scores_of(Loop(controller, model).run(scenario))
        judged = {key: v for key, v in scores.items() if key.startswith(("iae", "total_variation"))}
        return {"max|S|": loop.maximum_sensitivity, **judged}

    judged = []
    for name in DESIGNS:
        if name == "Start/stop levels" or SCHEDULED in name:
            continue
        try:
            judged.append((name, found(name)))
        except ClepsydraError:
            continue
    module = "clepsydra.designs.designed_values"
    monkeypatch.setattr(f"{module}.rounded", lambda value, digits, size=0.0: value)
    monkeypatch.setattr(f"{module}.rounded_matrix", lambda matrix, digits, sizes: matrix)
    largest = {key: max(numbers[key] for _, numbers in judged) for key in judged[0][1]}
    for name, numbers in judged:
        for key, exact in found(name).items():
            # What is a millionth of another controller's error is none.
            wanted = pytest.approx(exact, rel=1e-3, abs=1e-6 * largest[key])
            assert numbers[key] == wanted, f"{name}, {key}"
