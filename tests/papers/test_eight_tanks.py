"""The audit of the eight tanks: every verdict, held by hand from the reference page."""

import re

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lfilter, step
from scipy.special import gammainc

from clepsydra.papers.eight_tanks import robustness, six_designs
from clepsydra.papers.eight_tanks.polynomials import controller
from clepsydra.papers.eight_tanks.predictor import closed_loop_radius
from clepsydra.papers.eight_tanks.robustness import judged, others
from clepsydra.papers.eight_tanks.six_designs import stepped

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def found(audited):
    return tuple(audited("eight-tanks").experiments.values())


@pytest.fixture(scope="module")
def rows(found):
    return {(row.place, row.name): row for findings in found for row in findings.rows}


def of(rows, verdict):
    return {key for key, row in rows.items() if row.verdict == verdict}


MISPRINTS = {
    ("section 2", "static gain K_g = 1/K1"): pytest.approx(2.548, abs=5e-4),
    ("(12)", "model order n"): 2.0,
    ("section 3.1", "reference: minimum of the criterion"): "(17)",
    ("section 3.1", "reference: minimum of the criterion is obvious from"): "Fig. 3",
    ("Fig. 4", "reference: step responses of models (8) and"): "(21)",
    ("section 3.2", "reference: linear model obtained without hysteresis"): "(21)",
    ("section 4", "reference: second-order linear model"): "(21)",
    ("section 4", "reference: predicted error as shown in"): "Fig. 5",
    ("section 5", "reference: R from equation, with z = 1"): "(23)",
    ("section 6.2", "what differs in Figs. 10 to 12"): "individual penalization factors q_u",
}


#: A sign that is lost, a letter like another, and a 7 for a 4.
DAMAGED = {
    ("(22)", "feedback parameters"): "3 with B(1), 4 with the full B",
    ("section 2", "unit of K_g"): "min/m²",
    ("(11)", "regression"): "y = F Θ + e",
    ("(31)", "d3"): "-alpha*beta*gamma",
}


def test_its_page_prints_what_the_audit_finds(page_holds):
    assert page_holds("eight-tanks")


def test_every_misprint_is_found_with_the_right_value(rows):
    assert of(rows, "misprint") == set(MISPRINTS)
    for key, right in MISPRINTS.items():
        assert rows[key].computed == right, key


def test_damage_of_the_text_is_not_called_a_misprint(rows):
    assert of(rows, "damaged text") == set(DAMAGED)
    for key, right in DAMAGED.items():
        assert rows[key].computed == right, key


def test_the_number_of_delay_steps_hangs_on_the_noise_generator(rows):
    assert of(rows, "not reproducible") == set()
    row = rows["section 3.1", "delay steps of the smallest J(d)"]
    assert row.computed == 6.0 and row.verdict == "remark"
    assert "with 10 values of it in a sampling period 5 and 6 have" in row.reason


def test_the_digits_of_the_model_leave_its_gain_open(rows):
    row = rows["(21)", "static gain, the same as in (8)"]
    assert row.verdict == "reproduced" and row.computed == pytest.approx(3.067, abs=5e-4)
    assert "2.98 to 3.16" in row.reason


def test_what_was_made_from_the_print_does_not_reproduce_it(rows):
    assert of(rows, "consistent") == {
        ("(8)", "static gain"), ("(8)", "time constant of a tank"), ("(8)", "order"),
        ("(14)", "order of the estimates"),
        ("(21)", "a1"), ("(21)", "a2"), ("(21)", "b1"), ("(21)", "b2"),
    }  # fmt: skip


def test_the_gain_of_8_points_to_its_misprint(rows):
    reason = rows["(8)", "static gain"].reason
    assert f"{2.0 / 0.785:.3f} min/m²" in reason and "K_g in section 2" in reason


def test_the_chain_is_sampled_as_by_another_library(rows):
    """(8) held for a minute: eight coefficients on either side, by SciPy's matrix exponential."""
    below = np.poly([-0.5] * 8)
    above, poles, _ = cont2discrete(([3.08 * below[-1]], below), 1.0)
    model = six_designs.sampled_chain()
    assert above[0] == pytest.approx([0.0, *model.numerator], rel=1e-6, abs=1e-14)
    assert poles == pytest.approx([1.0, *model.denominator], rel=1e-9)
    words = f"b1 = {above[0, 1]:.4g}, b8 = {above[0, 8]:.4g}, a1 = {poles[1]:.4g}, "
    assert rows["(9)", "form of the chain, sampled"].computed == f"{words}a8 = {poles[8]:.4g}"


def test_least_squares_give_back_the_equation_that_made_the_record(rows):
    """(12) to (16) by loops and normal equations: the estimates, and the first error there is."""
    a1, a2, b1, b2, d = -1.777, 0.7964, 0.0309, 0.0286, 5
    u, y = np.random.default_rng(3).normal(size=60), np.zeros(60)
    for k in range(d + 2, 60):
        y[k] = -a1 * y[k - 1] - a2 * y[k - 2] + b1 * u[k - 1 - d] + b2 * u[k - 2 - d]
    later = range(d + 2, 60)  # counted from 0, k = 8 of the document
    F = np.array([[-y[k - 1], -y[k - 2], u[k - 1 - d], u[k - 2 - d]] for k in later])
    assert np.linalg.solve(F.T @ F, F.T @ y[later]) == pytest.approx([a1, a2, b1, b2], abs=1e-9)
    assert rows["(14)", "order of the estimates"].computed == "-1.777, 0.7964, 0.0309, 0.0286"
    row = rows["(17)", "first sample of the sum"]
    assert row.computed == f"k = {later[0] + 1} for d = 5"


def test_how_slow_the_inflow_is_says_its_measure(rows):
    """The first move is r0 w; of the courses of Figs. 10 to 12, as a share of the largest u."""
    row = rows["section 6.2", "inflow by q_u"]
    shares = []
    for choice in six_designs.PENALTIES:
        run = six_designs.step_run(choice.penalty, (choice.pole,))
        first = controller(choice.penalty, (choice.pole,), full=False).feedforward
        shares.append(f"{100.0 * float(first) / max(run.inflow):.3g}")
    assert row.computed.startswith(f"first move of the inflow {', '.join(shares)} % of its largest")
    for name in ("output by q_u", "inflow by q_u", "oscillations by q_u"):
        assert "q_u = 10," not in rows["section 6.2", name].reason


def test_what_is_reproduced(rows):
    assert of(rows, "reproduced") == {
        ("section 2", "tank area F"), ("section 2", "K1"),
        ("(3)", "level over inflow of a tank"), ("(4)", "level of tank 1"),
        ("(5)", "level of tank 2"), ("(5)", "level of tank 2 by that of tank 1"),
        ("(6), (7)", "level of tank n over inflow of tank 1, n = 8"),
        ("(9)", "form of the chain, sampled"),
        ("(12)", "estimate of least squares"), ("(13)", "y(k)"), ("(15)", "predicted output"),
        ("(18)", "model with five steps of delay"), ("(20)", "static gain of (18)"),
        ("(21)", "static gain, the same as in (8)"),
        ("(22), (25)", "characteristic polynomial of the loop"),
        ("(23), (25)", "characteristic polynomial by the error"),
        ("(27)", "D of the smallest J, with w = 0"),
        ("(24)", "r0"), ("(31)", "d1"), ("(31)", "d2"), ("(33)", "d1"),
        ("(33)", "d2"), ("(33)", "d3"),
    }  # fmt: skip


SETTINGS = {
    "Fig. 7": "q_u = 10, γ = 0.01", "Fig. 8": "q_u = 10, γ = 0.5", "Fig. 9": "q_u = 10, γ = 0.9",
    "Fig. 10": "q_u = 1, γ = 0.5", "Fig. 11": "q_u = 5, γ = 0.5", "Fig. 12": "q_u = 100, γ = 0.5",
}  # fmt: skip


def test_which_claims_hold(rows):
    assert of(rows, "claim holds") == {
        ("section 1", "integrating and unstable processes"),
        ("(11)", "dimension of F"),
        ("(27), (28)", "degree of the spectral factor"),
        ("section 5", "another pole in (29)"),
        ("section 5", "amplitude of the controller output"),
        ("section 5", "oscillations and instability by q_u"),
        *(("section 6.1", f"{what} by γ") for what in ("oscillations of y", "oscillations of u")),
        *(("section 6.2", f"{what} by q_u") for what in ("inflow", "oscillations")),
        ("section 7", "design without numerical methods"),
        ("section 7", "relatively simple controllers"),
        ("section 7", "penalisation of the manipulated variable"),
    }  # fmt: skip


def test_which_claims_fail(rows):
    assert of(rows, "claim fails") == {("section 7", "robustness of Figs. 7 to 12")}
    row = rows["section 7", "robustness of Figs. 7 to 12"]
    assert row.computed.startswith("max|S| 4.44, 3.82, 1.91, 5.77, 4.16, 3.44; gain margin 1.32, ")


def test_what_hangs_on_what_is_left_open_is_a_remark(rows):
    assert of(rows, "remark") == {
        ("section 3.1", "delay steps of the smallest J(d)"),  # by the noise generator
        ("(17)", "first sample of the sum"),  # by what was before the record
        ("section 3.2", "how (21) was found"),
        ("section 3.2", "static gain as a criterion"),  # needed, and not enough
        ("(26)", "criterion that the method minimises"),  # with w = 0 yes, else infinite
        ("section 4", "transfer function whose numerator is B(1)"),  # G_d is told by no formula
        ("section 3.2", "least squares against fminsearch"),  # by (20) yes, by (17) no
        ("section 4", "zero of B, which B(1) replaces"),
        ("section 5", "second-order polynomial (28)"),  # on (8) yes, on (21) no
        ("section 7", "low-order model of the chain"),  # 5.4 %, and no bound is printed
        ("section 7", "control quality"),
        ("section 6.1", "output by γ"),  # by the rise yes, by settling no
        ("section 6.2", "output by q_u"),
    }


def settled_within(run, band):
    """When a level joined by lines is within a band of 1 for good [min]."""
    minutes = np.arange(0.0, 239.0, 1e-3)
    level = np.interp(minutes, np.arange(240.0), run.level)
    return minutes[np.flatnonzero(np.abs(level - 1.0) > band)[-1]]


@pytest.mark.parametrize(
    ("key", "choices"),
    [(("section 6.1", "output by γ"), six_designs.POLES),
     (("section 6.2", "output by q_u"), six_designs.PENALTIES)],
)  # fmt: skip
def test_a_level_that_rises_slower_settles_sooner(rows, key, choices):
    row = rows[key]
    rise = list(map(float, re.findall(r"[\d.]+", row.computed.partition(" % ")[2])))
    assert rise == sorted(rise)
    for band in (0.02, 0.05):
        times = [settled_within(choice.run, band) for choice in choices]
        assert times[-1] < times[0]
        said = row.reason.partition(f"to {100 * band:g} % ")[2].split(" min")[0].split(", ")
        assert list(map(float, said)) == pytest.approx(times, abs=0.51)


def test_the_control_quality_is_told_within_both_bands(rows):
    """To 5 % all six settle later than a PID by AMIGO, with and without the setpoint weight."""
    row, pids = rows["section 7", "control quality"], [robustness.amigo(), robustness.amigo(0.0)]
    six = [settled_within(choice.run, 0.05) for choice in six_designs.SIX]
    others = [settled_within(stepped(pid), 0.05) for pid in pids]
    assert min(six) > max(others)
    words = row.reason.partition("than either, after ")[2]
    assert words.startswith(", ".join(f"{each:.0f}" for each in six))
    assert " and ".join(f"{each:.0f}" for each in others) in words


def test_a_b_with_its_zero_outside_the_unit_circle_and_that_of_21(rows):
    row = rows["section 4", "zero of B, which B(1) replaces"]
    one, other = row.computed.split(", z = ")
    assert float(one.split(" ")[2]) == pytest.approx(-0.0286 / 0.0309, abs=6e-4)
    zero, b1, b2 = (float(re.search(each, other)[1]) for each in
                    (r"([\d.]+) with", r"b1 = (-?[\d.]+)", r"b2 = ([\d.]+)"))  # fmt: skip
    assert zero == pytest.approx(-b2 / b1, abs=0.01) and abs(zero) > 1.0
    found = rows["section 3.2", "how (21) was found"].computed
    assert found.startswith(f"b1 = {b1}, b2 = {b2}")


def test_the_gain_by_least_squares_and_its_standard_error(rows):
    """400 records by SciPy's filter of (8) and NumPy's least squares, d = 5."""
    above, below, _ = cont2discrete(([3.08], 256.0 * np.poly([-0.5] * 8)), 1.0)
    gains = []
    for seed in range(400):
        u = np.random.default_rng(seed).normal(0.0, 0.04, 500)
        y = lfilter(above[0], below, u)
        F = np.column_stack([-y[6:-1], -y[5:-2], u[1:-6], u[:-7]])
        a1, a2, b1, b2 = np.linalg.lstsq(F, y[7:])[0]
        gains.append((b1 + b2) / (1.0 + a1 + a2))
    error = np.std(gains, ddof=1) / 20.0
    words = rows["section 3.2", "least squares against fminsearch"].computed
    mean, _, within = words.split(" ")[1:4]
    assert float(mean) == pytest.approx(np.mean(gains), abs=2.0 * error)
    assert float(within) == pytest.approx(error, abs=5e-3)


def test_the_inflow_swings_on_the_chain_and_not_on_the_model(rows):
    """Under D of second order, (21) with the full predictor has u = r0 A/D w: two real zeros."""
    row = rows["section 5", "second-order polynomial (28)"]
    assert row.computed.endswith("on (8); 1, 0, 0, 0, 0, 0 on (21)")


def by_polynomials(found, samples):
    """Level and inflow of a unit step on (8) by the polynomials and lfilter alone."""
    from scipy.signal import lfilter

    process, model = six_designs.sampled_chain(), six_designs.printed_model()
    Q = np.array([float(q) for q in found.Q])
    K, ahead = np.array([1.0, -1.0]), np.array([0.0, model.B.sum()])
    late = np.concatenate([np.zeros(model.delay), model.B])
    inner = np.polyadd(
        np.convolve(process.A, np.polysub(np.pad(ahead, (0, 6)), late))[::-1],
        np.convolve(model.A, process.B)[::-1],
    )[::-1]
    whole = np.polyadd(
        np.convolve(np.convolve(K, model.A), process.A)[::-1], np.convolve(Q, inner)[::-1]
    )[::-1]
    return tuple(
        lfilter(float(found.feedforward) * np.convolve(part, model.A), whole, np.ones(samples))
        for part in (process.B, process.A)
    )


def test_the_criterion_grows_without_end_after_a_step(rows):
    """The inflow that holds w = 1 is 1/3.08, and costs q_u / 3.08² each minute."""
    found = map(float, rows["(26)", "criterion that the method minimises"].computed.split(", "))
    wanted = [choice.penalty / 3.08**2 for choice in six_designs.SIX]
    assert list(found) == pytest.approx(wanted, rel=6e-3)


def test_the_smallest_sum_has_the_poles_of_the_spectral_factor(rows):
    """By the roots of 10 A A* + B B* that lie inside the unit circle."""
    A, B = np.array([1.0, -1.777, 0.7964]), np.array([0.0, 0.0309, 0.0286])
    roots = np.roots(10.0 * np.convolve(A, A[::-1]) + np.convolve(B, B[::-1]))
    _, d1, d2 = np.poly(roots[np.abs(roots) < 1.0]).real
    row = rows["(27)", "D of the smallest J, with w = 0"]
    assert row.computed == f"d1 = {d1:.6f}, d2 = {d2:.6f} for q_u = 10"


def test_a_model_with_the_right_gain_may_be_a_bad_one(rows):
    """K/(c2 s² + c1 s + 1) behind d minutes, fitted to the step response of (8) by SciPy."""
    minutes = np.arange(81.0)
    chain = gammainc(8.0, minutes / 2.0)

    def errors(c, delay):
        ahead = np.maximum(minutes - delay, 0.0)
        _, response = step(([1.0], [c[1], c[0], 1.0]), T=minutes)
        return np.interp(ahead, minutes, response) - chain

    worst = [
        100.0 * np.max(np.abs(errors(least_squares(errors, (10.0, 30.0), args=(d,)).x, d)))
        for d in (0, 5, 6)
    ]
    said = "; ".join(f"{each:.1f} %" for each in worst)
    words = rows["section 3.2", "static gain as a criterion"].computed
    assert "; ".join(part[: part.index("%") + 1] for part in words.split(", ")) == said


def test_a_controller_for_the_chain_itself_has_more_numbers(rows):
    """Of order n, Q has n + 1 coefficients, P has n − 1 beside its 1, and there is r0."""
    by_hand = ("q0", "q1", "q2", "r0", "a1", "a2", "b1", "b2", "d")
    row = rows["section 7", "relatively simple controllers"]
    assert row.computed == f"{len(by_hand)} against {2 * 8 + 1}"


def swings(values, least):
    """How often a signal goes the other way by more than so much, from its last extreme."""
    count, way, low, high = 0, 0, values[0], values[0]
    for value in values:
        low, high = min(low, value), max(high, value)
        now = (
            1
            if way <= 0 and value - low > least
            else -1
            if way >= 0 and high - value > least
            else 0
        )
        if now:
            count, way, low, high = count + (way != 0), now, value, value
    return count


def test_a_larger_penalty_leaves_no_more_swings(rows):
    """By polynomials alone: of level and inflow, for q_u = 1, 10 and 100 of the row."""
    words = rows["section 5", "oscillations and instability by q_u"].computed
    for pole, said in zip((0.01, 0.5, 0.9), words.split("; γ"), strict=True):
        level, inflow = (
            said.split(f"{name} ")[1].split(";")[0].split(", ")[:3] for name in ("level", "inflow")
        )
        for penalty, of_level, of_inflow in zip((1.0, 10.0, 100.0), level, inflow, strict=True):
            y, u = by_polynomials(controller(penalty, (pole,), full=False), 240)
            assert swings(y, 0.02) == int(of_level), (pole, penalty)
            assert swings(u, 0.02 / 3.08) == int(of_inflow), (pole, penalty)


def settled_by_plain_pid(values, minutes=240):
    """Step response of a sampled PID on the chain, a loop of plain floats: settled to 2 % [min].

    The integral is that of the former samples, the derivative one of the level behind a filter.
    """
    gain, weight = values["level_8.proportional_gain"] * 60.0, values["level_8.setpoint_weight"]
    integral_time = values["level_8.integral_time"] / 60.0
    lead = values["level_8.derivative_time"] / 60.0
    lag = lead / values["level_8.derivative_filter"]
    impulse = np.diff(3.08 * gammainc(8, np.arange(minutes + 1) / 2.0))
    moves, level, integral, filtered = [], np.zeros(minutes), 0.0, 0.0
    for k in range(minutes):
        y = level[k] = sum(u * h for u, h in zip(moves, impulse[:k][::-1], strict=True))
        rate = (y - filtered) / (lag + 1.0)
        filtered += rate
        moves.append(gain * (weight - y - lead * rate) + integral)
        integral += gain / integral_time * (1.0 - y)
    outside = np.flatnonzero(abs(level - 1.0) > 0.02)[-1]
    before, after = abs(level[outside : outside + 2] - 1.0)
    return outside + (before - 0.02) / (before - after)


def test_a_tuned_pid_settles_as_soon_as_the_predictor():
    """The page says no more than that: half the time holds against one rule only."""
    plain, _, predictor, _, pid = others()
    assert (round(predictor.run.settling_time, 1), round(predictor.peak, 2)) == (26.7, 2.0)
    assert (round(pid.run.settling_time, 1), round(pid.peak, 2)) == (26.9, 1.6)
    controllers = robustness.amigo(), robustness.tuned_pid(), robustness.amigo(0.0)
    for each, made in zip((plain, pid, None), controllers, strict=True):
        run = each.run if each else stepped(made)
        assert run.settling_time == pytest.approx(settled_by_plain_pid(made.values), abs=0.1)


def test_every_row_tells_its_reason_and_experiment(rows, found):
    assert sum(len(findings.rows) for findings in found) == len(rows)
    for row in rows.values():
        assert row.reason and row.document == "eight-tanks" and row.experiment


def test_the_figures_of_the_document_are_drawn(found):
    figures = {figure.number for findings in found for figure in findings.figures}
    assert {"Fig. 3", "Fig. 4", *SETTINGS} <= figures
    for findings in found:
        for figure in findings.figures:
            assert figure.note
            for panel in figure.panels:
                for curve in panel.curves:
                    assert np.all(np.isfinite(curve.y)), (figure.title, panel.title)


def test_the_mixed_reading_is_unstable_in_the_first_experiment_only():
    process, model = six_designs.sampled_chain(), six_designs.printed_model()
    for choice in six_designs.SIX:
        settings = choice.penalty, (choice.pole,)
        assert closed_loop_radius(controller(*settings, full=False), model, process) < 1.0
        mixed = closed_loop_radius(controller(*settings, full=True), model, process)
        assert (mixed > 1.0) == (choice.figure == "Fig. 7")


@pytest.mark.parametrize("choice", six_designs.SIX, ids=lambda choice: choice.figure)
def test_margins_by_two_routes(choice):
    """The gain margin of the step law's frequency response, and roots of the polynomials."""
    design = judged(choice.label, six_designs.designed(choice.penalty, (choice.pole,)))
    found, model = (
        controller(choice.penalty, (choice.pole,), full=False),
        six_designs.printed_model(),
    )
    radii = [
        closed_loop_radius(found, model, six_designs.sampled_chain(3.08 * design.gain_margin * off))
        for off in (0.998, 1.002)
    ]
    assert radii[0] < 1.0 < radii[1]


def test_the_step_is_that_of_the_transfer_functions():
    """Fig. 8 by polynomials alone, against the engine with the tanks."""
    level, inflow = by_polynomials(controller(10.0, (0.5,), full=False), 120)
    run = six_designs.step_run(10.0, (0.5,))
    assert run.level[:120] == pytest.approx(level, abs=1e-5)
    assert run.inflow[:120] == pytest.approx(inflow, abs=1e-5)
