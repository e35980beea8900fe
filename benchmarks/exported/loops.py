"""Closed loops as WebAssembly, process and controller in one module, as a page simulates them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.exported.web import WebTimes, measure_one
from clepsydra.designs.applicability import NotApplicable
from clepsydra.engine.kernel import Job, Kernel
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS

_EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
#: A longer scenario is cut: every sample takes as long.
_SAMPLES = 5_000


def measure_loops(rounds: int, tell: Callable[[str], None]) -> list[WebTimes]:
    """Measure a loop of every kind of law on every process of the catalogue and of docs/examples.

    Raises
    ------
    Disagreement
        WebAssembly and engine differ in a bit.
    """
    found: list[WebTimes] = []
    for name in (*catalogue_names(), *sorted(_EXAMPLES.glob("*.toml"))):
        process = load_process(name)
        tell(f"loops of {process.name}")
        found += [measure_one(*each, rounds) for each in loops(analyse(process))]
    return found


def loops(analysis: Analysis) -> Iterator[tuple[str, str, Job]]:
    """Yield a controller of each kind of law, its process, and a run of the loop."""
    model, seen = analysis.model, set()
    scenario = default_scenario(model)
    for name, design in DESIGNS.items():
        try:
            controller = design(analysis)
        except NotApplicable:
            continue
        kind = controller.family, controller.law.name
        if kind in seen:
            continue
        seen.add(kind)
        loop = Loop(controller, model)
        samples = min(scenario.samples, _SAMPLES)
        given = {key: values[:samples] for key, values in loop.inputs_of(scenario).items()}
        fixed = {key: value for key, value in loop.at_rest().items() if key not in given}
        program = closed_loop(loop.process, controller, substeps=loop.substeps, constant=fixed)
        job = Kernel(program, fuse=False).prepare(
            samples, inputs=given, state=loop.initial_state(), parameters=loop.law_parameters()
        )
        yield name, loop.process.name, job
