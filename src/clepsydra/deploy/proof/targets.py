"""The targets that a proof runs, and what it runs on each."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.arguments import sequence_of
from clepsydra.base.errors import InputError
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.proof.run import Run
from clepsydra.deploy.target import TARGETS


def proved_targets(to: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the targets that are to be proved, each once and in their order; all for None.

    Raises
    ------
    InputError
        There is none, or one that is not known or runs nothing.

    Examples
    --------
    >>> proved_targets(None), proved_targets(["fmu", "c", "c"])
    (('c', 'st', 'fmu', 'wasm'), ('c', 'fmu'))
    """
    known = tuple(name for name, target in TARGETS.items() if target.runs)
    if to is None:
        return known
    place, expected = "proof, to", f"one or more of {', '.join(known)}"
    remedy = "name what is to be run, or leave it out: then all is"
    asked = (to,) if isinstance(to, str) else sequence_of(to, str, place, expected, remedy)
    unknown = next((each for each in asked if each not in known), None)
    if unknown is not None or not asked:
        raise InputError(place, unknown or "nothing", expected, remedy)
    return tuple(each for each in known if each in asked)


def runs_of(kind: str, compiler: Compiler, to: Sequence[str]) -> list[Run]:
    """Return what is run of a controller or a process on some targets; what takes longest last.

    Raises
    ------
    InputError
        A package of the proof is missing.

    Examples
    --------
    >>> [run.name for run in runs_of("process", Compiler(("cc",), "cc 1.0"), ("c", "st"))]
    ['C', 'Structured Text, matiec', 'Structured Text, codesys', 'Structured Text, scl']
    """
    found = [run for name in to if (runs := TARGETS[name].runs) for run in runs(kind, compiler)]
    return sorted(found, key=lambda run: (run.precision == "single", run.scores))
