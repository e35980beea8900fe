"""The proof: every program on every target, compared with the simulation."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import NamedTuple

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.files import whole_file
from clepsydra.base.markdown import markdown
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.printing.heading import digest, written_with
from clepsydra.deploy.proof.answer import proof_answer
from clepsydra.deploy.proof.coverage import Coverage
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job, contents_digest
from clepsydra.deploy.proof.limits import PYTHON_LAW, Limit
from clepsydra.deploy.proof.row import Proof, ProofRow, read_memory
from clepsydra.deploy.proof.run import Run
from clepsydra.deploy.proof.scans import FEWEST
from clepsydra.deploy.proof.targets import proved_targets, runs_of


class ProofProgress(NamedTuple):
    """How far a proof has come.

    Parameters
    ----------
    done, of : int
        Rows.
    name : str
        The one in work.
    rows : tuple of ProofRow
        Those that are done.
    """

    done: int
    of: int
    name: str
    rows: tuple[ProofRow, ...] = ()


def prove(
    items: Sequence[ProofItem],
    *,
    scans: int = FEWEST,
    seed: int = 1,
    to: str | Sequence[str] | None = None,
    progress: Callable[[ProofProgress], None] | None = None,
    folder: Path | None = None,
    stem: str = "proof",
) -> Proof:
    """Run controllers and processes on every target and compare them with the simulation.

    Each program runs through the same random scans (`scans.random_scans`) in the engine's kernel,
    as C built by this machine's compiler, as Structured Text of each dialect read by a grammar
    and an interpreter of their own, and as FMUs by FMPy; in single precision as C and as
    Structured Text, which are compared with each other, and as C with the engine, which has to
    have every bit of it in single precision, and in double precision. That last difference is
    only reported, with what it does to the scores of the loop, unless a number is infinite or not
    a number in single precision only; where the two diverge it is a finding with a verdict of its
    own.

    Bounds in double precision: every bit where the program has nothing but + − × ÷ √, comparison
    and rounding; otherwise 1e-12 of a signal's range, and no integer or boolean value may differ.
    A target may refuse a program for what it cannot express by its nature (`limits.LIMITS`), and
    for nothing else.

    Parameters
    ----------
    items : sequence of ProofItem
    scans : int
        At least 10,000.
    seed : int
        Of the scans.
    to : str or sequence of str, optional
        The targets of an export that are run; all if left out.
    progress : callable, optional
        Takes a `ProofProgress` before each row.
    folder : Path, optional
        Where the proof is written, as JSON and Markdown, after each row; rows that an earlier
        proof there holds are taken from it where nothing could come out otherwise: program,
        printed text, target, scans, simulation, versions, and for the scores the loop are the
        same. Control-C ends a proof with the rows so far, and the next one goes on.
    stem : str
        Name of the files, without ending.

    Returns
    -------
    Proof

    Raises
    ------
    InputError
        There is no compiler or no such export, a package is missing, too few scans, a seed that is
        negative or no whole number, or the folder cannot be written.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation, Program
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("u"),), (), (Signal("y"),), double)
    >>> proof = prove([ProofItem("doubled", 1.0, program)], to=["st"])
    >>> proof.holds, proof.rows[0].verdict
    (True, 'equal')
    """
    for what, value, least in (("scans", scans, FEWEST), ("seed", seed, 0)):
        if not isinstance(value, Integral) or value < least:
            expected = f"a whole number of at least {least:,}"
            raise InputError(f"proof, {what}", value, expected, "choose more")
    # A folder is looked at first, and refused before any tool is asked for.
    memory = read_memory(folder / f"{stem}.json") if folder else {}
    begun, tell = time.monotonic(), progress or (lambda _: None)
    compiler, chosen = find_compiler("proof"), proved_targets(to)
    jobs = {kind: runs_of(kind, compiler, chosen) for kind in ("controller", "process")}
    versions = sorted({run.version for runs in jobs.values() for run in runs})
    rows, coverage = list[ProofRow](), dict[str, Coverage]()

    def so_far(*, interrupted: bool = False) -> Proof:
        """Return the proof so far, and write it where it is to be written."""
        told, seconds = (written_with(), *versions), time.monotonic() - begun
        proof = Proof(tuple(rows), dict(coverage), told, scans, seed, seconds, interrupted)
        if folder is not None:
            _write(proof, folder, stem)
        return proof

    with tempfile.TemporaryDirectory(prefix="clepsydra-", ignore_cleanup_errors=True) as place:
        try:
            for number, item in enumerate(items):
                if item.program is None:
                    blank = ProofRow(item.name, "every target", "double", "engine", "", 0, seed)
                    rows.append(_refused(blank, item, (PYTHON_LAW,), item.refusal))
                    continue
                job, runs = (
                    Job(item, scans, seed, Path(place, str(number)), compiler),
                    jobs[item.kind],
                )
                for run in runs:
                    name = f"{item.name}: {run.name}, {run.precision}"
                    tell(ProofProgress(len(rows), len(items) * len(runs), name, tuple(rows)))
                    row = _done(run, job, memory)
                    coverage[item.name] = job.coverage
                    rows.append(row)
                    if folder and row.key not in memory:
                        so_far()
        except KeyboardInterrupt:
            return so_far(interrupted=True)
    return so_far()


def _write(proof: Proof, folder: Path, stem: str) -> None:
    page = markdown(replace(proof_answer(proof, every=True), title="Proof"), 1) + "\n"
    said = json.dumps(proof.as_dict(), indent=2, allow_nan=False) + "\n"
    for ending, text in (("json", said), ("md", page)):
        with whole_file(folder / f"{stem}.{ending}") as part:
            part.write_text(text, encoding="utf-8")


def _done(run: Run, job: Job, memory: Mapping[tuple[object, ...], ProofRow]) -> ProofRow:
    """Print what a target runs, and run it where no earlier row knows how that comes out."""
    begun, own = time.monotonic(), job.in_si if run.in_si else job
    blank = ProofRow(
        job.item.name, run.name, run.precision, run.against, digest(own.program), job.scans,
        job.seed, version=f"{written_with()}, {run.version}",
    )  # fmt: skip
    try:
        printed = run.printed(own)
        blank = replace(blank, text=contents_digest(printed), setting=run.setting(own))
        if blank.key in memory:
            return replace(memory[blank.key], subject=blank.subject)
        row = run.row(own, blank, printed)
    except InputError as refusal:
        row = _refused(blank, own.item, run.limits, str(refusal))
    except ClepsydraError as failure:
        row = replace(blank, verdict="fails", reason=str(failure))
    return replace(row, seconds=round(time.monotonic() - begun, 3))


def _refused(blank: ProofRow, item: ProofItem, limits: Sequence[Limit], reason: str) -> ProofRow:
    met = next((limit.name for limit in limits if limit.meets(item)), "")
    return replace(blank, verdict="refused", limit=met, reason=reason)
