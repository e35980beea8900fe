"""Polynomial controllers and Smith predictors for models and for every catalogue process."""

import functools

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial_control import design_polynomial
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.smith_predictor import design_smith_predictor
from clepsydra.linear.analysis import analyse
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

PAIR = (("level", "pump"),)


# A tank that stands at 5 m, where as much flows out as in. Its outlet may let more out or
# less the higher it stands, so that it settles, integrates or runs away.
TANK = """
name = "tank"
sampling_period = "1 s"
controlled = ["level"]
manipulated = ["pump"]
elements = "elements.py"
[reservoirs.basin]
[tanks.tank_1]
area = "AREA m^2"
height = "20 m"
[lines.outlet]
source = "tank_1"
destination = "basin"
slope = "SLOPE m^2/s"
[flows.pump]
destination = "pipe"
range = ["0 m^3/s", "10 m^3/s"]
nominal = "5 m^3/s"
[delays.pipe]
destination = "tank_1"
time = "DELAY s"
[operating_point]
level = "5 m"
[sensors.level]
tank = "SHOWN"
range = ["0 m", "10 m"]
"""
#: A second tank, into which 1 m³/s flows for each metre of the first, and 5 m³/s out of it.
SECOND = """
[tanks.tank_2]
area = "5 m^2"
height = "20 m"
[followers.follower]
destination = "tank_2"
[lines.outlet_2]
source = "tank_2"
destination = "basin"
slope = "0 m^2/s"
"""
ELEMENTS = """
from dataclasses import dataclass
from clepsydra import Connection, Element, Flow, Outlet

class Line(Outlet):
    kind, table, quantities = "line", "lines", {"slope": "m^2/s"}

    def flow(self, level, gravity, slope):
        return 5.0 + slope * (level - 5.0)

@dataclass(frozen=True)
class Follower(Element):
    kind, table, keys = "follower", "followers", ("destination",)
    destination: str

    @classmethod
    def read(cls, name, table):
        return cls(name, table.name("destination", "the name of a tank"))

    def connections(self):
        return [Connection(("destination",), self.destination, "tank")]

    def flows(self, symbols, received):
        return [Flow("basin", self.destination, 1.0, symbols["tank_1.level"])]
"""


@pytest.fixture(scope="module")
def late_tank(tmp_path_factory):
    """Return the linear model of the tank: pole [1/s], dead time of its input [s], area [m²]."""
    folder = tmp_path_factory.mktemp("tank")
    (folder / "elements.py").write_text(ELEMENTS)

    @functools.cache
    def model(pole, delay, twice=False, area=5.0):
        text = TANK.replace("SLOPE", str(-area * pole)).replace("DELAY", str(delay))
        text = text.replace("SHOWN", "tank_2" if twice else "tank_1").replace("AREA", str(area))
        path = folder / f"tank_{pole}_{delay}_{twice}_{area}.toml"
        path.write_text(text + SECOND if twice else text)
        return cl.load(path).linear

    return model


def eigenvalues(controller, model):
    return np.linalg.eigvals(sampled_loop(controller, model).A)


def near(found, expected, tolerance=1e-6):
    """Each expected number is among those found."""
    return all(np.min(np.abs(found - value)) < tolerance for value in expected)


@pytest.mark.parametrize("delay", [0.0, 4.0, 4.5])
@pytest.mark.parametrize("pole", [-0.1, 0.0, 0.05])
def test_the_loop_has_the_poles_of_the_spectral_factor_and_those_assigned(
    single_tank, late_tank, delay, pole
):
    """Stable, integrating and unstable tanks, with dead time: the exact sampled loop tells."""
    model = late_tank(pole, delay) if delay else single_tank([[pole]], [0.2], [1.0])
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


def test_unstable_and_twice_integrating_processes_are_refused_by_the_predictor(late_tank):
    unstable = late_tank(0.05, 4.0)
    with pytest.raises(NotApplicable, match=r"unstable without control.*can hold it"):
        design_smith_predictor(unstable, PAIR)
    with pytest.raises(NotApplicable, match="integrates twice"):
        design_smith_predictor(late_tank(0.0, 4.0, twice=True), PAIR)
    tank = late_tank(-0.1, 4.0)
    for denominator in ((-1.1,), (-2.0, 1.0)):
        with refused(expected="stable model"):
            design_smith_predictor(tank, PAIR, models=[SampledModel((0.2,), denominator, 4, 1.0)])
    assert np.max(np.abs(eigenvalues(design_polynomial(unstable, PAIR), unstable))) < 1.0


@pytest.mark.parametrize("primary", ["polynomial", "PI"])
@pytest.mark.parametrize("pole", [-0.1, 0.0])
def test_predictors_are_robust_by_default(late_tank, primary, pole):
    model = late_tank(pole, 6.0)
    controller = design_smith_predictor(model, PAIR, primary=primary)
    assert sampled_loop(controller, model).maximum_sensitivity <= 2.0 + 1e-9
    assert ("level.error_feedback" in controller.values) == (pole == 0.0)


def test_a_pi_predictor_moves_its_input_over_its_room_at_a_tenth_of_the_range(late_tank):
    """5 m³/s for 1 m: the tank is so large that faster control would ask for more."""
    model = late_tank(-0.01, 2.0, area=50.0)
    controller = design_smith_predictor(model, PAIR, primary="PI")
    assert controller.values["level.setpoint_gain.1"] == pytest.approx(5.0)


@pytest.mark.thorough
def test_error_feedback_is_the_rule_of_matausek_and_micic(late_tank):
    """κ = 1/(2 k L) for k e^(−sL)/s: sampled so fast that holding it hardly counts."""
    slope, delay = 0.2, 40.0
    model = late_tank(0.0, delay)
    asked = {"penalty": 1e4, "assigned_poles": [0.99]}
    controller = design_smith_predictor(model, PAIR, **asked)
    assert controller.values["level.error_feedback"] == pytest.approx(
        1.0 / (2.0 * slope * (delay + 0.5)), rel=1e-3
    )


def test_a_predictor_is_the_polynomial_controller_where_b_is_one_coefficient(late_tank):
    """B(1) z^-1 = B: both loops have the same poles, but for those of the model."""
    model = late_tank(-0.1, 5.0)
    asked = {"penalty": 2.0, "assigned_poles": (0.7,)}
    predictor = eigenvalues(design_smith_predictor(model, PAIR, **asked), model)
    direct = eigenvalues(design_polynomial(model, PAIR, **asked), model)
    main = [p for p in direct if abs(p) > 0.05]
    assert len(main) == 2 and near(predictor, main)


@pytest.mark.parametrize(
    ("design", "wrong", "expected"),
    [
        (design_polynomial, {"penalty": 0.0}, "above 0"),
        (design_polynomial, {"penalty": "much"}, "above 0"),
        (design_polynomial, {"assigned_poles": [1.0]}, "below 1"),
        (design_polynomial, {"assigned_poles": [-0.5]}, "below 1"),
        (design_polynomial, {"models": []}, "one for each pair"),
        (design_polynomial, {"models": 5}, "a list of sampled models"),
        (design_polynomial, {"models": [SampledModel((1.0,), (-0.5,), 5, 2.0)]}, "period of 1 s"),
        (design_polynomial, {"models": ["a model"]}, "period of 1 s"),
        (
            design_polynomial,
            {"models": [SampledModel((1.0, -1.0), (-0.5,), 5, 1.0)]},
            "not zero",
        ),
        (design_smith_predictor, {"models": [SampledModel((0.2,), (), 5, 1.0)]}, "with a pole"),
        (design_smith_predictor, {"primary": "PID"}, "one of polynomial, PI"),
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
    ],
)
def test_what_is_asked_for_wrongly(late_tank, design, wrong, expected):
    with refused(expected=expected):
        design(late_tank(-0.1, 5.0), PAIR, **wrong)


def test_what_has_no_such_controller(single_tank, late_tank):
    near_tank = single_tank([[-0.1]], [0.2], [1.0])
    with pytest.raises(NotApplicable, match="nothing to predict"):
        design_smith_predictor(near_tank, PAIR)
    far = late_tank(-0.1, 30.0)
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
