"""The targets of a proof: what is run, what it is compared with, and by which bound."""

from __future__ import annotations

import importlib.metadata
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.proof.comparison import (
    Difference,
    compare,
    double_bound,
    is_exact,
    shown_signals,
)
from clepsydra.deploy.proof.compiled_c import CompiledC
from clepsydra.deploy.proof.exchange_target import model_exchange
from clepsydra.deploy.proof.fmu_targets import Measured, co_simulation
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.row import ProofRow, Verdict
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES

#: Largest difference of C in floats and Structured Text in REALs where the law uses functions of
#: a library, as a share of a signal's range: some thousand roundings.
SINGLE_LIBRARY_BOUND = 1e-4


@dataclass(frozen=True)
class Target:
    """One target.

    Parameters
    ----------
    name : str
    precision : {"double", "single"}
    against : str
        What it is compared with.
    version : str
        Of what runs it.
    measure : callable
        Takes a job and returns the difference, the bound (None: there is none), and further
        fields of the row.

    Examples
    --------
    >>> [target.name for target in targets_of("process", Compiler(("cc",), "cc 1.0"))][:2]
    ['C', 'Structured Text, matiec']
    """

    name: str
    precision: Precision
    against: str
    version: str
    measure: Callable[[Job], Measured]

    def row(self, job: Job, blank: ProofRow) -> ProofRow:
        """Run a job on this target and fill its row."""
        difference, bound, more = self.measure(job)
        return replace(
            blank,
            exact=is_exact(job.program),
            largest=difference.largest,
            signal=difference.signal,
            scan=difference.scan,
            differing=difference.differing,
            decisions=difference.decisions,
            bound=bound,
            verdict=_verdict(difference, bound),
            **more,
        )


def targets_of(kind: str, compiler: Compiler) -> list[Target]:
    """Return the targets of a controller or a process.

    Raises
    ------
    InputError
        A package of the proof is missing.
    """
    grammar, importer = _version("tree-sitter-iec61131-3-st"), _version("FMPy")
    found = [Target("C", "double", "engine", compiler.version, _c)]
    found += [
        Target(f"Structured Text, {dialect}", "double", "engine", grammar, _text(dialect))
        for dialect in DIALECT_NAMES
    ]
    found += [
        Target(f"FMU {version}", "double", "engine", importer, co_simulation(version))
        for version in ("3.0", "2.0")
    ]
    if kind == "process":
        exchanged = [
            Target(f"FMU {version} exchange", "double", "CasADi", importer, model_exchange(version))
            for version in ("3.0", "2.0")
        ]
        return [*found, *exchanged]
    return [
        *found,
        Target("Structured Text", "single", "C in single", grammar, _single_text),
        Target("C", "single", "engine in double", compiler.version, _single_c),
    ]


def _version(package: str) -> str:
    try:
        return f"{package} {importlib.metadata.version(package)}"
    except importlib.metadata.PackageNotFoundError:
        raise InputError(
            "proof", f"no package {package}", "all packages of the proof",
            "pip install 'clepsydra[verify]'",
        ) from None  # fmt: skip


def _verdict(difference: Difference, bound: float | None) -> Verdict:
    if difference.differing == 0:
        return "equal"
    if bound is None:
        return "told"
    # Where nothing but exact operations are, the sign of a zero counts too; and a decision that
    # differs is no matter of a bound.
    within = bound > 0.0 and difference.largest <= bound and difference.decisions == 0
    return "within the bound" if within else "differs"


def _c(job: Job) -> Measured:
    instance = CompiledC(job.program, job.folder / "double", compiler=job.compiler)
    found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
    return found, double_bound(job.program), {}


def _text(dialect: str) -> Callable[[Job], Measured]:
    def measure(job: Job) -> Measured:
        instance = InterpretedText(job.program, dialect=dialect)
        found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
        return found, double_bound(job.program), {}

    return measure


def _single_text(job: Job) -> Measured:
    instance = InterpretedText(job.program, "single")
    found = compare(
        shown_signals(job.program), job.run_of_single_c, instance.run(job.single_inputs)
    )
    return found, 0.0 if is_exact(job.program) else SINGLE_LIBRARY_BOUND, {}


def _single_c(job: Job) -> Measured:
    found = compare(shown_signals(job.program), job.engine_of_single, job.run_of_single_c)
    return found, None, _scores(job.item, job)


def _scores(item: ProofItem, job: Job) -> dict[str, Any]:
    """Return what single precision does to the scores, where there is a loop."""
    if item.controller is None or item.point is None:
        return {}
    from clepsydra.deploy.proof.single_loop import score_change
    from clepsydra.linear.linearise import linearise

    try:
        model = linearise(item.point)
        found = score_change(item.controller, model, job.single_c, item.scenario)
    except InputError as refusal:
        return {"reason": f"the scores were not compared: {refusal}"}
    told = {
        "ranking": _finite(found.ranking),
        "score": found.score,
        "change": _finite(found.change),
        "is_change": found.is_change,
    }
    return {"scores": told}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
