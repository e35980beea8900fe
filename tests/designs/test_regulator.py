"""Regulators designed elsewhere: the same numbers by other routes, and bad ones refused."""

import random
from io import BytesIO

import control
import numpy as np
import pytest
from refusals import refused
from scipy import signal, sparse
from scipy.io import savemat

import clepsydra as cl

#: Integrals of both errors and a lag of the first, coupled: [V] from [V].
A = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.02, -0.2]])
B = np.array([[0.1, 0.0], [0.0, 0.0675], [0.05, 0.0]])
C = np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.0]])
D = np.array([[3.0, 0.0], [0.1, 2.7]])
MATRICES = {"A": A, "B": B, "C": C, "D": D}
FOUR = (A, B, C, D)
PI = (0.0, 0.1, 1.0, 3.0)
ONE = {"measurements": ["level_1"], "manipulated": ["pump_1"]}


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


def outputs(controller, errors, manual=()):
    """Return what the law asks for [samples, m] after errors r − y [samples, p], SI."""
    law = controller.law
    state = [controller.initial_state[entry.name] for entry in law.state]
    values = [controller.values[entry.name] for entry in law.parameters]
    found = []
    for sample, error in enumerate(errors):
        given = dict(zip((f"{name}.sp" for name in controller.setpoints), error, strict=True))
        usual = {"mode": 0 if sample in manual else 1, "good": 1, "manual": 5.0, "time_step": 1}
        inputs = [given.get(each.name, usual.get(each.part, 0.0)) for each in law.inputs]
        state, out, _ = law.function(state, inputs, values)
        state = np.array(state).ravel().tolist()
        named = dict(zip((each.name for each in law.outputs), np.array(out).ravel(), strict=True))
        found.append([float(named[f"{name}.out"]) for name in controller.manipulated])
    return np.array(found)


def by_scipy(errors, period=1.0):
    """Return C x + D e of the regulator, sampled by SciPy's bilinear rule."""
    a, b, c, d, _ = signal.cont2discrete(FOUR, period, method="bilinear")
    state, found = np.zeros(len(a)), []
    for error in errors:
        found.append(c @ state + d @ error)
        state = a @ state + b @ error
    return np.array(found)


@pytest.mark.parametrize("anti_windup", ["conditioning", "none"])
def test_away_from_limits_it_is_the_regulator_by_tustins_rule(plant, anti_windup):
    errors = 0.1 * np.random.default_rng(0).normal(size=(200, 2))
    found = outputs(cl.design.regulator(plant, FOUR, anti_windup=anti_windup), errors)
    # Nine digits a number of the law, two hundred samples of two integrals.
    assert found == pytest.approx(3.0 + by_scipy(errors), abs=2e-6)


def test_every_way_to_give_it_is_one(plant, tmp_path):
    wanted = cl.design.regulator(plant, FOUR).values
    given = [control.ss(*FOUR), signal.StateSpace(*FOUR)]
    for version, packed in (("4", False), ("5", False), ("5", True)):
        path = tmp_path / f"regulator-{version}-{packed}.mat"
        savemat(path, MATRICES | {"Ts": 0, "note": "mine"}, format=version, do_compression=packed)
        given += [path, str(path)]
    for each in given:
        assert cl.design.regulator(plant, each).values == wanted


def test_one_that_is_sampled_already_is_taken_as_it_is(plant, tmp_path):
    *sampled, _ = signal.cont2discrete(FOUR, 1.0, method="bilinear")
    savemat(tmp_path / "sampled.mat", dict(zip("ABCD", sampled, strict=True), Ts=1.0))
    wanted = cl.design.regulator(plant, FOUR).values
    for given, more in (
        (tuple(sampled), {"sampling_period": "1 s"}),
        (control.ss(*sampled, 1.0), {}),
        (control.ss(*sampled, True), {"sampling_period": 1.0}),
        (tmp_path / "sampled.mat", {}),
    ):
        found = cl.design.regulator(plant, given, **more).values
        assert found == pytest.approx(wanted, rel=1e-6, abs=1e-9)


def test_numbers_are_in_the_units_that_people_see_or_in_those_named():
    """Three tanks: cm and cm³/s; 100 cm³/s are all of the feed, and 70 cm of level 3."""
    plant = cl.load("three-tanks")
    ends = {"measurements": ["level_3"], "manipulated": ["feed"]}
    direct = "feed.error_gain.level_3"
    usual = cl.design.regulator(plant, (-1.0, 1.0, 1.0, 2.0), **ends).values[direct]
    # Tustin of 2 + 1/(s + 1) each second: 2 + 0.5/1.5; cm³/s by cm are 1e-4 m³/s by m.
    assert usual == pytest.approx(-(2.0 + 1.0 / 3.0) * 1e-4, rel=1e-8)
    for units, factor in (
        ({"level_3": "m"}, 1e-2),
        ({"feed": "l/s"}, 1e3),
        ({"level_3": "%", "feed": "%"}, 1.0 / 0.7),
    ):
        found = cl.design.regulator(plant, (-1.0, 1.0, 1.0, 2.0), units=units, **ends)
        assert found.values[direct] == pytest.approx(usual * factor, rel=1e-8)


def test_the_sign_is_that_of_the_error_it_acts_on(plant):
    other = cl.design.regulator(plant, (A, -B, C, -D), acts_on="measurement_minus_setpoint")
    assert other.values == cl.design.regulator(plant, FOUR).values


def test_pi_control_as_matrices_runs_as_pi_control(plant):
    """K = 3, Ti = 30 s; Tustin's integral is half a sample ahead of the one of the PI law."""
    regulator = cl.design.regulator(plant, (0.0, 0.1, 1.0, 2.95), **ONE)
    run = cl.simulate(plant, regulator, [cl.step("level_1", "+0.2 V", at="10 s")], duration="2 min")
    pump, level = run.values["pump_1"], run.values["level_1"]
    error = np.where(run.time < 10.0, 0.0, 0.2) - (level - level[0])
    integral = np.concatenate([[0.0], np.cumsum(0.1 * error)[:-1]])
    assert pump == pytest.approx(3.0 + 3.0 * error + integral, abs=1e-5)


def test_it_starts_at_rest_and_comes_back_from_manual_without_a_bump(plant):
    controller = cl.design.regulator(plant, FOUR)
    run = cl.simulate(plant, controller, [cl.step("level_1", "+1 V", at="20 s")], duration="30 s")
    assert run.values["pump_1"][run.time < 20.0] == pytest.approx(3.0, abs=1e-9)
    found = outputs(controller, np.zeros((60, 2)), manual=range(20))
    assert found[19] == pytest.approx(5.0) and found[20] == pytest.approx(5.0, abs=0.1)


def test_told_of_a_limit_it_overshoots_less(plant):
    step = [cl.step("level_1", "+3 V", at="10 s")]
    told, deaf = (
        cl.simulate(
            plant,
            cl.design.regulator(plant, (0.0, 0.6, 1.0, 3.0), anti_windup=way, **ONE),
            step,
            duration="10 min",
        ).scores["overshoot[level_1]"]
        for way in ("conditioning", "none")
    )
    assert told < 0.5 * deaf


@pytest.mark.parametrize(
    ("regulator", "more", "place", "value", "remedy"),
    [
        (7, {}, "regulator", "a int", "control.ss"),
        (control.tf([1.0], [1.0, 1.0]), {}, "regulator", "a TransferFunction", "control.ss"),
        ((A, B, C), {}, "regulator", "a tuple", ""),
        ((A[:2], B, C, D), {}, "regulator, A", "2 × 3", "one state space"),
        ((A, B[:2], C, D), {}, "regulator, B", "2 × 2", ""),
        ((A, B, C[:, :2], D), {}, "regulator, C", "2 × 2", ""),
        ((A, B, C, D[:1]), {}, "regulator, D", "1 × 2", ""),
        ((A, B, C, 2.0), {}, "regulator, D", "1 × 1", ""),
        ((np.zeros((61, 61)), B, C, D), {}, "regulator, A", "61 × 61", "reduce the order"),
        ((np.zeros((0, 0)), B[:0], C[:, :0], D), {}, "regulator, A", "0 × 0", "own law"),
        ((A * np.nan, B, C, D), {}, "regulator, A", None, ""),
        ((A, B, C, 1e300 * D), {}, "regulator, D", 3e300, ""),
        ((A, 1j * B, C, D), {}, "regulator, B", "complex numbers", ""),
        ((A, [["1"]], C, D), {}, "regulator, B", None, ""),
        ((A, [[1.0], [1.0, 2.0]], C, D), {}, "regulator, B", "rows of different lengths", ""),
        (PI, {}, "regulator, measurements", "level_1, level_2", "name them"),
        (FOUR, {"manipulated": ["pump_1"]}, "regulator, manipulated", "pump_1", ""),
        (FOUR, {"measurements": ["level_1"] * 2}, "regulator, measurements", None, ""),
        (PI, {**ONE, "measurements": ["level_9"]}, "regulator, measurements", "level_9", ""),
        ((0.0, [[1, 1]], 1.0, [[1, 1]]), {"manipulated": ["pump_1"]},
         "regulator, measurements", None, "fewer errors"),
        (FOUR, {"units": {"level_1": "kg"}}, "regulator, units, level_1", "kg", '"V"'),
        (FOUR, {"units": {"tank": "m"}}, "regulator, units", "tank", ""),
        (FOUR, {"units": "V"}, "regulator, units", "V", ""),
        (FOUR, {"acts_on": "error"}, "regulator, acts_on", "error", ""),
        (FOUR, {"anti_windup": "clamping"}, "regulator, anti_windup", "clamping", ""),
        (FOUR, {"sampling_period": 0.5}, "regulator, sampling period", "0.5 s", "sampling_period"),
        (FOUR, {"sampling_period": "0 s"}, "sampling_period", None, ""),
        (control.ss(*FOUR, 0.5), {}, "regulator, sampling period", "0.5 s", "continuous time"),
        (control.ss(*FOUR, 1.0), {"sampling_period": 0.5}, "regulator, sampling period", None, ""),
        (control.ss(*FOUR, True), {}, "regulator, sampling period", "none", "1 s"),
        ((2.0, 0.1, 1.0, 3.0), ONE, "regulator, A", "a pole at 2 rad/s", "sample faster"),
    ],
)  # fmt: skip
def test_a_regulator_that_cannot_be_is_refused(plant, regulator, more, place, value, remedy):
    with refused(place=place, remedy=remedy) as caught:
        cl.design.regulator(plant, regulator, **more)
    if value is not None:
        assert caught.value.value == value


def test_an_integral_that_no_error_reaches_is_no_regulator(plant):
    with pytest.raises(cl.NotApplicable, match="regulator is not applicable"):
        cl.design.regulator(plant, (np.zeros((2, 2)), [[0.1], [0.0]], [[1.0, 1.0]], 3.0), **ONE)


def test_a_loop_that_is_unstable_is_told(plant):
    found = cl.design.regulator(plant, (0.0, -0.1, 1.0, -3.0), **ONE)
    assert "the loop is unstable" in found.design and "sign" in found.notes[-1]


def saved(folder, **changed):
    path = folder / "reg1.mat"
    kept = {name: value for name, value in (MATRICES | changed).items() if value is not None}
    savemat(path, kept)
    return path


@pytest.mark.parametrize(
    ("changed", "part", "value"),
    [
        ({"D": None, "K": 1.0}, "", "A, B, C, K"),
        ({"A": {"a": 1.0}}, ", A", "struct 1 × 1"),
        ({"A": "integral"}, ", A", None),
        ({"B": np.array([1.0, "x"], object)}, ", B", "cell 1 × 2"),
        ({"A": sparse.csc_matrix(A)}, ", A", "sparse 3 × 3"),
        ({"A": np.zeros((61, 61))}, ", A", "double 61 × 61"),
        ({"A": np.zeros((2, 2, 2))}, ", A", "double 2 × 2 × 2"),
        ({"A": np.full((3, 3), np.inf)}, ", A", None),
        ({"E": np.diag([1.0, 1.0, 0.0])}, ", E", "another matrix"),
        ({"Ts": -1.0}, ", Ts", "[-1.0]"),
        ({"Ts": np.nan}, ", Ts", None),
        ({"Ts": [1.0, 1.0]}, ", Ts", None),
    ],
)
def test_a_file_with_something_else_is_refused_with_its_name(plant, tmp_path, changed, part, value):
    path = saved(tmp_path, **changed)
    with refused(place=f"{path}{part}") as caught:
        cl.design.regulator(plant, path)
    assert caught.value.place == f"{path}{part}"
    if value is not None:
        assert caught.value.value == value


def test_an_empty_descriptor_matrix_is_the_identity(plant, tmp_path):
    wanted = cl.design.regulator(plant, saved(tmp_path)).values
    for empty in (np.zeros((0, 0)), np.eye(3)):
        assert cl.design.regulator(plant, saved(tmp_path, E=empty)).values == wanted


@pytest.mark.parametrize(
    ("content", "value"),
    [
        (b"", "something that is not a MAT file"),
        (b"x' = A x", "something that is not a MAT file"),
        (b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n", "version 7.3"),
        (b"\x89HDF\r\n\x1a\n" + bytes(40), "version 7.3"),
        (b"# Created by Octave 8.4.0, Mon Jan 01 10:00:00 2026 UTC\n# name: A\n", "Octave's text"),
        (b"Octave-1-L\0" + bytes(20), "Octave's binary form"),
        (bytes(1_000_001), "more than 1 MB"),
    ],
)
def test_another_file_is_refused_with_what_to_do(plant, tmp_path, content, value):
    path = tmp_path / "reg1.mat"
    path.write_bytes(content)
    with refused(place=str(path)) as caught:
        cl.design.regulator(plant, path)
    assert str(caught.value.value).startswith(value)
    assert "-v7" in caught.value.remedy or value.startswith("more")


def test_a_file_that_is_not_there_is_refused(plant, tmp_path):
    with refused(place=str(tmp_path / "no.mat"), value="no such file"):
        cl.design.regulator(plant, tmp_path / "no.mat")


@pytest.mark.parametrize(("version", "packed"), [("4", False), ("5", False), ("5", True)])
def test_a_damaged_file_is_read_or_refused(plant, tmp_path, version, packed):
    """SciPy's reader crashes on some of these."""
    from clepsydra.designs.regulators.mat_file import read_mat

    draw, file, path = random.Random(version), BytesIO(), tmp_path / "reg1.mat"
    savemat(file, MATRICES | {"Ts": 1.0}, format=version, do_compression=packed)
    whole, refusals = file.getvalue(), 0
    for _ in range(400):
        content = bytearray(whole)
        for _ in range(draw.choice((1, 2, 5))):
            content[draw.randrange(len(content))] = draw.randrange(256)
        path.write_bytes(
            bytes(content[: draw.choice((len(content), draw.randrange(len(content))))])
        )
        try:
            read_mat(path)
        except cl.InputError as error:
            assert error.place.startswith(str(path)) and error.remedy
            refusals += 1
    assert refusals > 100


STUDY = """process = "quadruple-tank"
[scenario]
duration = "2 min"
noise = false
[[scenario.setpoint]]
signal = "level_1"
at = "30 s"
by = "0.5 V"
[controllers.given]
regulator = "reg1.mat"
"""


def study_of(folder, text=STUDY):
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_study_file_names_the_file(plant, tmp_path):
    saved(tmp_path)
    (found,) = cl.study(study_of(tmp_path)).ranking
    assert found.controller.name == "given"
    assert found.controller.values == cl.design.regulator(plant, FOUR).values
    turned = STUDY + 'acts_on = "measurement_minus_setpoint"\nanti_windup = "none"\n'
    turned += 'units = { level_1 = "mV" }\nmeasurements = ["level_1", "level_2"]\n'
    saved(tmp_path, B=-B * [1e-3, 1.0], D=-D * [1e-3, 1.0])
    (found,) = cl.study(study_of(tmp_path, turned)).ranking
    wanted = cl.design.regulator(plant, FOUR, anti_windup="none").values
    assert found.controller.values == pytest.approx(wanted, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("line", "place", "value"),
    [
        ('regulator = "no.mat"', "line 10, controllers.given.regulator", "no.mat"),
        ("regulator = 7", "line 10, controllers.given.regulator", 7),
        ('regulator = "reg1.mat"\nunits = { level_1 = "kg" }', "line 11, ", "kg"),
        ('regulator = "reg1.mat"\nmeasurements = ["level_1"]', "line 11, ", "level_1"),
        ('regulator = "reg1.mat"\nsampling_period = "2 s"', "line 10, ", "2 s"),
        ('regulator = "reg1.mat"\nacts_on = "y"', "line 11, ", "y"),
        (
            'regulator = "reg1.mat"\ndesign = "simc"',
            "line 9, controllers.given",
            "design and regulator",
        ),
    ],
)
def test_a_mistake_in_a_study_file_is_told_with_its_line(tmp_path, line, place, value):
    saved(tmp_path)
    with refused(place=f"{tmp_path}/study.toml, {place}", value=value):
        cl.study(study_of(tmp_path, STUDY.replace('regulator = "reg1.mat"', line)))
