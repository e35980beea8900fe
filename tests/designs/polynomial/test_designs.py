"""Polynomial controllers and Smith predictors for models and for every catalogue process."""

import dataclasses

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError, NotApplicable
from clepsydra.designs.polynomial.polynomial_control import design_polynomial
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.smith_predictor import design_smith_predictor
from clepsydra.linear.analysis import analyse
from clepsydra.linear.internal_delays import InternalDelays
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

PAIR = (("level", "pump"),)


def with_input_delay(model, time):
    """The same model, its input late by a dead time [s]."""
    n = len(model.A)
    late = InternalDelays(
        times=np.array([time]),
        to_states=np.array(model.B),
        to_outputs=np.zeros((1, 1)),
        from_states=np.zeros((1, n)),
        from_inputs=np.ones((1, 1)),
        through=np.zeros((1, 1)),
        from_disturbances=np.zeros((1, 0)),
    )
    return dataclasses.replace(model, B=np.zeros_like(model.B), delays=late)


def eigenvalues(controller, model):
    return np.linalg.eigvals(sampled_loop(controller, model).A)


def near(found, expected, tolerance=1e-6):
    """Each expected number is among those found."""
    return all(np.min(np.abs(found - value)) < tolerance for value in expected)


@pytest.mark.parametrize("delay", [0.0, 4.0, 4.5])
@pytest.mark.parametrize("pole", [-0.1, 0.0, 0.05])
def test_the_loop_has_the_poles_of_the_spectral_factor_and_those_assigned(single_tank, delay, pole):
    """Stable, integrating and unstable tanks, with dead time: the exact sampled loop tells."""
    model = single_tank([[pole]], [0.2], [1.0])
    if delay:
        model = with_input_delay(model, delay)
    penalty, assigned = 3.0, (0.6, 0.3)
    controller = design_polynomial(model, PAIR, penalty=penalty, assigned_poles=assigned)
    found = eigenvalues(controller, model)
    assert near(found, assigned)
    # The regulator for the same penalty, by the roots of the whole polynomial.
    late = delay - int(delay)
    phi = np.exp(pole)

    def integral(length):
        return 0.2 * (np.expm1(pole * length) / pole if pole else length)

    numerator = [0.0, integral(1.0)]
    if late:
        numerator = [0.0, integral(1.0 - late), np.exp(pole * (1.0 - late)) * integral(late)]
    A, B = np.zeros(len(numerator)), np.array(numerator)
    A[:2] = 1.0, -phi
    roots = np.roots(penalty * np.convolve(A, A[::-1]) + np.convolve(B, B[::-1]))
    stable = roots[(np.abs(roots) > 0.1) & (np.abs(roots) < 1.0)]
    assert len(stable) == 1
    assert near(found, stable)
    others = [p for p in found if not near(np.array([*assigned, *stable]), [p])]
    # Those of the delay, at the origin: n equal ones come out as a ring of the size 1e-15^(1/n).
    assert np.max(np.abs(others), initial=0.0) < 3.0 * 1e-15 ** (1.0 / max(len(others), 1))


def test_unstable_and_twice_integrating_processes_are_refused_by_the_predictor(single_tank):
    unstable = with_input_delay(single_tank([[0.05]], [0.2], [1.0]), 4.0)
    with pytest.raises(NotApplicable, match=r"unstable without control.*can hold it"):
        design_smith_predictor(unstable, PAIR)
    with pytest.raises(NotApplicable, match="integrates twice"):
        design_smith_predictor(
            with_input_delay(single_tank([[0.0, 1.0], [0.0, 0.0]], [0.0, 0.2], [1.0, 0.0]), 4.0),
            PAIR,
        )
    tank = with_input_delay(single_tank([[-0.1]], [0.2], [1.0]), 4.0)
    for denominator in ((-1.1,), (-2.0, 1.0)):
        with refused(expected="stable model"):
            design_smith_predictor(tank, PAIR, models=[SampledModel((0.2,), denominator, 4, 1.0)])
    assert np.max(np.abs(eigenvalues(design_polynomial(unstable, PAIR), unstable))) < 1.0


@pytest.mark.parametrize("primary", ["polynomial", "PI"])
@pytest.mark.parametrize("pole", [-0.1, 0.0])
def test_predictors_are_robust_by_default(single_tank, primary, pole):
    model = with_input_delay(single_tank([[pole]], [0.2], [1.0]), 6.0)
    controller = design_smith_predictor(model, PAIR, primary=primary)
    assert sampled_loop(controller, model).maximum_sensitivity <= 2.0 + 1e-9
    assert ("error_feedback_1" in controller.values) == (pole == 0.0)


@pytest.mark.thorough
def test_error_feedback_is_the_rule_of_matausek_and_micic(single_tank):
    """κ = 1/(2 k L) for k e^(−sL)/s: sampled so fast that holding it hardly counts."""
    slope, delay = 0.2, 40.0
    model = with_input_delay(single_tank([[0.0]], [slope], [1.0]), delay)
    asked = {"penalty": 1e4, "assigned_poles": [0.99]}
    controller = design_smith_predictor(model, PAIR, **asked)
    assert controller.values["error_feedback_1"] == pytest.approx(
        1.0 / (2.0 * slope * (delay + 0.5)), rel=1e-3
    )


def test_a_predictor_is_the_polynomial_controller_where_b_is_one_coefficient(single_tank):
    """B(1) z^-1 = B: both loops have the same poles, but for those of the model."""
    model = with_input_delay(single_tank([[-0.1]], [0.2], [1.0]), 5.0)
    asked = {"penalty": 2.0, "assigned_poles": (0.7,)}
    predictor = eigenvalues(design_smith_predictor(model, PAIR, **asked), model)
    direct = eigenvalues(design_polynomial(model, PAIR, **asked), model)
    main = [p for p in direct if abs(p) > 0.05]
    assert len(main) == 2 and near(predictor, main)


def test_what_is_asked_for_wrongly(single_tank):
    model = with_input_delay(single_tank([[-0.1]], [0.2], [1.0]), 5.0)
    for design, wrong, words in (
        (design_polynomial, {"penalty": 0.0}, "above 0"),
        (design_polynomial, {"penalty": "much"}, "above 0"),
        (design_polynomial, {"assigned_poles": [1.0]}, "below 1"),
        (design_polynomial, {"assigned_poles": [-0.5]}, "below 1"),
        (design_polynomial, {"models": []}, "one for each pair"),
        (design_polynomial, {"models": [SampledModel((1.0,), (-0.5,), 5, 2.0)]}, "period of 1 s"),
        (design_polynomial, {"models": ["a model"]}, "period of 1 s"),
        (
            design_polynomial,
            {"models": [SampledModel((1.0, -1.0), (-0.5,), 5, 1.0)]},
            r"level by pump, 2DOF controller, B\(1\)",
        ),
        (design_smith_predictor, {"primary": "PID"}, "polynomial or PI"),
        (design_smith_predictor, {"primary": "PI", "penalty": 1.0}, "none for a PI controller"),
        (
            design_smith_predictor,
            {"closed_loop_time_constant": 5.0},
            "none for a polynomial controller",
        ),
        (
            design_smith_predictor,
            {"primary": "PI", "closed_loop_time_constant": -5.0},
            "above 0 s",
        ),
    ):
        with pytest.raises(InputError, match=words):
            design(model, PAIR, **wrong)


def test_what_has_no_such_controller(single_tank):
    near_tank = single_tank([[-0.1]], [0.2], [1.0])
    with pytest.raises(NotApplicable, match="nothing to predict"):
        design_smith_predictor(near_tank, PAIR)
    far = with_input_delay(near_tank, 30.0)
    with pytest.raises(NotApplicable, match=r"30 samples.*ring"):
        design_polynomial(far, PAIR)
    assert design_smith_predictor(far, PAIR).law.state[1].length == 30
    with pytest.raises(NotApplicable, match="unstable at q_u"):
        design_smith_predictor(
            far, PAIR, penalty=1e-4, models=[SampledModel((0.19,), (-0.905,), 18, 1.0)]
        )


@pytest.mark.sampled
@pytest.mark.parametrize("name", catalogue_names())
def test_every_process_of_the_catalogue_has_them_or_is_told_why(name):
    analysis = analyse(load_process(name))
    controller = design_polynomial(analysis.model, analysis.pairing)
    assert sampled_loop(controller, analysis.model).maximum_sensitivity <= 2.0 + 1e-6
    for primary in ("polynomial", "PI"):
        try:
            controller = design_smith_predictor(analysis.model, analysis.pairing, primary=primary)
        except NotApplicable as refusal:
            assert "nothing to predict" in refusal.reason
            assert name not in ("eight-tanks", "three-tanks")
        else:
            assert sampled_loop(controller, analysis.model).maximum_sensitivity <= 2.0 + 1e-6
