"""Structured Text in a proof: in every dialect, and in single precision."""

from __future__ import annotations

from functools import partial

from clepsydra.deploy.proof.c_runs import printed_single_c
from clepsydra.deploy.proof.comparison import compare, double_bound, is_exact, shown_signals
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.interpreted_text import InterpretedText, printed_text
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.limits import MATIEC_NUMBERS, OF_SINGLE, OF_TEXT, PYTHON_LAW
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES

#: Largest difference of C in floats and Structured Text in REALs where the law uses functions of
#: a library, as a share of a signal's range: some thousand roundings.
SINGLE_LIBRARY_BOUND = 1e-4
_SINGLE_DIALECT = "codesys"
#: What a printed text is called among the files.
_TEXT = "text"


def text_runs(kind: str) -> list[Run]:
    """Return what is run of Structured Text; of a process in double precision only.

    Raises
    ------
    InputError
        Its grammar is missing.

    Examples
    --------
    >>> text_runs("controller")[-1].against
    'C in single'
    """
    grammar, limits = version_of("tree-sitter-iec61131-3-st"), (PYTHON_LAW, *OF_TEXT)
    found = [
        Run(
            f"Structured Text, {dialect}",
            "double",
            "engine",
            grammar,
            partial(_printed, dialect=dialect),
            partial(_measured, dialect=dialect),
            (*limits, MATIEC_NUMBERS) if dialect == "matiec" else limits,
        )
        for dialect in DIALECT_NAMES
    ]
    if kind == "controller":
        single = _printed_single, _measured_single, (*limits, *OF_SINGLE)
        found.append(Run("Structured Text", "single", "C in single", grammar, *single))
    return found


def _printed(job: Job, dialect: str) -> Contents:
    return {_TEXT: printed_text(job.program, "double", dialect, job.item.origin).encode()}


def _measured(job: Job, files: Contents, dialect: str) -> Measured:
    instance = InterpretedText(job.program, dialect=dialect, text=files[_TEXT].decode())
    found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
    return found, double_bound(job.program), {}


def _printed_single(job: Job) -> Contents:
    text = printed_text(job.program, "single", _SINGLE_DIALECT, job.item.origin)
    return {**printed_single_c(job), _TEXT: text.encode()}


def _measured_single(job: Job, files: Contents) -> Measured:
    instance = InterpretedText(job.program, "single", _SINGLE_DIALECT, files[_TEXT].decode())
    signals = shown_signals(job.program)
    found = compare(signals, job.run_of_single_c, instance.run(job.single_inputs))
    return found, 0.0 if is_exact(job.program) else SINGLE_LIBRARY_BOUND, {}
