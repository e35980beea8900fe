"""The ways that the benchmarks time give the same answer, by routes that share no code."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tools import need

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks import page, ratios, with_clepsydra, with_python_control
from benchmarks.case import (
    FINAL,
    HIGH_LIMIT,
    RECORDED,
    STEP_SAMPLE,
    Case,
    Solution,
    largest_difference,
    make_case,
    solve,
)
from benchmarks.cplusplus import REFINED, VECTOR_COUNTS, CPlusPlus, Kind, recording_arrays
from benchmarks.draws import page as draws_page
from benchmarks.draws import times as draw_times
from benchmarks.draws.memory import peak_of
from benchmarks.draws.problem import Problem, problem
from benchmarks.draws.times import DrawTimes
from benchmarks.experiments import AGREEMENT, QUICK
from benchmarks.measure import Spread, Timings, Way, interleave
from benchmarks.programs.problems import TankControl, random_problems
from benchmarks.programs.solvers import OfClepsydra, by_casadi
from benchmarks.studies.homes import with_kernels_alone
from clepsydra.scores.score import SCORES

ONE_RUN = make_case(1, 400)
BATCH = make_case(53, 400)


@pytest.fixture(autouse=True)
def scores_of_the_benchmarks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no later test of this process meet the score that a benchmark registers."""
    monkeypatch.setattr(SCORES, "_things", dict(SCORES))


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> CPlusPlus:
    if shutil.which("g++") is None:
        pytest.skip("no C++ compiler here")
    return CPlusPlus.build(tmp_path_factory.mktemp("program"))


def test_without_a_step_the_case_stays_at_rest() -> None:
    setpoints = np.tile(ONE_RUN.setpoints[0], (200, 1))
    rest = solve(Case(ONE_RUN.parameters, setpoints, ONE_RUN.initial_levels))
    expected = np.tile([*ONE_RUN.initial_levels, 3.0, 3.0], (200, 1))
    assert rest.recorded is not None
    np.testing.assert_allclose(rest.recorded, expected, rtol=1e-13)


def test_the_step_drives_a_pump_into_its_limit_and_the_loop_settles_at_the_setpoints() -> None:
    found = solve(make_case(1, 3_000))
    assert found.recorded is not None
    pump_1 = found.recorded[:, RECORDED.index("pump_1")]
    assert pump_1[STEP_SAMPLE - 1] == pytest.approx(3.0)
    assert pump_1[STEP_SAMPLE] == HIGH_LIMIT
    np.testing.assert_allclose(50.0 * found.recorded[-1, :2], ONE_RUN.setpoints[-1], rtol=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("vectors", VECTOR_COUNTS)
@pytest.mark.parametrize("kind", Kind)
def test_cplusplus_batch_equals_numpy(program: CPlusPlus, vectors: int, kind: Kind) -> None:
    assert largest_difference(program.batch(BATCH, vectors, kind=kind), solve(BATCH)) < AGREEMENT


@pytest.mark.thorough
@pytest.mark.parametrize("kind", REFINED)
def test_refined_roots_change_no_bit(program: CPlusPlus, kind: Kind) -> None:
    bare, refined = (program.batch(BATCH, 2, kind=each).final for each in (Kind.BARE, kind))
    np.testing.assert_array_equal(bare, refined)


@pytest.mark.thorough
def test_cplusplus_threads_change_no_bit(program: CPlusPlus) -> None:
    one, two = (program.batch(BATCH, 2, threads=threads).final for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


@pytest.mark.thorough
def test_roots_alone_are_roots(program: CPlusPlus) -> None:
    # Every chain goes to the x with x = sqrt(x) + 0.1, that is (x - 0.1)^2 = x.
    np.testing.assert_allclose(program.roots_alone(10_000), 0.6 + np.sqrt(0.35), rtol=1e-14)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", [Kind.BARE, Kind.GUARDED])
def test_cplusplus_single_run_equals_numpy(program: CPlusPlus, kind: Kind) -> None:
    found = program.single(ONE_RUN, *recording_arrays(ONE_RUN), kind=kind)
    assert largest_difference(found, solve(ONE_RUN)) < AGREEMENT


@pytest.mark.parametrize("case", [ONE_RUN, BATCH], ids=["one run", "batch"])
def test_clepsydra_equals_numpy(case: Case, tmp_path: Path) -> None:
    run = with_clepsydra.first_call(case, tmp_path / "kernels", cached=True)
    found = with_clepsydra.solution(run())
    assert (found.recorded is not None) == (case is ONE_RUN)
    assert largest_difference(found, solve(case)) < AGREEMENT


@pytest.mark.parametrize(
    "form", [with_python_control.one_system, with_python_control.joined_systems]
)
@pytest.mark.filterwarnings("ignore")
def test_python_control_equals_numpy(form: object) -> None:
    assert callable(form)
    assert largest_difference(form(ONE_RUN)(), solve(ONE_RUN)) < AGREEMENT


@pytest.mark.filterwarnings("ignore")
def test_jax_equals_numpy() -> None:
    need("jax")
    from benchmarks import with_jax

    assert largest_difference(with_jax.batch(BATCH)(), solve(BATCH)) < AGREEMENT


def test_every_round_times_every_way_in_rotating_order() -> None:
    calls: list[str] = []
    ways = [Way(name, lambda name=name: calls.append(name)) for name in "abc"]
    timings = interleave(ways, 3, warm_up=False)
    assert "".join(calls) == "abcbcacab"
    assert all(len(seconds) == 3 for seconds in timings.seconds.values())


def test_ratios_pair_the_rounds() -> None:
    timings = Timings({"a": [1.0, 20.0, 3.0], "b": [2.0, 10.0, 6.0]})
    ratio = timings.ratio("a", "b")
    assert (ratio.median, ratio.low, ratio.high) == (0.5, 0.5, 2.0)


def test_the_page_keeps_everything_outside_its_marks(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    path.write_text(f"before\n{page.BEGIN}\nold\n{page.END}\nafter\n", encoding="utf-8")
    page.write("new", path)
    assert path.read_text(encoding="utf-8") == (f"before\n{page.BEGIN}\nnew\n{page.END}\nafter\n")
    path.write_text("no marks", encoding="utf-8")
    with pytest.raises(ValueError, match="lacks the marks"):
        page.write("new", path)


def test_a_home_with_kernels_alone_has_nothing_else_that_clepsydra_kept(tmp_path: Path) -> None:
    kept = tmp_path / "used" / ".cache" / "clepsydra"
    with_clepsydra.first_call(ONE_RUN, kept / "kernels", cached=True)()
    (kernel,) = (kept / "kernels").iterdir()
    (kept / "kernels" / "design.o").write_bytes(b"{}")
    (kept / "designs").mkdir()
    (kept / "designs" / "lqi").write_bytes(bytes(1000) + kernel.read_bytes())
    fonts = tmp_path / "used" / ".cache" / "matplotlib" / "fonts.json"
    fonts.parent.mkdir()
    fonts.write_text("{}", encoding="utf-8")
    (tmp_path / "fresh").mkdir()
    (tmp_path / "fresh" / "left").touch()
    home = with_kernels_alone(tmp_path / "used", tmp_path / "fresh")
    files = {path.name: path.read_bytes() for path in home.rglob("*") if path.is_file()}
    assert files == {kernel.name: kernel.read_bytes(), "fonts.json": b"{}"}
    assert (kept / "kernels" / "design.o").exists()


def test_each_ratio_is_of_two_calls_that_do_something() -> None:
    found = ratios.measure(1)
    assert all(each.seen.median > 0.0 for each in found)
    assert len({each.name for each in found}) == len(found)


def test_a_ratio_above_what_is_wanted_is_told() -> None:
    row = ratios.Ratio("this", "that", 2.0, Spread(3.0, 1.0, 4.0)).row()
    assert row == "| this | that | 2 | 3 [1, 4] | no |"


def test_the_program_of_the_tanks_is_their_control_ahead() -> None:
    """Its cost and its rows are those of levels simulated from sample to sample."""
    control, random = TankControl(), np.random.default_rng(3)
    a, b = control.model
    levels, on = random.normal(size=4), random.normal(size=2)
    hessian, linear, rows, bounds = control.problem(levels, on)

    def simulated(voltages: np.ndarray) -> tuple[float, np.ndarray]:
        x, before, cost, outputs = levels, on, 0.0, []
        for now in voltages.reshape(-1, 2):
            x = a @ x + b @ now
            cost += np.sum((x[:2] - control.setpoint) ** 2)
            cost += control.movement * np.sum((now - before) ** 2)
            before = now
            outputs.append(x[:2])
        return cost, np.concatenate(outputs)

    at_rest, _ = simulated(np.zeros(10))
    for voltages in random.normal(size=(5, 10)):
        cost, outputs = simulated(voltages)
        found = voltages @ hessian @ voltages / 2 + linear @ voltages
        assert found == pytest.approx(cost - at_rest, rel=1e-9)
        high, low = control.highest_voltage, control.highest_level
        room = [high - voltages, high + voltages, low - outputs, low + outputs]
        np.testing.assert_allclose(bounds - rows @ voltages, np.concatenate(room), rtol=1e-9)


def test_the_solvers_of_quadratic_programs_agree() -> None:
    problems = random_problems(3, 6, 5)
    ours = OfClepsydra(problems, 2).solve()
    np.testing.assert_allclose(ours, by_casadi(problems, "daqp", {})(), rtol=1e-6)


@pytest.fixture(scope="module")
def drawn() -> Problem:
    return problem(20, 600)  # samples enough for both steps


@pytest.fixture(scope="module")
def drawn_case(drawn: Problem) -> Case:
    values = drawn.values()
    return drawn.case(values, drawn.equilibria(values))


def sums(found: Solution) -> np.ndarray:
    return found.final[[FINAL.index(f"integral_absolute_error_{loop}") for loop in (1, 2)]]


def test_drawn_loops_begin_where_the_printed_equations_rest(drawn_case: Case) -> None:
    still = np.tile(drawn_case.setpoints[0], (50, 1))
    found = solve(replace(drawn_case, setpoints=still)).final
    assert drawn_case.individual is not None
    np.testing.assert_allclose(found[:6], drawn_case.individual[2:], rtol=1e-9)
    assert np.ptp(found[:6], axis=1).min() > 0.0


def test_drawn_loops_equal_numpy_without_noise(drawn: Problem, drawn_case: Case) -> None:
    np.testing.assert_allclose(drawn.sums(drawn.quiet), sums(solve(drawn_case)), rtol=AGREEMENT)


def test_drawn_loops_equal_numpy_with_the_same_noise(drawn: Problem, drawn_case: Case) -> None:
    noise = drawn.noise(drawn.numbers)
    assert noise.std() == pytest.approx(drawn.deviation, rel=0.02)  # of 24,000 numbers
    expected = sums(solve(drawn_case, noise))
    np.testing.assert_allclose(drawn.sums(drawn.noisy), expected, rtol=AGREEMENT)
    assert np.all(expected != sums(solve(drawn_case)))


@pytest.mark.filterwarnings("ignore")
def test_draws_in_jax_equal_numpy(drawn: Problem, drawn_case: Case) -> None:
    need("jax")
    from benchmarks.draws.with_jax import DrawsInJax

    found = DrawsInJax(drawn_case, drawn.deviation)
    assert drawn_case.individual is not None
    np.testing.assert_allclose(found.rest(), drawn_case.individual[2:], rtol=AGREEMENT)
    assert largest_difference(found.quiet(), solve(drawn_case)) < AGREEMENT
    noise = found.noise(drawn_case.scenarios, drawn_case.samples)
    assert noise.std() == pytest.approx(drawn.deviation, rel=0.02)
    assert largest_difference(found.noisy(), solve(drawn_case, noise)) < AGREEMENT


@pytest.mark.thorough
@pytest.mark.parametrize("kind", [Kind.BARE, Kind.GUARDED])
def test_cplusplus_takes_sensors_and_starts_of_each_scenario(
    program: CPlusPlus, drawn_case: Case, kind: Kind
) -> None:
    found = program.batch(drawn_case, 2, kind=kind)
    assert largest_difference(found, solve(drawn_case)) < AGREEMENT


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore")
def test_the_section_of_draws_times_every_way_and_tells_what_was_wanted(tmp_path: Path) -> None:
    need("jax")
    if shutil.which("g++") is None:
        pytest.skip("no C++ compiler here")
    few = replace(QUICK, scenarios=20, large_scenarios=200, samples=600, many_draws=20)
    found = draw_times.measure(few, tmp_path)
    assert found.resting < AGREEMENT and found.difference < AGREEMENT
    text = draws_page.render(found, [("Processor", "this")], 1)
    assert all(f"| {way} " in text for way in found.timings.seconds)
    assert "200 draws of 600 samples" in text


def test_the_figures_of_draws_are_judged_by_their_limits() -> None:
    """Of C++'s 10 s: at a limit is met, beyond it is not."""
    met = {
        draw_times.CPP: 10.0, draw_times.QUIET: 16.0, draw_times.NOISY: 22.0,
        draw_times.REST: 5.0, draw_times.JAX: 16.0, draw_times.JAX_NOISY: 22.0,
    }  # fmt: skip
    slower = {
        draw_times.CPP: 10.0, draw_times.QUIET: 16.1, draw_times.NOISY: 22.1,
        draw_times.REST: 5.1, draw_times.JAX: 16.0, draw_times.JAX_NOISY: 22.0,
    }  # fmt: skip
    for seconds, peak, said in ((met, 2**30 - 1, "yes"), (slower, 2**30, "**no**")):
        timings = Timings({way: [each] for way, each in seconds.items()})
        text = draws_page.render(DrawTimes(timings, 100, 1000, 0.0, 0.0, peak, 1000), [], 1)
        rows = [line.split("|") for line in text.splitlines() if line.count("|") == 5]
        verdicts = [row[-2].strip() for row in rows if {"at", "under"} & set(row[2].split())]
        assert verdicts == [said] * 6


@pytest.mark.thorough
def test_the_peak_memory_of_draws_is_not_that_of_who_asks() -> None:
    held = np.ones(2**27)  # 1 GiB
    assert 2**25 < peak_of(20, 600) < held.nbytes
