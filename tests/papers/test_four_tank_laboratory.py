"""The audit of the laboratory report: every verdict, and its runs by a second route."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom, norm

import clepsydra as cl
from clepsydra.base.signal import path
from clepsydra.papers.four_tank_laboratory.controllers import (
    at_the_simulator,
    decentralised,
    dynamic_decoupling,
    precompensator_of,
    robust,
)
from clepsydra.papers.four_tank_laboratory.margins import response
from clepsydra.papers.four_tank_laboratory.reach import ENOUGH, FAR, MEDIAN_RANKS
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    SET_UPS,
    course_model,
    plant,
)
from clepsydra.papers.four_tank_laboratory.simulator import (
    POURED_LEVEL,
    SEEDS,
    by_hand,
    runs,
)

pytestmark = pytest.mark.thorough

MISPRINTS = {
    # Tank 4, twice: it has 23.5 cm in Table 1, and by (3) pump 1 fills it and not tank 3.
    ("text before (23)", "tank that rests at 23.5 cm"),
    ("Exercise 2.1.7", "upper tank that pump 1 fills"),
    # The sentence of exercise 4.1.1, where it is about Glover-McFarlane.
    ("Exercise 4.2.1", "controller that is verified"),
}

DAMAGED: set[tuple[str, str]] = set()

FAILED = {
    ("Exercise 2.2.2", "coupling of tanks 1 and 4"),
    # The printed 6.67 % is below 15.17 %.
    ("Exercise 4.1.2", "oscillation"),
    # The section that is to show it has transients, 220 s and 78 s: the other way round.
    ("Exercise 2.2.4", "manual control"),
}

HOLDS = {
    ("(13)", "zeros for 1 < γ1 + γ2 ≤ 2"),
    ("Exercise 2.1.5", "poles"),
    ("Exercise 2.1.5", "phase of the process"),
    ("Exercise 2.2.2, Fig. 1", "minimum phase, pump 1 alone"),
    ("Exercise 2.2.2, Fig. 2", "minimum phase, pump 2 alone"),
    ("Exercise 2.2.2, Fig. 3", "non-minimum phase, pump 1 alone"),
    ("Exercise 2.2.2, Fig. 4", "non-minimum phase, pump 2 alone"),
    ("Exercise 2.2.4", "upper holes"),
    ("Exercise 2.2.4", "zero in the right half-plane"),
    ("Exercise 4.1.2", "response"),
    ("Exercise 4.1.2", "recovery"),
    ("Exercise 4.1.2", "robustness"),
    ("Exercise 4.2.2", "overshoot"),
    ("Exercise 4.2.3", "response"),
    ("Exercise 4.2.3", "recovery"),
    ("Exercise 4.2.3", "robustness"),
}

# The way back from holes to the levels that they come from, levels printed twice, gains that the
# simulator was given, and levels that the holes were fitted to.
CONSISTENT = {
    *((f"Table {table}", f"h{tank}") for table in (1, 2) for tank in (1, 2, 3, 4)),
    *((f"Table {table}", f"h{tank}, calculated") for table in (3, 4) for tank in (1, 2, 3, 4)),
    ("Exercise 2.1.7", "k1"),
    ("Exercise 2.1.7", "k2"),
    ("Exercise 2.2.3", "level of both lower tanks, minimum phase, fitted holes"),
}

# Claims that its tables support and controllers of ours do not, or not in volts as designed, since
# its own are not printed.
REMARKS = {
    # One of the two zeros.
    ("(14)", "zeros for 0 < γ1 + γ2 ≤ 1"),
    # Levels that agree with some readings of the noise and the holes alone, and two transients.
    ("Table 3", "h1, simulation"),
    ("Table 3", "h3, simulation"),
    ("Table 3", "h4, simulation"),
    ("Table 4", "h3, simulation"),
    ("Exercise 2.2.3, Fig. 5", "transient, minimum phase"),
    ("Exercise 2.2.3, Fig. 6", "transient, non-minimum phase"),
    # Slower and later, but with less overshoot.
    ("Exercise 4.2.3", "overall performance"),
    ("Exercise 4.2.2", "trade of overshoot for rise time"),
    ("Exercise 4.2.2", "Glover-McFarlane"),
    ("Exercise 4.2.3", "overshoot"),
    ("Exercise 4.2.2", "rise"),
    ("Exercise 4.2.2", "recovery"),
}

#: Numbers of Tables 5 and 6 that are far from all runs of every reading; all others are remarks.
OUT_OF_REACH = {
    ("Table 5", "rise 1/2, minimum phase"),
    ("Table 5", "rise 1, non-minimum phase"),
}

NOT_REPRODUCIBLE = {
    ("Table 4", "h4, simulation"),
    ("Exercise 2.2.3", "level of both lower tanks, minimum phase, holes of the report"),
    ("Exercise 2.2.3", "level of both lower tanks, non-minimum phase, holes of the report"),
}


@pytest.fixture(scope="module")
def found(audited):
    return tuple(audited("four-tank-laboratory").experiments.values())


@pytest.fixture(scope="module")
def rows(found):
    return [row for each in found for row in each.rows]


def named(rows, verdict):
    return {(row.place, row.name) for row in rows if row.verdict == verdict}


def test_its_page_prints_what_the_audit_finds(page_holds):
    assert page_holds("four-tank-laboratory")


def test_every_row_has_its_own_name(rows):
    names = [(row.place, row.name) for row in rows]
    assert len(set(names)) == len(names)
    assert all(row.document == "four-tank-laboratory" and row.reason is not None for row in rows)


@pytest.mark.parametrize(
    ("verdict", "wanted"),
    [
        ("misprint", MISPRINTS),
        ("damaged text", DAMAGED),
        ("claim fails", FAILED),
        ("claim holds", HOLDS),
        ("consistent", CONSISTENT),
    ],
)
def test_every_verdict_is_that_of_the_lists(rows, verdict, wanted):
    assert named(rows, verdict) == wanted


def test_numbers(rows):
    table = {(row.place, row.name) for row in rows
             if row.place in ("Table 5", "Table 6")}  # fmt: skip
    assert len(table) == 19  # where one number stands for both tanks it is one
    assert named(rows, "not reproducible") == NOT_REPRODUCIBLE | OUT_OF_REACH
    assert named(rows, "remark") == REMARKS | (table - OUT_OF_REACH)
    reproduced = named(rows, "reproduced")
    for place, count in (("(4)", 4), ("(9)", 12), ("(10)", 1), ("(11)", 4), ("(12)", 2),
                         ("(15)", 4), ("(16)", 1), ("(17)", 1), ("(18)", 1), ("(19)", 4),
                         ("(20)", 4), ("(21)", 2), ("(22)", 2), ("(23)", 2), ("(24)", 4),
                         ("(25)", 4), ("Exercise 2.1.6", 2), ("Table 3", 1), ("Table 4", 2),
                         ("Exercise 2.2.3", 2)):  # fmt: skip
        assert sum(where == place for where, _ in reproduced) == count, place


def test_what_the_numbers_of_runs_and_ranks_stand_for():
    """By the binomial law: a tail of one in forty, the median, and 128 runs; by the normal one."""
    assert SEEDS == 128
    assert 1.0 / norm.sf(FAR) == pytest.approx(31600.0, abs=50.0)
    assert 1.0 - (1.0 - norm.sf(FAR)) ** SEEDS == pytest.approx(0.004, abs=1e-4)
    assert binom.sf(ENOUGH - 1, SEEDS, 0.025) == pytest.approx(0.042, abs=5e-4)
    assert binom.sf(ENOUGH - 2, SEEDS, 0.025) > 0.1
    low, high = MEDIAN_RANKS
    # The median is above the run of rank r where at least r of the runs are below it.
    assert binom.sf(low - 1, SEEDS, 0.5) - binom.sf(high - 1, SEEDS, 0.5) == pytest.approx(
        0.96, abs=0.005
    )


def test_the_second_reading_of_the_decoupling_rises_sooner(rows):
    """62 and 72 s where a lag of all of it has 78 and 88 s; printed are 103.1 and 81.5 s."""
    for lagged, wanted in (("all", (77.5, 88.0)), ("diagonal", (62.0, 71.5))):
        found = runs(NON_MINIMUM, "robust", "percent", lagged=lagged)
        for tank, middle in zip((1, 2), wanted, strict=True):
            assert np.median(found.scored("rise", tank)) == pytest.approx(middle, abs=1.0)
    (row,) = [r for r in rows if (r.place, r.name) == ("Table 6", "rise 2, non-minimum phase")]
    assert row.verdict == "remark"


@pytest.mark.parametrize("split", [0.1, 0.375, 0.5, 0.49])
def test_only_one_zero_of_14_is_not_negative(split):
    """(12) as a polynomial of times of 20 and 30 s."""
    low, high = sorted(np.roots([600.0, 50.0, (2 * split - 1) / split**2]).real)
    assert low < 0.0 <= high + 1e-12


def test_the_entries_of_9_that_have_no_row_are_zero(rows):
    """The balances by differences at levels of no equilibrium: what moves what."""
    holes = np.array([hole.number.value for hole in MINIMUM.holes])
    level, volts = np.array([18.0, 17.0, 14.0, 19.0]), np.array([6.0, 7.0])
    rest = flows(level, volts, holes, 0.625)
    by_level = [flows(level + step, volts, holes, 0.625) - rest for step in 0.01 * np.eye(4)]
    by_volts = [flows(level, volts + step, holes, 0.625) - rest for step in 0.01 * np.eye(2)]
    wanted = {
        f"{name}, row {i + 1}, column {j + 1}"
        for name, columns in (("A", by_level), ("B", by_volts), ("C", np.eye(2)))
        for j, column in enumerate(columns)
        for i in np.flatnonzero(column)
    }
    assert {row.name for row in rows if row.place == "(9)"} == wanted


def test_the_second_reading_multiplies_by_one_and_three_tenths_of_a_normal_number():
    """Plugged outlets: the level is the integral of k u (1 + 0.3 z), never negative, over A."""
    found = by_hand(
        MINIMUM, (7.5, 7.5), duration=10.0, plugged=True, noise="one deviation", every=1
    )
    drawn = np.random.default_rng(7).standard_normal((2, 16, 200))
    for tank in (0, 1):
        flow = K[tank] * 7.5 * np.maximum(1.0 + 0.3 * drawn[tank], 0.0)
        wanted = np.cumsum(flow, axis=1) * 0.05 / A
        assert found.levels[tank][:, 1:] == pytest.approx(wanted[:, :-1], rel=1e-9)


def test_the_numbers_of_the_reference(rows):
    """What is known of the document beside its print."""
    values = {(row.place, row.name): row.computed for row in rows}
    place = "level of both lower tanks, minimum phase"
    assert values["Exercise 2.2.3", f"{place}, holes of the report"] == pytest.approx(
        10.9, abs=0.05
    )
    assert values["Exercise 2.2.3", f"{place}, fitted holes"] == pytest.approx(15.0, abs=0.05)


def test_figures(found):
    numbers = [figure.number for each in found for figure in each.figures]
    assert [number for number in numbers if number] == [f"Fig. {k}" for k in range(1, 11)]
    for each in found:
        for figure in each.figures:
            for panel in figure.panels:
                for curve in panel.curves:
                    assert np.all(np.isfinite(curve.y)) and len(curve.x) > 1


# ---- second routes ----

A, KC = 15.5179, 0.2
K = np.array([4.32, 3.74])


def flows(h, u, holes, split):
    out = holes * np.sqrt(2 * 981.0 * np.maximum(h, 0.0))
    q = K * np.maximum(u, 0.0)
    return np.array(
        [
            split * q[0] + out[2] - out[0],
            split * q[1] + out[3] - out[1],
            (1 - split) * q[1] - out[2],
            (1 - split) * q[0] - out[3],
        ]
    )


def transfer(set_up, s):
    """(11), written from the print with the holes of the report [V/V]."""
    holes = np.array([hole.number.value for hole in set_up.holes])
    T = A / holes * np.sqrt(2 * np.array(set_up.course_levels) / 981.0)
    c = T[:2] * KC / A
    g = set_up.split
    return np.array(
        [
            [g * K[0] * c[0] / (1 + s * T[0]),
             (1 - g) * K[1] * c[0] / (1 + s * T[2]) / (1 + s * T[0])],
            [(1 - g) * K[0] * c[1] / (1 + s * T[3]) / (1 + s * T[1]),
             g * K[1] * c[1] / (1 + s * T[1])],
        ]
    )  # fmt: skip


def settings_of(set_up):
    values = decentralised(set_up).values
    return tuple(
        np.array([values[path(level, part)] for level in ("level_1", "level_2")])
        for part in ("proportional_gain", "integral_time")
    )


@pytest.mark.parametrize("set_up", SET_UPS, ids=lambda s: s.phase)
def test_pi_against_the_printed_transfer_matrix(set_up):
    """60° at the crossover, by (11) with half a sample of delay.

    Gain and integral time have six digits, so that each is off by up to 5e-6 of itself.
    """
    gains, times = settings_of(set_up)
    s = 1j * set_up.crossover
    G = transfer(set_up, s) * np.exp(-0.025 * s)
    columns = (0, 1) if set_up is MINIMUM else (1, 0)
    for i, j in enumerate(columns):
        loop = G[i, j] * gains[i] * (1 + 1 / (s * times[i]))
        assert abs(loop) == pytest.approx(1.0, rel=1e-5)
        assert math.degrees(math.pi + np.angle(loop)) == pytest.approx(60.0, abs=5e-4)


@pytest.mark.parametrize(
    "set_up, factor, printed",
    [(MINIMUM, 1, 1.18), (MINIMUM, 3, 1.01), (NON_MINIMUM, 1, 1.41), (NON_MINIMUM, 3, 3.05)],
)
def test_sensitivity_peaks_by_a_sweep_of_the_transfer_matrix(set_up, factor, printed):
    gain, time = settings_of(set_up)
    peaks = []
    for omega in np.geomspace(1e-3, 3.0, 4000):
        s = 1j * omega
        C = np.diag(gain * (1 + 1 / (s * time)))
        if set_up is NON_MINIMUM:
            C = C[::-1]  # error 1 moves pump 2
        L = factor * transfer(set_up, s) * np.exp(-0.025 * s) @ C
        peaks.append(np.linalg.norm(np.linalg.inv(np.eye(2) + L), 2))
    assert max(peaks) == pytest.approx(printed, abs=0.006)
    loop = response(set_up, "decentralised", "volts" if factor == 1 else "percent").loop
    assert loop.maximum_sensitivity == pytest.approx(max(peaks), abs=0.006)


def test_dynamic_decoupling_makes_the_plant_diagonal():
    shaping = dynamic_decoupling(NON_MINIMUM)
    a, b, c, d = shaping.system
    for omega in (0.003, 0.02, 0.2):
        w = 2.0 / 0.05 * math.tan(0.5 * 0.05 * omega)  # the frequency that Tustin's rule sees
        z = np.exp(1j * omega * 0.05)
        W = c @ np.linalg.solve(z * np.eye(len(a)) - a, b) + d
        loop = transfer(NON_MINIMUM, 1j * w) @ W
        off = np.abs(loop - np.diag(np.diag(loop))).max()
        assert off < 1e-9 * np.abs(loop).max()
        if omega == 0.02:
            for value in np.diag(loop):
                assert abs(value) == pytest.approx(1.0, rel=1e-4)
                assert math.degrees(math.pi + np.angle(value)) == pytest.approx(60.0, abs=0.01)


def test_a_lag_of_the_diagonal_alone_leaves_the_rest_of_the_decoupling():
    """W·PI by the print: [[w₁₁ f, 1], [1, w₂₂ f]] with w from (11) and f = 0.2/(s + 0.2)."""
    a, b, c, d = dynamic_decoupling(NON_MINIMUM, "diagonal").system

    def decoupling(s):
        (g11, g12), (g21, g22) = transfer(NON_MINIMUM, s)
        f = 0.2 / (s + 0.2)
        return np.array([[-g22 / g21 * f, 1.0], [1.0, -g11 / g12 * f]])

    loop = np.diag(transfer(NON_MINIMUM, 0.02j) @ decoupling(0.02j))
    # K (1 + 1/(s Ti)) with 60° at 0.02 rad/s.
    needed = np.exp(-2j / 3 * np.pi) / loop
    times = 1.0 / (0.02 * np.tan(-np.angle(needed * np.sign(needed.real))))
    for omega in (0.003, 0.02, 0.2):
        w = 2.0 / 0.05 * math.tan(0.5 * 0.05 * omega)
        control = needed.real * (1.0 + 1.0 / (1j * w * times))
        z = np.exp(1j * omega * 0.05)
        found = c @ np.linalg.solve(z * np.eye(len(a)) - a, b) + d
        assert found == pytest.approx(decoupling(1j * w) @ np.diag(control), rel=1e-3)


@pytest.mark.parametrize("pour", [3.0, POURED_LEVEL, 12.0])
def test_a_run_by_plain_python(rows, pour):
    """PI in percent on the minimum phase, without noise, by RK4 and a loop of three lines.

    What it takes to be back after each pour [cm], in either band, is what the row of it tells.
    """
    found = runs(MINIMUM, "decentralised", "percent", noise="none", poured=pour)
    gain, time = settings_of(MINIMUM)
    holes = np.array([hole.number.value for hole in MINIMUM.holes])
    h, integral, step = np.zeros(4), np.zeros(2), 0.05
    levels = []
    for k in range(9000):
        error = 0.6 - h[:2] / 25.0
        u = 15.0 * np.clip(gain * error + integral, 0.0, 1.0)
        integral = integral + step * gain / time * error
        poured = np.zeros(4)
        for tank in (1, 2):
            start = tank * 3000
            poured[tank - 1] = A * pour * (start <= k < start + 20)
        levels.append(h[:2] / 25.0)

        def rate(x, u=u, poured=poured):
            return (flows(x, u, holes, 0.625) + poured) / A

        k1 = rate(h)
        k2 = rate(h + step / 2 * k1)
        k3 = rate(h + step / 2 * k2)
        h = h + step / 6 * (k1 + 2 * k2 + 2 * k3 + rate(h + step * k3))
    ours = found.levels[:2, 0, :] / 25.0
    theirs = np.array(levels).T[:, ::4]
    # Near an empty tank Torricelli's law is laminar in the one and not in the other.
    assert np.abs(ours - theirs).max() < 2e-3
    assert np.abs(ours[:, 200:] - theirs[:, 200:]).max() < 5e-4
    (row,) = [r for r in rows if (r.place, r.name) == ("Table 5", "recovery 1/2, minimum phase")]
    said = row.reason.partition("after 3, 6.25, 9 and 12 cm it is, with the report's holes")[2]
    place = (3.0, POURED_LEVEL, 9.0, 12.0).index(pour)
    for band in (0.05, 0.02):
        within = said.partition(f"within {100 * band:g} % of 15 cm ")[2].split(" s")[0]
        for tank, times in enumerate(within.split(", tank 2 "), start=1):
            part = np.array(levels)[tank * 3000 : (tank + 1) * 3000, tank - 1]
            back = step * (np.flatnonzero(np.abs(part / 0.6 - 1.0) > band)[-1] + 1)
            told = times.removeprefix("tank 1 ").replace(" and ", ", ").split(", ")
            assert float(told[place]) == pytest.approx(back, abs=0.3)


@pytest.mark.parametrize("set_up", SET_UPS, ids=lambda s: s.phase)
def test_the_simulator_takes_the_same_numbers_in_percent(set_up):
    in_percent, in_volts = (
        at_the_simulator(set_up, "robust", plant(set_up, units)) for units in ("percent", "volts")
    )
    numbers, others = (
        {name: value for name, value in each.values.items() if not name.endswith("_limit")}
        for each in (in_percent, in_volts)
    )
    assert numbers == others and any(".error_gain." in name for name in numbers)
    # Its own memory, and nothing of the outputs at rest.
    memories = [
        {each.name for each in controller.law.state if each.name.startswith("memory")}
        for controller in (in_percent, robust(set_up))
    ]
    assert memories[0] == memories[1]
    assert not any(".output_effect." in name for name in numbers)  # no anti-windup
    assert in_percent.values["pump_1.high_limit"] == 1.0
    assert in_volts.values["pump_1.high_limit"] == 15.0


def test_the_model_of_the_course_is_the_printed_one():
    for set_up in SET_UPS:
        model = course_model(set_up)
        for omega in (0.0, 0.01, 0.3):
            s = 1j * omega
            found = model.C @ np.linalg.solve(s * np.eye(4) - model.A, model.B)
            assert np.allclose(found, transfer(set_up, s), rtol=1e-9)


def test_lower_holes_that_make_15_cm_are_no_reading_of_table_4(rows):
    """By (6) a level goes with 1/a², here from what exercise 2.2.3 makes of it to 15 cm."""
    of = {(row.place, row.name): row for row in rows}
    name = "level of both lower tanks, non-minimum phase, holes of the report"
    row = of["Exercise 2.2.3", name]
    other = float(row.reason.split("tank 2 ")[1].split(" ±")[0])
    for tank, held, wanted in (1, row.computed, 21.2), (2, other, 26.2):
        line = of["Table 4", f"h{tank}, simulation"]
        level = line.computed * 15.0 / held
        assert level == pytest.approx(wanted, abs=0.05)
        assert abs(level - line.printed) > 0.9  # three standard deviations or more


def test_no_hole_gives_table_3_and_15_cm_without_the_cut_off(rows):
    """By (6): h1 at 7.5 V is (30.8/22.9)² times h1 at 6.6 V and 3.6 V, whatever the hole is."""
    flows = [0.625 * K[0] * one + 0.375 * K[1] * two for one, two in ((7.5, 7.5), (6.6, 3.6))]
    wanted = 15.0 * (flows[0] / flows[1]) ** 2
    assert wanted == pytest.approx(27.15, abs=0.01)
    (row,) = [r for r in rows if (r.place, r.name) == ("Table 3", "h1, simulation")]
    assert "off from 27.5 cm in any tank until 27 cm" in row.reason and row.computed < 25.0


def test_in_volts_tank_1_of_non_minimum_phase_overshoots_by_the_noise_alone():
    for kind in ("decentralised", "robust"):
        assert runs(NON_MINIMUM, kind, "volts", noise="none").scored("overshoot", 1) == 0.0
        assert 0.0 < np.median(runs(NON_MINIMUM, kind, "volts").scored("overshoot", 1)) < 1.0


def test_the_cut_off_holds_level_two():
    """With the fitted holes 7.5 V would overflow tank 2: the level is that of the cut-off."""
    found = by_hand(MINIMUM, (7.5, 7.5), "fitted")
    # The pumps are off while it falls, in the second half of the time.
    falling = np.diff(found.levels[1, :, found.levels.shape[2] // 2 :]) < 0.0
    assert 0.05 < falling.mean() < 0.3
    assert 27.0 < found.at_last[1] < 27.5
    process = plant(MINIMUM, "volts", "fitted")
    holes = np.array([1e4 * process.signal(f"outlet_{i}.area").initial for i in (1, 2, 3, 4)])
    inflow = 7.5 * (0.625 * K[1] + 0.375 * K[0])
    assert (inflow / holes[1]) ** 2 / (2 * 981.0) > 30.0  # [cm], above the rim


def test_the_lesson_has_the_controllers_of_the_audit():
    """Its PI control in numbers, its Glover-McFarlane controllers as MAT files."""
    from scipy.io import loadmat

    shipped = Path(cl.__file__).parent / "laboratory" / "lessons" / "shipped"
    lesson = tomllib.loads((shipped / "four-tanks.toml").read_text("utf-8"))
    for set_up, own in ((MINIMUM, lesson), (NON_MINIMUM, lesson["setups"]["nonminimum"])):
        values = decentralised(set_up).values
        controllers = own["controllers"]
        for level, loop in controllers[f"PI, {set_up.phase}"]["loops"].items():
            assert (loop["measurement"], loop["output"]) == (level, dict(set_up.pairing)[level])
            for key, name in (("gain", "proportional_gain"), ("integral_time", "integral_time")):
                assert float(loop[key].split()[0]) == pytest.approx(
                    values[f"{level}.{name}"], rel=1e-6
                )
        table = controllers[f"Glover-McFarlane, {set_up.phase}"]
        found = loadmat(shipped / table["regulator"])
        designed = at_the_simulator(set_up, "robust", plant(set_up, "percent"))
        s = np.exp(0.05j * np.geomspace(1e-3, 30.0, 40))
        A, B, C, D = (found[name] for name in "ABCD")
        law = precompensator_of(designed, course_model(set_up, "percent")).system
        for z in s:
            given = C @ np.linalg.solve(z * np.eye(len(A)) - A, B) + D
            own_law = law.C @ np.linalg.solve(z * np.eye(len(law.A)) - law.A, law.B) + law.D
            assert given == pytest.approx(own_law, rel=1e-6, abs=1e-9)
