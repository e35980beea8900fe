"""The order of models, from what their fits and tests say alone."""

import numpy as np
import pytest

from clepsydra import Signal
from clepsydra.identification.control_settings import ControlSettings
from clepsydra.identification.estimate import Estimate
from clepsydra.identification.fitted_model import FittedModel
from clepsydra.identification.ranking import ranked
from clepsydra.identification.residual_tests import ResidualTests

NOISE = np.random.default_rng(1).normal(0.0, 1.0, 60)
SETTINGS = ControlSettings(None, Signal("gain"), 1.0, 1.0)


def model(
    name, fit, *, parameters=3, gain=1.0, white=True, free=True, remarks=(), left=1.0, chance=0.0,
    fitted=None, settings=SETTINGS, beyond=90.0,
):  # fmt: skip
    """Return a model of some fit, so much better than the output alone."""
    return FittedModel(
        name=name, title=name, formula="",
        estimates=(Estimate(Signal("gain"), gain, gain - 0.1, gain + 0.1),),
        parameters=parameters, simulated=np.zeros(90), residuals=left * NOISE,
        tests=ResidualTests(0.5 if white else 0.001, 0.5 if free else 0.001, None),
        widening=1.0, fit=fit if fitted is None else fitted, validated=fit, beyond=beyond,
        chance=chance, settings=settings, remarks=remarks,
    )  # fmt: skip


ORDERS = {
    "simplest within a point": [model("A", 90.0, parameters=2), model("B", 90.9, parameters=4)],
    "better by more than a point": [model("A", 92.0, parameters=4), model("B", 90.0, parameters=2)],
    "residuals before simplicity": [
        model("A", 90.0, parameters=4), model("B", 90.5, parameters=2, free=False),
    ],
    "residuals not before a fit that is far better": [
        model("A", 95.0, free=False), model("B", 60.0, parameters=2),
    ],
    "colour is dynamics where more is explained and white": [
        model("A", 90.0, parameters=4), model("B", 90.5, white=False, left=1.5),
    ],
    "colour is chance where nothing more is explained": [
        model("A", 90.0, white=False), model("B", 90.0, parameters=4),
    ],
    "colour of a record of no white model": [
        model("A", 90.0, white=False), model("B", 90.5, parameters=4, white=False),
    ],
    "another sign": [model("A", 85.0, parameters=4), model("B", 84.9, parameters=2, gain=-1.0)],
    "another sign that passes less": [
        model("A", 85.0, parameters=4), model("B", 88.0, gain=-1.0, free=False),
    ],
    "a wrong sign behind a fit that is not told": [
        model("A", 99.5), model("B", 99.4, remarks=("not told",)), model("C", 70.0, gain=-1.0),
    ],
    "not told": [model("A", 85.0), model("B", 90.0, remarks=("not told",))],
    "not told, though far better": [model("A", 60.0), model("B", 95.0, remarks=("not told",))],
    "not told, though its residuals pass": [
        model("A", 90.0, parameters=4, free=False), model("B", 90.5, remarks=("not told",)),
    ],
    "the sign of what passes counts": [
        model("A", 85.0), model("B", 84.0, parameters=5, free=False),
        model("C", 88.0, parameters=2, gain=-1.0, free=False),
    ],
    "the worse of both parts": [model("A", 40.0), model("B", 41.0, fitted=12.0, parameters=1)],
    "chance": [model("A", 50.0, free=False), model("B", 95.0, chance=0.02)],
    "colour that the last third does not confirm": [
        model("A", 50.0), model("B", 95.0, white=False, beyond=5.0),
    ],
    "hardly better than a constant": [model("A", 30.0, free=False), model("B", 9.0, gain=2.0)],
    "an ARX model with colour": [
        model("A", 90.0, white=False), model("B", 90.0, parameters=2, white=False, settings=None),
    ],
}  # fmt: skip


@pytest.mark.parametrize("case", ORDERS)
def test_the_order(case):
    wanted = [each.name for each in ORDERS[case]]
    for models in (ORDERS[case], ORDERS[case][::-1]):
        assert [each.name for each in ranked(models)] == wanted


def test_without_a_model_of_use_the_first_has_a_doubt():
    found = ranked([model("A", 95.0, chance=0.5), model("B", 5.0)])
    assert [each.name for each in found] == ["A", "B"] and all(each.doubt for each in found)


def test_no_sign_is_told_by_an_interval_around_zero():
    unsure = model("A", 95.0, gain=0.05)
    assert unsure.sign == 0
    assert ranked([unsure])[0].doubt == "the record does not tell the sign of its gain"
