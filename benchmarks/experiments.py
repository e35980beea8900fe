"""What is measured: each function checks that all ways agree, then times them."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from benchmarks import with_clepsydra, with_jax, with_python_control
from benchmarks.case import Case, Solution, largest_difference, make_case, solve
from benchmarks.command_line import wait_for
from benchmarks.cplusplus import REFINED, VECTOR_COUNTS, CPlusPlus, Kind, recording_arrays
from benchmarks.measure import Timings, Way, interleave, on_one_core
from benchmarks.with_clepsydra import Clepsydra
from clepsydra.engine.object_cache import ObjectCache

#: Largest relative difference between two ways that counts as the same answer.
AGREEMENT = 1e-9

CPP = "C++ by hand"
GUARDED = "C++ by hand, with all guards"
REFINED_ROOTS = "C++ by hand, some roots by multiply-adds"
ENGINE = "Clepsydra, laid out beforehand"
WHOLE = "Clepsydra, whole call"
JAX = "JAX, vmap of a scan"
ROOTS = "the square roots alone"
ONE_SYSTEM = "python-control, one system in plain Python"
JOINED = "python-control, two systems joined"
FRESH = "Clepsydra, nothing cached"
CACHED = "Clepsydra, kernel from disk"
NEW_MACHINE = "study quadruple-tank, new machine, first table"
NEW_MACHINE_DONE = "study quadruple-tank, new machine, report written"
SECOND_TIME = "study quadruple-tank, second time, first table"
SECOND_TIME_DONE = "study quadruple-tank, second time, report written"
HELP = "--help"


class Disagreement(Exception):
    """Two ways gave different answers, so their times cannot be compared."""


@dataclass(frozen=True)
class Size:
    """How much is measured."""

    rounds: int
    slow_rounds: int
    long_rounds: int
    scenarios: int = 8_192
    samples: int = 1_000
    run_samples: int = 10_000
    large_scenarios: int = 100_000
    operations: int = 20_000_000
    many_draws: int = 1_000_000


FULL = Size(rounds=15, slow_rounds=5, long_rounds=3)
QUICK = Size(rounds=3, slow_rounds=1, long_rounds=1, operations=2_000_000, many_draws=100_000)


@dataclass(frozen=True)
class Measured:
    """One table: timings, the steps that they are for, and the largest difference seen."""

    timings: Timings
    steps: int
    difference: float
    notes: dict[str, str] = field(default_factory=dict)


def agree(answers: Mapping[str, Solution], expected: Solution) -> float:
    """Return the largest relative difference of answers to the one expected.

    Raises
    ------
    Disagreement
        It is no agreement.
    """
    differences = {name: largest_difference(s, expected) for name, s in answers.items()}
    for name, difference in differences.items():
        if not difference <= AGREEMENT:
            raise Disagreement(f"{name} differs from the other ways by {difference:.1e}")
    return max(differences.values())


class Experiments:
    """The experiments on one machine.

    Parameters
    ----------
    size : Size
    folder : Path
        Where programs are built and objects are cached; empty at the start.
    """

    def __init__(self, size: Size, folder: Path) -> None:
        self.size = size
        self.folder = folder
        self.program = CPlusPlus.build(folder)
        self.cache = ObjectCache(folder / "kernels")

    def batch(self) -> Measured:
        """A batch on one core: every scenario has its own parameters, nothing is recorded."""
        case = make_case(self.size.scenarios, self.size.samples)
        with on_one_core():
            kinds = {CPP: [Kind.BARE], GUARDED: [Kind.GUARDED], REFINED_ROOTS: REFINED}
            best = {name: self._best(case, of) for name, of in kinds.items()}
            clepsydra = Clepsydra.build(self.cache, record=False)
            job, arguments = clepsydra.prepare(case), clepsydra.arguments(case)
            jax = with_jax.batch(case)
            by_hand = {
                name: partial(self.program.batch, case, vectors, kind=kind)
                for name, (kind, vectors) in best.items()
            }
            answers = {
                **{name: run() for name, run in by_hand.items()},
                ENGINE: with_clepsydra.solution(job.run()),
                JAX: jax(),
            }
            difference = agree(answers, solve(case))
            ways = [
                *(Way(name, run) for name, run in by_hand.items()),
                Way(ENGINE, job.run),
                Way(WHOLE, lambda: with_clepsydra.solution(clepsydra.kernel.run(**arguments))),
                Way(JAX, jax),
                Way(ROOTS, lambda: self.program.roots_alone(case.scenario_steps)),
            ]
            timings = interleave(ways, self.size.rounds)
        lanes = {name: self.program.lanes(vectors) for name, (_, vectors) in best.items()}
        lanes[ENGINE] = job.lanes
        notes = {name: f"{count} scenarios side by side" for name, count in lanes.items()}
        return Measured(timings, case.scenario_steps, difference, notes)

    def one_run(self) -> Measured:
        """One run that records levels and voltages in every sample, on one core."""
        case = make_case(1, self.size.run_samples)
        recorded, final = recording_arrays(case)
        with on_one_core():
            clepsydra = Clepsydra.build(self.cache, record=True)
            job, arguments = clepsydra.prepare(case), clepsydra.arguments(case)
            one_system = with_python_control.one_system(case)
            joined = with_python_control.joined_systems(case)
            answers = {
                CPP: self.program.single(case, recorded, final),
                GUARDED: self.program.single(case, *recording_arrays(case), kind=Kind.GUARDED),
                ENGINE: with_clepsydra.solution(job.run()),
                ONE_SYSTEM: one_system(),
                JOINED: joined(),
            }
            difference = agree(answers, solve(case))
            ways = [
                Way(CPP, lambda: self.program.single(case, recorded, final), calls=100),
                Way(
                    GUARDED,
                    lambda: self.program.single(case, recorded, final, kind=Kind.GUARDED),
                    calls=100,
                ),
                Way(ENGINE, job.run, calls=100),
                Way(WHOLE, lambda: clepsydra.kernel.run(**arguments), calls=100),
                Way(ONE_SYSTEM, one_system),
                Way(JOINED, joined),
            ]
            timings = interleave(ways, self.size.rounds)
        notes = {
            CPP: "records 6 signals",
            ENGINE: f"records {len(clepsydra.kernel.program.outputs)} signals",
        }
        return Measured(timings, case.scenario_steps, difference, notes)

    def two_cores(self) -> Measured:
        """A large batch on two threads."""
        case = make_case(self.size.large_scenarios, self.size.samples)
        with on_one_core():
            few = make_case(self.size.scenarios, self.size.samples)
            _, vectors = self._best(few, [Kind.BARE])
        clepsydra = Clepsydra.build(self.cache, record=False)
        job, arguments = clepsydra.prepare(case), clepsydra.arguments(case)
        found = {
            CPP: self.program.batch(case, vectors, threads=2),
            ENGINE: with_clepsydra.solution(job.run(threads=2)),
        }
        # NumPy would take minutes for all of them: it solves each hundredth scenario.
        hundredth = slice(None, None, 100)
        answers = {name: Solution(answer.final[:, hundredth]) for name, answer in found.items()}
        difference = agree(answers, solve(case.chosen(hundredth)))
        ways = [
            Way(CPP, lambda: self.program.batch(case, vectors, threads=2)),
            Way(ENGINE, lambda: job.run(threads=2)),
            Way(
                WHOLE,
                lambda: with_clepsydra.solution(clepsydra.kernel.run(**arguments, threads=2)),
            ),
        ]
        return Measured(interleave(ways, self.size.slow_rounds), case.scenario_steps, difference)

    def first_call(self) -> Measured:
        """From source to the first answer of the batch, imports excluded."""
        case = make_case(self.size.scenarios, self.size.samples)

        def build_cpp() -> Solution:
            with tempfile.TemporaryDirectory() as folder:
                return CPlusPlus.build(Path(folder), every_kind=False).batch(case, 2)

        kernels = self.folder / "first-call"
        ways = [
            Way(CPP, build_cpp),
            Way(FRESH, with_clepsydra.first_call(case, kernels, cached=False)),
            Way(JAX, lambda: with_jax.batch(case)()),
        ]
        cached = [Way(CACHED, with_clepsydra.first_call(case, kernels, cached=True))]
        with on_one_core():
            timings = interleave(ways, self.size.slow_rounds, warm_up=False)
            again = interleave(cached, self.size.slow_rounds)
        return Measured(Timings(timings.seconds | again.seconds), case.scenario_steps, 0.0)

    def command_line(self) -> Measured:
        """What a user waits for, each time in a process of its own."""
        study = ["study", "quadruple-tank"]
        seconds: dict[str, list[float]] = {
            name: []
            for name in (NEW_MACHINE, NEW_MACHINE_DONE, SECOND_TIME, SECOND_TIME_DONE, HELP)
        }
        for _ in range(self.size.slow_rounds):
            with tempfile.TemporaryDirectory() as home, tempfile.TemporaryDirectory() as place:
                folder = Path(place)
                first = wait_for(study, Path(home), folder)
                second = wait_for(study, Path(home), folder)
                shown = wait_for(["--help"], Path(home), folder)
            seconds[NEW_MACHINE].append(first.first_line)
            seconds[NEW_MACHINE_DONE].append(first.done)
            seconds[SECOND_TIME].append(second.first_line)
            seconds[SECOND_TIME_DONE].append(second.done)
            seconds[HELP].append(shown.done)
        return Measured(Timings(seconds), 1, 0.0)

    def _best(self, case: Case, kinds: Sequence[Kind]) -> tuple[Kind, int]:
        """Return which kind, with how many vectors side by side, is fastest in C++ here."""
        choices = {f"{kind} {n}": (kind, n) for kind in kinds for n in VECTOR_COUNTS}
        ways = [
            Way(name, partial(self.program.batch, case, n, kind=kind))
            for name, (kind, n) in choices.items()
        ]
        timings = interleave(ways, 3)
        return choices[min(choices, key=lambda name: timings.of(name).median)]
