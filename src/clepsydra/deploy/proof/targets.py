"""The targets of a proof: what is run, what it is compared with, and by which bound."""

from __future__ import annotations

import importlib.metadata
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

from clepsydra.base.arguments import sequence_of
from clepsydra.base.errors import InputError
from clepsydra.deploy.c99.printer import CSource
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.proof.comparison import (
    Difference,
    compare,
    double_bound,
    is_exact,
    shown_signals,
)
from clepsydra.deploy.proof.compiled_c import CompiledC, printed_c
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.exchange_target import exchange_contents, model_exchange
from clepsydra.deploy.proof.fmu_targets import (
    Measured,
    co_simulation,
    co_simulation_contents,
)
from clepsydra.deploy.proof.interpreted_text import InterpretedText, printed_text
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.row import ProofRow, Verdict
from clepsydra.deploy.proof.single_scans import DIVERGED, compare_single
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES

#: Largest difference of C in floats and Structured Text in REALs where the law uses functions of
#: a library, as a share of a signal's range: some thousand roundings.
SINGLE_LIBRARY_BOUND = 1e-4
#: What can be proved, as `cl.export` names it.
Export = Literal["c", "st", "fmu"]
EXPORTS: tuple[Export, ...] = get_args(Export)
_SINGLE_DIALECT = "codesys"
#: What a printed text is called among the files of a target.
_TEXT = "text"


@dataclass(frozen=True)
class Target:
    """One target.

    Parameters
    ----------
    name : str
    to : {"c", "st", "fmu"}
        The export that it runs.
    precision : {"double", "single"}
    against : str
        What it is compared with.
    version : str
        Of what runs it.
    printed : callable
        Takes a job and returns the files that it prints.
    run : callable
        Takes a job and these files, and returns the difference, the bound (None: there is none),
        and further fields of the row.
    scores : bool
        Whether the row has scores of the loop.

    Examples
    --------
    >>> [target.name for target in targets_of("process", Compiler(("cc",), "cc 1.0"))][:2]
    ['C', 'Structured Text, matiec']
    """

    name: str
    to: Export
    precision: Precision
    against: str
    version: str
    printed: Callable[[Job], Contents]
    run: Callable[[Job, Contents], Measured]
    scores: bool = False

    def measure(self, job: Job) -> Measured:
        """Print and run a job on this target."""
        return self.run(job, self.printed(job))

    def setting(self, job: Job) -> str:
        """Return a digest of what a job runs through on this target."""
        return f"{job.setting} {job.loop}" if self.scores else job.setting

    def row(self, job: Job, blank: ProofRow, printed: Contents) -> ProofRow:
        """Run what was printed of a job on this target and fill its row."""
        difference, bound, more = self.run(job, printed)
        return replace(
            blank,
            exact=is_exact(job.program),
            largest=difference.largest,
            signal=difference.signal,
            scan=difference.scan,
            differing=difference.differing,
            decisions=difference.decisions,
            overflows=difference.overflows,
            bound=bound,
            verdict=_verdict(difference, bound),
            **more,
        )


def exports_of(to: Export | Sequence[Export]) -> tuple[Export, ...]:
    """Return the exports that are asked for, each once and in the order of `EXPORTS`.

    Raises
    ------
    InputError
        There is none, or one that is not known.

    Examples
    --------
    >>> exports_of(["fmu", "c", "c"])
    ('c', 'fmu')
    """
    place, expected = "proof, to", f"one or more of {', '.join(EXPORTS)}"
    remedy = "name what is to be run, or leave it out: then all is"
    asked = (to,) if isinstance(to, str) else sequence_of(to, str, place, expected, remedy)
    unknown = next((each for each in asked if each not in EXPORTS), None)
    if unknown is not None or not asked:
        raise InputError(place, unknown or "nothing", expected, remedy)
    return tuple(each for each in EXPORTS if each in asked)


def targets_of(kind: str, compiler: Compiler) -> list[Target]:
    """Return the targets of a controller or a process.

    Raises
    ------
    InputError
        A package of the proof is missing.
    """
    grammar, importer = _version("tree-sitter-iec61131-3-st"), _version("FMPy")
    found = [Target("C", "c", "double", "engine", compiler.version, _c_files, _c)]
    found += [
        Target(
            f"Structured Text, {dialect}",
            "st",
            "double",
            "engine",
            grammar,
            _text_files(dialect),
            _text(dialect),
        )
        for dialect in DIALECT_NAMES
    ]
    found += [
        Target(
            f"FMU {version}",
            "fmu",
            "double",
            "engine",
            importer,
            co_simulation_contents(version),
            co_simulation(version),
        )
        for version in ("3.0", "2.0")
    ]
    if kind == "process":
        exchanged = [
            Target(
                f"FMU {version} exchange",
                "fmu",
                "double",
                "CasADi",
                importer,
                exchange_contents(version),
                model_exchange(version),
            )
            for version in ("3.0", "2.0")
        ]
        return [*found, *exchanged]
    return [
        *found,
        Target(
            "Structured Text",
            "st",
            "single",
            "C in single",
            grammar,
            _single_text_files,
            _single_text,
        ),
        Target(
            "C",
            "c",
            "single",
            "engine in double",
            compiler.version,
            _single_c_files,
            _single_c,
            scores=True,
        ),
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
        # Rounding may move a number, and turn none into what is infinite or not a number.
        if difference.overflows:
            return "differs"
        return "diverges" if difference.largest > DIVERGED else "reported"
    # Where nothing but exact operations are, the sign of a zero counts too; and a decision that
    # differs is no matter of a bound.
    within = bound > 0.0 and difference.largest <= bound and difference.decisions == 0
    return "within the bound" if within else "differs"


def _c_files(job: Job) -> Contents:
    return _files(printed_c(job.program, "double", job.item.origin), job.compiler)


def _files(printed: CSource, compiler: Compiler) -> Contents:
    return {
        printed.header_name: printed.header.encode(),
        printed.source_name: printed.source.encode(),
        "compiler": " ".join([compiler.version, *compiler.flags]).encode(),
    }


def _c(job: Job, files: Contents) -> Measured:
    name = job.program.name
    printed = CSource(name, files[f"{name}.h"].decode(), files[f"{name}.c"].decode())
    instance = CompiledC(job.program, job.folder / "double", compiler=job.compiler, printed=printed)
    found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
    return found, double_bound(job.program), {}


def _text_files(dialect: str) -> Callable[[Job], Contents]:
    def files(job: Job) -> Contents:
        text = printed_text(job.program, "double", dialect, job.item.origin)
        return {_TEXT: text.encode()}

    return files


def _text(dialect: str) -> Callable[[Job, Contents], Measured]:
    def measure(job: Job, files: Contents) -> Measured:
        instance = InterpretedText(job.program, dialect=dialect, text=files[_TEXT].decode())
        found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
        return found, double_bound(job.program), {}

    return measure


def _single_c_files(job: Job) -> Contents:
    return _files(job.printed_single_c, job.compiler)


def _single_text_files(job: Job) -> Contents:
    text = printed_text(job.program, "single", _SINGLE_DIALECT, job.item.origin)
    return {**_single_c_files(job), _TEXT: text.encode()}


def _single_text(job: Job, files: Contents) -> Measured:
    text = files[_TEXT].decode()
    instance = InterpretedText(job.program, "single", _SINGLE_DIALECT, text)
    found = compare(
        shown_signals(job.program), job.run_of_single_c, instance.run(job.single_inputs)
    )
    return found, 0.0 if is_exact(job.program) else SINGLE_LIBRARY_BOUND, {}


def _single_c(job: Job, files: Contents) -> Measured:
    found, reason = compare_single(job)
    scores = _scores(job.item, job)
    return (
        found,
        None,
        {**scores, "reason": "; ".join(filter(None, [reason, scores.get("reason")]))},
    )


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
