"""What the averaging tank's conclusion says of large steps, and what its rows find."""

import re
from pathlib import Path

import numpy as np
import pytest
from plain_large_steps import STEPS as LARGE
from plain_large_steps import ratios, recomputed_lqi, scheduled_lqi, scheduled_pi

from clepsydra.base.signal import path
from clepsydra.papers.averaging_tank import operating_range
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS
from clepsydra.papers.averaging_tank.operating_range import LARGE_STEPS, PERIOD, Step, range_runs
from clepsydra.papers.averaging_tank.range_controllers import (
    KINDS,
    VOLUMES,
    controller_of,
    gains_at,
    linear_errors,
)

pytestmark = pytest.mark.thorough

PAGE = (Path(__file__).parents[2] / "docs/papers/averaging-tank.md").read_text("utf-8")

VERDICTS = {
    "large steps": "remark",
    "cyclic calculation": "remark",
    "cause of the decline": "remark",
    "gain scheduling": "remark",
    "sampling": "remark",
}


@pytest.fixture(scope="module")
def findings(audited):
    return audited("averaging-tank").experiments["operating-range"]


def test_every_row_has_the_verdict_that_was_found_by_hand(findings):
    assert {row.name: row.verdict for row in findings.rows} == VERDICTS
    (cyclic,) = (row for row in findings.rows if row.name == "cyclic calculation")
    assert "5.89 times with it and 7.25 times without" in cyclic.computed
    # The worst step is not the one that is helped most.
    assert (
        "most with C by +2.5 kmol/m³ and V by -1 m³, 3.08 times and 7.09 times" in cyclic.computed
    )
    assert "from 7.1 to 3.1" in PAGE
    # LQI does not decline in every large step.
    for constant in ("outflow", "inflow"):
        declines = [operating_range.decline(constant, "LQI", step) for step in LARGE_STEPS]
        assert sum(found < 0.02 for found in declines) == 3


#: Gain and integral gain of C and of V, by hand and optimal: (80) to (83), (97b), (98b), and
#: sqrt(Q4/R1) and so on by (100a) and (101a), F from F² = Q2/R1 + 2 Fi.
LOOPS = {
    "PI by hand, f_out constant": ((50.0, 50.0), (8.0, 4.0)),
    "PI optimal, f_out constant": ((74.37, 74.37 / 8.325e-4), (8.0, 16.0)),
    "PI by hand, f_in constant": ((50.0, 5.0), (5.0, 5.0 / 30.0)),
    "PI optimal, f_in constant": ((61.5, 61.5 / 7.641e-4), (5.034, 5.034 / 3.208e-2)),
    "LQI by hand, f_out constant": ((13.8661, 10.0), (3.0536, 10.0**0.5)),
    "LQI optimal, f_out constant": ((262.4, 12.04e6**0.5), (370.81, 10.88e6**0.5)),
    "LQI by hand, f_in constant": ((14.1987, 10.0), (1.7174, 1.2247)),
    "LQI optimal, f_in constant": ((256.1, 10.92e6**0.5), (8.6827, (4.528 / 0.0113) ** 0.5)),
}


def is_stable(gains, pole, moved, period, present):
    """Of z² + (b K - 1 - a) z + a - b K + b Ki T, with Ki T in K where the sum has the present."""
    proportional = moved * (gains[0] + present * gains[1] * period)
    last = pole - proportional + moved * gains[1] * period
    return abs(last) < 1.0 and abs(proportional - 1.0 - pole) < 1.0 + last


@pytest.mark.parametrize("present", [False, True], ids=["before", "present"])
def test_the_longest_sampling_periods(findings, present):
    """The first period of a fine grid at which the loop of C or of V is unstable."""
    (row,) = (row for row in findings.rows if row.name == "sampling")
    said = dict(each.split(": ") for each in row.computed.split("; "))
    assert set(said) == set(LOOPS)
    for name, (of_c, of_v) in LOOPS.items():
        longest = next(
            period
            for period in np.geomspace(1e-5, 10.0, 20001)
            if not is_stable(
                of_c, np.exp(-0.1 * period), 1.0 - np.exp(-0.1 * period), period, present
            )
            or not is_stable(of_v, 1.0, period, period, present)
        )
        told = said[name].removesuffix(" ms").split(" and ")[present]
        assert float(told) == pytest.approx(1e3 * longest, rel=6e-3), name
        assert (longest > 0.01) == ("by hand" in name or name in (
            "LQI optimal, f_in constant",
            *(("PI optimal, f_out constant", "PI optimal, f_in constant") if present else ()),
        ))  # fmt: skip


def error_of_pi(step):
    """IAE over the size of a step, mean of both: PI control of (80) every 10 ms in plain Python.

    Held inputs: V is a straight line, and C - C_in a power of V or an exponential.
    """
    (of_c, of_v), period = step.sizes, PERIOD
    C, V, sum_c, sum_v, errors = 5.0, 2.0, 0.0, 0.0, []
    for _ in range(3001):
        e_c, e_v = 5.0 + of_c - C, 2.0 + of_v - V
        errors.append((abs(e_c / of_c), abs(e_v / of_v)))
        inlet = min(max(5.0 + 50.0 * (e_c + sum_c / 1.0), 0.0), 25.0)
        inflow = min(max(0.2 + 8.0 * (e_v + sum_v / 2.0), 0.0), 1.0)
        sum_c, sum_v = sum_c + period * e_c, sum_v + period * e_v
        change = inflow - 0.2
        if abs(change) > 1e-9:
            share = (V / (V + change * period)) ** (inflow / change)
        else:
            share = np.exp(-inflow * period / V)
        C, V = inlet + (C - inlet) * share, V + change * period
    return np.trapezoid(errors, dx=period, axis=0).mean()


@pytest.mark.parametrize(("step", "times"), [(Step(-0.5, -0.5), 10.9), (Step(0.5, -0.5), 12.9)])
def test_a_large_step_beside_a_small_one_in_its_own_directions(step, times):
    large, small = (error_of_pi(each) for each in (step, step.small))
    found = operating_range.relative_errors("outflow", "PI")
    assert found[step] == pytest.approx(large, rel=0.03)
    assert 1.0 + operating_range.decline("outflow", "PI", step) == pytest.approx(times, rel=0.02)
    assert large / small == pytest.approx(times, rel=0.05)


def test_a_small_step_of_both_costs_seven_times_as_much_down_as_up():
    up, down = (error_of_pi(Step(share, share)) for share in (0.05, -0.05))
    assert down / up == pytest.approx(7.0, rel=0.1)


def test_scheduled_gains_help_where_the_volume_rises_and_harm_where_it_falls():
    """Steps of C alone or of V alone change nothing: at 2 m³ the gains are the fixed ones."""
    changes = {1.0: [], -1.0: []}
    for constant in ("outflow", "inflow"):
        fixed, scheduled = (
            operating_range.relative_errors(constant, kind) for kind in ("PI", "PI, scheduled")
        )
        for step in LARGE_STEPS:
            if step.concentration and step.volume:
                changes[np.sign(step.volume)].append(scheduled[step] / fixed[step] - 1.0)
    less, more = ([abs(round(100.0 * each)) for each in changes[way]] for way in (1.0, -1.0))
    assert len(less) == 6 and len(more) == 4 and max(changes[1.0]) < 0.0 < min(changes[-1.0])
    assert f"{min(less)} to {max(less)} % less error" in PAGE
    assert f"{min(more)} to {max(more)} % more" in PAGE


def test_c_and_v_do_not_act_on_each_other_in_the_linear_model():
    for constant, kind in (("outflow", "PI"), ("inflow", "LQI")):
        declines = operating_range.linear_declines(constant, kind)
        model = operating_range.model_of(constant, PERIOD, high=True)
        step = Step(0.6, 1.0)
        errors = linear_errors(
            controller_of(constant, kind, PERIOD), model, [step.sizes, step.small.sizes], 30.0
        )
        large, small = step.relative(errors[:, 0]), step.small.relative(errors[:, 1])
        assert declines[step] == pytest.approx(large / small - 1.0, rel=1e-9)


def test_the_page_has_the_table_that_comes_out():
    """Each line of it is the worst of nine steps, of the kinds that it names."""
    table = PAGE.split("| worst of nine large steps")[1]
    lines = re.findall(r"^\| (\S[^|]+) \|([ \d.|]+)\|$", table, re.MULTILINE)
    found = {name.strip(): [float(n) if n.strip() else None for n in row.split("|")]
             for name, row in lines}  # fmt: skip
    columns = [(law, constant) for constant in ("outflow", "inflow") for law in ("PI", "LQI")]
    for name, kind in (
        ("fixed gains, as in the document", "{}"),
        ("scheduled gains", "{}, scheduled"),
        ("gains computed anew in every sample", "{}, recomputed"),
        ("fixed gains with anti-windup", "{}, anti-windup"),
        ("scheduled gains with anti-windup", "{}, scheduled, anti-windup"),
        ("gains computed anew, with anti-windup", "{}, recomputed, anti-windup"),
    ):
        for (law, constant), said in zip(columns, found.pop(name), strict=True):
            if said is None:
                assert law == "PI" and "recomputed" in kind
                continue
            worst = max(operating_range.decline(constant, kind.format(law), s) for s in LARGE_STEPS)
            assert f"{1.0 + worst:.1f}" == f"{said:.1f}"
    linear = found.pop("fixed gains, on the linear model with the limits")
    for (law, constant), said in zip(columns, linear, strict=True):
        worst = max(operating_range.linear_declines(constant, law).values())
        assert f"{1.0 + worst:.1f}" == f"{said:.1f}"
    assert not found


def test_the_tank_holds_every_step():
    """C from 5 to 8 kmol/m³ and V from 2 to 4 m³ would end at the rim of the catalogue's tank."""
    largest = max(step.volume for step in LARGE_STEPS)
    for constant in ("outflow", "inflow"):
        for kind in ("PI", "LQI"):
            run = range_runs(constant, kind, [Step(0.6, largest)])
            assert 4.0 < np.max(run["volume"]) < 5.9


def test_figures_show_every_law(findings):
    titles = [figure.title for figure in findings.figures]
    assert len(titles) == 4
    by_size = findings.figures[2]
    assert {curve.label for panel in by_size.panels for curve in panel.curves} == set(KINDS)


def test_the_errors_of_a_small_step_of_v_add_up_to_nothing():
    """An integrator under PI control without limits: a ramp of the input is no steady state."""
    run = range_runs("outflow", "PI", [Step(0.0, 0.001)])
    error = run["volume.setpoint"] - run["volume"]
    assert np.max(np.abs(error)) == pytest.approx(0.002)
    assert np.sum(error) * PERIOD == pytest.approx(0.0, abs=1e-9)


def test_scheduled_laws_have_the_fixed_gains_at_the_equilibrium():
    for law in ("PI", "LQI"):
        fixed = controller_of("outflow", law, PERIOD).values
        scheduled = controller_of("outflow", f"{law}, scheduled", PERIOD).values
        tables = {
            name: [value for key, value in scheduled.items() if key.startswith(f"{name}.")]
            for name in fixed
            if name not in scheduled
        }
        assert tables
        for name, table in tables.items():
            # Both have six digits, of K in %/% or in the units of the law.
            assert table[VOLUMES.index(2.0)] == pytest.approx(fixed[name], rel=1e-5)


def test_recomputed_gains_come_from_the_weights_of_the_document():
    """Sampled ever faster, they come to those of the continuous Riccati equation."""
    feedback, integral = gains_at(COLUMNS[0], 2.0)
    state = controller_of("outflow", "LQI, recomputed", 1e-3).initial_state
    outputs = ("inflow", "inflow.impurity")
    found, summed = (
        np.array([[state[path(path(u, what), by)] for by in names] for u in outputs])
        for what, names in (
            ("feedback", ("tank.impurity", "tank.level")),
            ("integral_gain", ("concentration", "volume")),
        )
    )
    assert found == pytest.approx(feedback, rel=5e-3, abs=1e-6)
    assert summed == pytest.approx(integral, rel=5e-3, abs=1e-6)


@pytest.mark.parametrize("constant", ["f_out", "f_in"])
@pytest.mark.parametrize(
    ("remedy", "kind", "law", "place"),
    [
        ("gain scheduling", "PI", scheduled_pi, 0),
        ("gain scheduling", "LQI", scheduled_lqi, 1),
        ("cyclic calculation", "LQI", recomputed_lqi, 0),
    ],
)
def test_the_remedies_by_another_simulation_in_velocity_and_in_position_form(
    findings, constant, remedy, kind, law, place
):
    (row,) = (row for row in findings.rows if row.name == remedy)
    told = row.computed.partition(f"{kind}, {constant} constant: ")[2]
    moving, still = (ratios(constant, law(constant), each) for each in (True, False))
    assert float(told.partition(" times")[0]) == pytest.approx(moving.max(), rel=1e-2)
    helped = re.match(r".*?it helps (?:nowhere|most with ([^,]+), ([\d.]+) times)", told)
    if helped[1]:
        step = tuple(float(re.search(rf"{o} by (\S+)", helped[1])[1]) for o in "CV")
        assert float(helped[2]) == pytest.approx(moving[LARGE.index(step)], rel=2e-2)
    in_position = row.reason.partition("In position form")[2]
    of_flow = in_position.partition(f"{constant} constant ")[2].partition(" times")[0]
    shown = re.findall(r"[\d.]+", of_flow)[place]
    assert shown == f"{still.max():.1f}"
    # PI and LQI with f_out constant, then with f_in constant; then those computed anew.
    of_page = re.findall(r"\d+\.\d", PAGE.partition("scheduled gains make the worst")[2])
    flow = ("f_out", "f_in").index(constant)
    column = 2 * flow + place if law is not recomputed_lqi else 4 + flow
    assert of_page[column] == shown
