"""What a proof runs: printed code on a target, what it is compared with, and by which bound."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.deploy.proof.comparison import Difference, is_exact, verdict
from clepsydra.deploy.proof.job import Contents, Job
from clepsydra.deploy.proof.limits import PYTHON_LAW, Limit
from clepsydra.deploy.proof.row import ProofRow
from clepsydra.program.precision import Precision

#: Difference, bound (None: there is none), and further fields of the row.
Measured = tuple[Difference, float | None, dict[str, Any]]


@dataclass(frozen=True)
class Run:
    """One run of what is printed of a controller or a process.

    Parameters
    ----------
    name : str
    precision : {"double", "single"}
    against : str
        What it is compared with.
    version : str
        Of what runs it.
    printed : callable
        Takes a job and returns the files that it prints.
    measure : callable
        Takes a job and these files, and returns what was measured.
    limits : tuple of Limit
        What the target cannot express by its nature.
    scores : bool
        Whether the row has scores of the loop.
    in_si : bool
        Whether the program with ports in SI is run.
    """

    name: str
    precision: Precision
    against: str
    version: str
    printed: Callable[[Job], Contents]
    measure: Callable[[Job, Contents], Measured]
    limits: tuple[Limit, ...] = (PYTHON_LAW,)
    scores: bool = False
    in_si: bool = False

    def setting(self, job: Job) -> str:
        """Return a digest of what a job runs through."""
        return f"{job.setting} {job.loop}" if self.scores else job.setting

    def row(self, job: Job, blank: ProofRow, printed: Contents) -> ProofRow:
        """Run what was printed of a job and fill its row."""
        difference, bound, more = self.measure(job, printed)
        return replace(
            blank,
            exact=is_exact(job.program),
            bound=bound,
            verdict=verdict(difference, bound),
            **asdict(difference),
            **more,
        )


def version_of(package: str) -> str:
    """Return the version of a package that a proof needs.

    Raises
    ------
    InputError
        It is missing.
    """
    try:
        return f"{package} {importlib.metadata.version(package)}"
    except importlib.metadata.PackageNotFoundError:
        raise InputError(
            "proof", Finding(f"no package {package}"), "all packages of the proof",
            "pip install 'clepsydra[verify]'",
        ) from None  # fmt: skip
