"""A new design is one file: a rule that Clepsydra does not have, known everywhere once defined."""

import pytest
import refusals

import clepsydra as cl
from clepsydra.designs.design import DESIGNS, Studied, design
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.published_rule import PublishedRule
from clepsydra.designs.models.reaction_curve import reaction_curve
from clepsydra.studies.designs import studied_designs

METHOD = "Chien-Hrones-Reswick"
#: K·R·L, Ti/L and Td/L for a load step without overshoot, R the slope and L the delay of the
#: reaction curve.
TABLE = {"PI": (0.6, 4.0, 0.0), "PID": (0.95, 2.4, 0.42)}


def chien_hrones_reswick(model, pairing=None, *, form=None, detuning=1.0):
    """Design a PI or PID controller for each pair by the rules for loads.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input), or mapping, optional
    form : PidForm, optional
    detuning : float
        What the gains of the table are divided by.

    References
    ----------
    K. L. Chien, J. A. Hrones and J. B. Reswick, On the automatic control of generalized passive
    systems, Transactions of the ASME 74, 1952, 175-185.
    """

    def settings_of(loop, delay, actions):
        curve = reaction_curve(loop.element, delay)
        gain, integral, derivative = TABLE[actions]
        gain /= curve.slope * curve.delay * detuning
        return PidSettings(gain, integral * curve.delay, derivative * curve.delay), "its curve"

    rule = PublishedRule(METHOD, "Chien, Hrones and Reswick 1952", settings_of)
    return rule.designed(model, pairing, form, as_published=True)


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setattr(DESIGNS, "_things", {**dict(DESIGNS), **DESIGNS._things})
    declared = design(
        "chr",
        "PI or PID by Chien, Hrones and Reswick",
        Studied(65, "PI, Chien-Hrones-Reswick"),
        keys=(cl.Key("detuning", "1", "a factor", low=0.1, high=10.0, default=1.0),),
    )
    declared(chien_hrones_reswick)


@pytest.fixture
def basin():
    """Return a level that integrates, with half a sampling period, 30 s, of delay."""
    return cl.load("equalisation-tank")


def test_the_interface_has_it(registered, basin):
    assert "chr" in dir(cl.design)
    controller = cl.design.chr(basin, detuning="200 %")
    assert controller.values["level.integral_time"] == pytest.approx(4.0 * 30.0)
    half, whole = (
        each.values["level.proportional_gain"] for each in (controller, cl.design.chr(basin))
    )
    assert half == pytest.approx(whole / 2.0, rel=1e-5)
    assert cl.design.chr(basin, form=cl.PidForm("PID")).values[
        "level.derivative_time"
    ] == pytest.approx(0.42 * 30.0)


def test_a_study_tries_it_in_its_place(registered, basin):
    names = tuple(studied_designs())
    place = names.index("PI, Chien-Hrones-Reswick")
    assert names[place - 1 : place + 2 : 2] == ("PI, Ziegler-Nichols", "PI, Tyreus-Luyben")
    found = cl.study(basin, only="PI, Chien-Hrones-Reswick")
    assert METHOD in found.ranking[0].controller.design


@pytest.mark.parametrize(
    ("line", "refused"),
    [
        ("detuning = 2.0", ""),
        ("detuning = 20.0", "detuning"),
        ("detuning = 'much'", "detuning"),
        ("detunign = 2.0", "detunign"),
        ("experiment = 'step_response'", "experiment"),
    ],
)
def test_a_study_file_names_it_with_its_key(registered, tmp_path, line, refused):
    from clepsydra.studies.file.reader import read_study

    path = tmp_path / "study.toml"
    path.write_text(
        f'process = "equalisation-tank"\n[controllers.a]\ndesign = "chr"\n{line}\n', "utf-8"
    )
    if refused:
        with pytest.raises(cl.InputError) as error:
            read_study(path)
        assert refused in error.value.place and "line 4" in error.value.place
        return
    request = read_study(path)
    controller = request.controllers[0].make(request.analysis, request.analysis.model)
    assert controller.values["level.integral_time"] == pytest.approx(120.0)


def test_no_second_one_is_taken_by_its_name(registered):
    with pytest.raises(cl.InputError, match="no other one has"):
        design("chr", "another")(chien_hrones_reswick)


def test_it_checks_its_arguments_as_they_are_declared_and_refuses_in_its_own_name(
    registered, basin
):
    own = DESIGNS["chr"].function
    with refusals.refused(
        place="PI or PID by Chien, Hrones and Reswick, detuning",
        value=20.0,
        expected="a factor above 0.1, at most 10",
    ):
        own(basin.linear, detuning=20.0)
    with refusals.refused(place="PI or PID by Chien, Hrones and Reswick, form", value="PD"):
        own(basin.linear, form=cl.PidForm("PD"))
    four = cl.load("quadruple-tank").measured
    with pytest.raises(cl.NotApplicable) as caught:
        own(four, [("level_3", "pump_1")])
    assert caught.value.method == "PI or PID by Chien, Hrones and Reswick"
    assert caught.value.reason == "pump_1 does not move level_3"
