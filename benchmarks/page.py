"""The tables as text, and their place in the documentation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks import experiments as e
from benchmarks.experiments import Measured
from benchmarks.fuzzy import FuzzyTimes
from benchmarks.measure import Spread
from benchmarks.scale import Growth
from benchmarks.tuning import TuningTimes
from clepsydra.engine.host import host

PAGE = Path(__file__).resolve().parents[1] / "docs" / "benchmarks.md"
BEGIN = "<!-- measured: begin -->"
END = "<!-- measured: end -->"


@dataclass(frozen=True)
class Results:
    """Everything that was measured on one machine."""

    machine: list[tuple[str, str]]
    rounds: str
    batch: Measured
    one_run: Measured
    two_cores: Measured
    first_call: Measured
    command_line: Measured
    chains: dict[int, Growth]
    catalogue: list[Growth]
    tuning: dict[float, TuningTimes]
    fuzzy: FuzzyTimes


@dataclass(frozen=True)
class _Figure:
    """A figure that was aimed at, and what came of it."""

    text: str
    wanted: str
    found: Spread
    digits: int
    met: Callable[[float], bool]

    def row(self) -> list[str]:
        verdict = "yes" if self.met(self.found.median) else "**no**"
        return [self.text, self.wanted, with_spread(self.found, self.digits), verdict]


def with_spread(spread: Spread, digits: int) -> str:
    """Return a median with the smallest and the largest value in brackets."""
    median, low, high = (f"{v:,.{digits}f}" for v in (spread.median, spread.low, spread.high))
    return f"{median} ({low} to {high})"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table whose columns stand below each other in the text as well."""
    body = [list(heads), *map(list, rows)]
    widths = [max(len(row[column]) for row in body) for column in range(len(heads))]

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(c.ljust(w) for c, w in zip(cells, widths, strict=True)) + " |"

    rule = "|" + "|".join("-" * (width + 2) for width in widths) + "|"
    return "\n".join([line(heads), rule, *map(line, rows)])


def _timed(
    measured: Measured,
    heads: tuple[str, str],
    shown: Callable[[Spread], Spread],
    digits: int,
    *,
    reference: str,
    faster: bool,
) -> str:
    rows = []
    for name in measured.timings.seconds:
        ratio = measured.timings.ratio(*((reference, name) if faster else (name, reference)))
        label = f"{name} ({measured.notes[name]})" if name in measured.notes else name
        rows.append(
            [label, with_spread(shown(measured.timings.of(name)), digits), with_spread(ratio, 2)]
        )
    return table(["way", *heads], rows)


def _figures(r: Results) -> list[_Figure]:
    batch, run = r.batch.timings, r.one_run.timings
    cores, waits = r.two_cores.timings, r.command_line.timings
    speed, time = (1.25, 0.8) if host().refines else (1.0, 1.0)
    where = "with AVX-512" if host().refines else "without AVX-512"
    return [
        _Figure("batch, speed over C++ by hand", f"at least {speed:g} {where}",
                batch.ratio(e.CPP, e.ENGINE), 2, lambda v: v >= speed),
        _Figure("batch, speed over JAX", "at least 1.6",
                batch.ratio(e.JAX, e.ENGINE), 2, lambda v: v >= 1.6),
        _Figure("one run, time over C++ by hand", "at most 1.25",
                run.ratio(e.ENGINE, e.CPP), 2, lambda v: v <= 1.25),
        _Figure("the same, whole call", "at most 1.4",
                run.ratio(e.WHOLE, e.CPP), 2, lambda v: v <= 1.4),
        _Figure("large batch on two cores, time over C++ by hand", f"at most {time:g} {where}",
                cores.ratio(e.ENGINE, e.CPP), 2, lambda v: v <= time),
        _Figure("one run, whole call, speed over python-control's fastest form", "at least 300",
                run.ratio(e.ONE_SYSTEM, e.WHOLE), 0, lambda v: v >= 300),
        _Figure("one run, whole call, speed over python-control's usual form", "at least 300",
                run.ratio(e.JOINED, e.WHOLE), 0, lambda v: v >= 300),
        _Figure("large batch on two cores [s]", "under 1.5",
                cores.of(e.WHOLE), 2, lambda v: v < 1.5),
        _Figure("first table of study, new machine [s]", "under 5",
                waits.of(e.NEW_MACHINE), 2, lambda v: v < 5),
        _Figure("first table of study, second time [s]", "under 2",
                waits.of(e.SECOND_TIME), 2, lambda v: v < 2),
        *_tuning_figures(r.tuning),
        *_fuzzy_figures(r.fuzzy),
    ]  # fmt: skip


def _tuning_figures(tuning: dict[float, TuningTimes]) -> list[_Figure]:
    return [
        _Figure(f"tuning at {1e3 * period:g} ms, {what}, speed over SciPy", "at least 100",
                found.seconds.inverse(times.scipy.seconds.median), 0, lambda v: v >= 100)
        for period, times in tuning.items()
        for what, found in (("the same local search", times.local), ("all bounds", times.whole))
    ]  # fmt: skip


def _fuzzy_figures(fuzzy: FuzzyTimes) -> list[_Figure]:
    return [
        _Figure("fuzzy control, 27 rules to three centroids [million a second and core]",
                "at least 10", fuzzy.inference.inverse(1e-6), 1, lambda v: v >= 10),
    ]  # fmt: skip


def _rounded(factor: float) -> str:
    return f"{factor:,.0f}" if factor >= 100 else f"{factor:.3g}"


def _comparison(subject: str, speed: float, other: str) -> str:
    if speed >= 1:
        return f"- **Win.** {subject}: {_rounded(speed)} times as fast as {other}."
    return f"- **Loss.** {subject}: {speed:.2f} of the speed of {other}."


def _wins_and_losses(r: Results) -> str:
    batch, run, first = r.batch.timings, r.one_run.timings, r.first_call.timings
    lines = [
        _comparison("Batch", batch.ratio(e.CPP, e.ENGINE).median, "C++ by hand"),
        _comparison("Batch", batch.ratio(e.GUARDED, e.ENGINE).median, "C++ with all guards"),
        _comparison("Batch", batch.ratio(e.REFINED_ROOTS, e.ENGINE).median,
                    "C++ without guards and with some roots by multiply-adds"),
        _comparison("Batch, arguments to results", batch.ratio(e.CPP, e.WHOLE).median, "C++ alone"),
        _comparison("Batch", batch.ratio(e.JAX, e.ENGINE).median, "JAX"),
        _comparison("One run", run.ratio(e.CPP, e.ENGINE).median, "C++ by hand"),
        _comparison("One run", run.ratio(e.GUARDED, e.ENGINE).median, "C++ with all guards"),
        _comparison("One run, arguments to results", run.ratio(e.CPP, e.WHOLE).median, "C++ alone"),
        _comparison("One run, arguments to results", run.ratio(e.ONE_SYSTEM, e.WHOLE).median,
                    "python-control in its fastest form"),
        _comparison("One run, arguments to results", run.ratio(e.JOINED, e.WHOLE).median,
                    "python-control as two joined systems"),
        _comparison("First call", first.of(e.CPP).median / first.of(e.FRESH).median,
                    "the C++ compiler"),
        _comparison("First call", first.of(e.JAX).median / first.of(e.FRESH).median, "JAX"),
    ]  # fmt: skip
    return "\n".join(sorted(lines, key=lambda line: "Loss" in line))


def render(r: Results) -> str:
    """Return all tables as Markdown."""
    steps = r.batch.steps

    def largest(measured: Measured) -> str:
        return f"Largest relative difference between the ways: {measured.difference:.0e}."

    first, waits = r.first_call.timings, r.command_line.timings
    parts = [
        table(["", ""], r.machine),
        f"Median over {r.rounds}, smallest and largest in brackets. Ratios are taken within "
        "each round. All ways that stand in one table gave the same answer.",
        "### The figures aimed at",
        table(["figure", "wanted", "measured", "met"], [f.row() for f in _figures(r)]),
        "### Wins and losses",
        _wins_and_losses(r),
        "### Batch of 8,192 scenarios and 1,000 samples, one core",
        _timed(r.batch, ("million scenario-steps a second", "speed over C++"),
               lambda s: s.inverse(steps / 1e6), 1, reference=e.CPP, faster=True),
        largest(r.batch),
        "### One run of 10,000 samples, recorded",
        _timed(r.one_run, ("ns a sample", "time over C++"),
               lambda s: s.times(1e9 / r.one_run.steps), 1, reference=e.CPP, faster=False),
        largest(r.one_run),
        "### 100,000 scenarios and 1,000 samples, two cores",
        _timed(r.two_cores, ("seconds", "time over C++"),
               lambda s: s, 3, reference=e.CPP, faster=False),
        largest(r.two_cores),
        "### First call: from source to the answer of the batch, imports excluded",
        table(["way", "seconds"], [[n, with_spread(first.of(n), 2)] for n in first.seconds]),
        "### The command line",
        table(
            ["`clepsydra`", "seconds"],
            [[name, with_spread(waits.of(name), 2)] for name in waits.seconds],
        ),
        "### Chains of tanks: each drains into the next, one RK4 step a sample, one core",
        _chains(r.chains),
        "### Processes of the catalogue, inputs given, as many RK4 steps as each needs, one core",
        _catalogue(r.catalogue),
        "### Minimax tuning of two PI loops of the averaging tank, from process file to answer, "
        "one core",
        _tuning(r.tuning),
        "### Fuzzy control: 27 rules, three outputs, centroids on 101 points, one core",
        _fuzzy(r.fuzzy),
    ]  # fmt: skip
    return "\n\n".join(parts)


def _chains(chains: dict[int, Growth]) -> str:
    heads = ["tanks", "operations", "read the file [s]", "write the program [s]", "compile [s]",
             "one run [ns a tank and step]", "batch [ns a tank and scenario-step]"]  # fmt: skip
    rows = [
        [
            f"{tanks:,}", f"{g.operations:,}", f"{g.load:.2f}", f"{g.write:.2f}",
            f"{g.compile:.2f}", with_spread(g.one_run.times(1e9 / tanks), 1),
            with_spread(g.batch.times(1e9 / tanks), 2),
        ]
        for tanks, g in chains.items()
    ]  # fmt: skip
    return table(heads, rows)


def _catalogue(found: list[Growth]) -> str:
    heads = ["process", "operations", "RK4 steps a sample", "compile [s]", "one run [ns a sample]",
             "batch [million scenario-steps a second]", "difference"]  # fmt: skip
    rows = [
        [
            g.name, f"{g.operations:,}", str(g.substeps), f"{g.compile:.2f}",
            with_spread(g.one_run.times(1e9), 0), with_spread(g.batch.inverse(1e-6), 1),
            f"{g.difference:.0e}",
        ]
        for g in found
    ]  # fmt: skip
    return "\n\n".join(
        [
            table(heads, rows),
            "The difference is that from CVODES after ten samples, the first state displaced "
            "by a twentieth; what is left is the error of the RK4 steps.",
        ]
    )


def _tuning(tuning: dict[float, TuningTimes]) -> str:
    heads = ["sampling period or largest step", "way", "simulations", "seconds", "larger IAE"]
    rows = []
    for period, times in tuning.items():
        for way, found in (
            ("SciPy, SLSQP with LSODA", times.scipy),
            ("Clepsydra, local search alone", times.local),
            ("Clepsydra, global and local search", times.whole),
        ):
            rows.append(
                [
                    f"{1e3 * period:g} ms", way, f"{found.simulations:,}",
                    with_spread(found.seconds, 2), f"{found.objective:.5f}",
                ]
            )  # fmt: skip
    one = ", ".join(
        f"{with_spread(times.one_simulation, 3)} s at {1e3 * period:g} ms"
        for period, times in tuning.items()
    )
    return "\n\n".join([table(heads, rows), f"One simulation by LSODA, called from Python: {one}."])


def _fuzzy(fuzzy: FuzzyTimes) -> str:
    rows = [
        ["Clepsydra, inference, batch", with_spread(fuzzy.inference.times(1e9), 1)],
        ["Clepsydra, whole step law, batch", with_spread(fuzzy.law.times(1e9), 1)],
    ]
    words = f"Largest difference to plain Python, of an output's range: {fuzzy.difference:.0e}."
    if fuzzy.scikit_fuzzy is not None:
        rows.append(["scikit-fuzzy", with_spread(fuzzy.scikit_fuzzy.times(1e9), 0)])
        words += (
            " scikit-fuzzy takes the centroid below straight lines between the points; to that "
            f"its difference is {fuzzy.scikit_difference:.0e}."
        )
    return "\n\n".join([table(["way", "ns an evaluation"], rows), words])


def write(text: str, page: Path = PAGE, marks: tuple[str, str] = (BEGIN, END)) -> None:
    """Put the tables between the marks of the page; everything else on it stays.

    Raises
    ------
    ValueError
        The page lacks the marks.
    """
    opening, closing = marks
    before, begin, rest = page.read_text(encoding="utf-8").partition(opening)
    _, end, after = rest.partition(closing)
    if not begin or not end:
        raise ValueError(f"{page} lacks the marks {opening} and {closing}")
    page.write_text(f"{before}{opening}\n{text}\n{closing}{after}", encoding="utf-8")
