"""A proof and its rows, each one program on one target, compared with the simulation."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.standing import Standing, standing_at
from clepsydra.deploy.proof.coverage import Coverage
from clepsydra.deploy.proof.scans import FEWEST

Verdict = Literal[
    "equal", "within the bound", "differs", "reported", "diverges", "refused", "fails"
]
#: Verdicts with which a proof holds.
HOLDING: tuple[Verdict, ...] = ("equal", "within the bound", "reported", "diverges")
#: A row takes a kilobyte, and no study has a hundred thousand.
_LARGEST = 100_000_000
_WRITTEN = "what an earlier proof wrote"


@dataclass(frozen=True)
class ProofRow:
    """One program on one target.

    Parameters
    ----------
    subject : str
        The controller or process.
    target : str
        "C", "Structured Text (codesys)", "FMU 3.0", …
    precision : {"double", "single"}
    against : str
        What it is compared with: "engine", "C", "engine in double".
    program : str
        Digest of the program, as `clepsydra export` tells it; empty where there is none.
    scans, seed : int
    exact : bool
        Whether the program has nothing but + − × ÷ √, comparison and rounding.
    largest : float
        Largest difference, share of the signal's range.
    signal : str
        Where it is; empty where there is none.
    scan : int
        When it is, from 0; -1 where there is none.
    differing : int
        Numbers that differ in a bit.
    decisions : int
        Integer and boolean values that differ.
    bound : float or None
        Of the largest difference; None where it is only reported.
    verdict : str
        "equal" in every bit, "within the bound", "differs"; "reported" where there is no bound, and
        "diverges" where the two lie further apart than the range: a finding about single precision,
        of which the proof in double precision holds; "refused" where there is nothing to run, and
        "fails" where it does not run.
    overflows : int
        Numbers that are infinite or not a number where they are finite in what it is compared
        with.
    limit : str
        The limit of the target that makes a refusal an expected one, see
        `clepsydra.deploy.proof.limits`; empty where it is none, and the proof does not hold.
    reason : str
        What was refused or failed, or what else is to be said.
    seconds : float
        Of printing, building and running.
    version : str
        Of what ran it: the compiler, the grammar, FMPy.
    scores : dict
        What single precision does to the scores of the loop, see
        `clepsydra.deploy.proof.single_loop.ScoreChange`; None where a number is infinite.
    text : str
        Digest of the printed files that ran, and of the flags that they were compiled with.
    setting : str
        Digest of what they ran through: the scans, what the simulation makes of them, and where
        there are scores the loop.

    Examples
    --------
    >>> row = ProofRow("PI", "C", "double", "engine", "", 0, 1, verdict="refused", reason="?")
    >>> row.holds, row_of(row.as_dict()) == row
    (False, True)
    """

    subject: str
    target: str
    precision: str
    against: str
    program: str
    scans: int
    seed: int
    exact: bool = True
    largest: float = 0.0
    signal: str = ""
    scan: int = -1
    differing: int = 0
    decisions: int = 0
    bound: float | None = None
    overflows: int = 0
    verdict: Verdict = "equal"
    limit: str = ""
    reason: str = ""
    seconds: float = 0.0
    version: str = ""
    scores: dict[str, Any] = field(default_factory=dict)
    text: str = ""
    setting: str = ""

    @property
    def holds(self) -> bool:
        """Whether the proof holds as far as this row goes."""
        return self.verdict in HOLDING or (self.verdict == "refused" and self.limit != "")

    @property
    def key(self) -> tuple[object, ...]:
        """What two rows share that must come out the same."""
        return (
            self.program, self.target, self.precision, self.against, self.scans, self.seed,
            self.version, self.text, self.setting,
        )  # fmt: skip

    def as_dict(self) -> dict[str, Any]:
        """Return all of it for JSON; an infinite difference is the text "infinite"."""
        said = asdict(self)
        if self.largest == math.inf:
            said["largest"] = "infinite"
        return said


@dataclass(frozen=True)
class Proof:
    """What was compared with the simulation, and how it came out.

    Parameters
    ----------
    rows : tuple of ProofRow
    coverage : dict
        Subject to what the scans exercised.
    versions : tuple of str
        Of Clepsydra and of all that ran the targets.
    scans, seed : int
    seconds : float
    interrupted : bool
        Whether it was ended before all rows were done.
    """

    rows: tuple[ProofRow, ...]
    coverage: dict[str, Coverage] = field(default_factory=dict)
    versions: tuple[str, ...] = ()
    scans: int = FEWEST
    seed: int = 1
    seconds: float = 0.0
    interrupted: bool = False

    @property
    def failures(self) -> tuple[ProofRow, ...]:
        """The rows that are outside their bound, do not run, or are refused without need."""
        return tuple(row for row in self.rows if not row.holds)

    @property
    def refusals(self) -> tuple[ProofRow, ...]:
        """The rows in which a target refuses what it cannot express by its nature."""
        return tuple(row for row in self.rows if row.verdict == "refused" and row.holds)

    @property
    def diverging(self) -> tuple[ProofRow, ...]:
        """The rows in which single precision leads away from the simulation."""
        return tuple(row for row in self.rows if row.verdict == "diverges")

    @property
    def idle(self) -> tuple[str, ...]:
        """Subjects in which nothing moved, so that the comparison says nothing."""
        return tuple(name for name, seen in self.coverage.items() if seen.is_idle)

    @property
    def holds(self) -> bool:
        """Whether something was compared, and all of it is within its bound."""
        compared = any(row.verdict != "refused" for row in self.rows)
        return compared and not (self.failures or self.idle or self.interrupted)

    def as_dict(self) -> dict[str, Any]:
        """Return all of it for JSON."""
        return {
            "holds": self.holds,
            "interrupted": self.interrupted,
            "scans": self.scans,
            "seed": self.seed,
            "seconds": self.seconds,
            "versions": list(self.versions),
            "coverage": {name: seen.as_dict() for name, seen in self.coverage.items()},
            "rows": [row.as_dict() for row in self.rows],
        }


#: What a row holds, and its scores where it has some.
_BLANK = asdict(ProofRow("", "", "double", "engine", "", 0, 0, bound=0.0))
_SCORES = {"ranking": 1.0, "score": "", "change": 0.0, "is_change": False}
_MAY_BE_NONE = ("bound", "ranking", "change")


def row_of(said: dict[str, Any]) -> ProofRow:
    """Return the row that `ProofRow.as_dict` described; a TypeError or KeyError if it did not."""
    infinite = said["largest"] == "infinite"
    _check_alike(said | ({"largest": 0.0} if infinite else {}), _BLANK)
    if said["scores"]:
        _check_alike(said["scores"], _SCORES)
    return ProofRow(**said | ({"largest": math.inf} if infinite else {}))


def _check_alike(said: dict[str, Any], example: dict[str, Any]) -> None:
    """Refuse what has other keys than an example, or values of other types."""
    if set(said) != set(example):
        raise KeyError("no row of a proof")
    for name, like in example.items():
        value, kinds = said[name], (int, float) if isinstance(like, float) else type(like)
        odd = not isinstance(value, kinds) or (
            isinstance(value, float) and not math.isfinite(value)
        )
        if odd and not (value is None and name in _MAY_BE_NONE):
            raise TypeError(f"{name} of another type")


def read_memory(path: Path) -> dict[tuple[object, ...], ProofRow]:
    """Return the rows of an earlier proof that compared something and hold, by their keys.

    A key holds digests of all that makes a row: of the program, of the printed text that ran, of
    the scans and of what the simulation made of them. So a row is taken for true only where it
    would come out the same. A file that is not there holds nothing; rows that differ or are
    refused are computed anew.

    Raises
    ------
    InputError
        The file cannot be read, or is something else than a proof.
    """
    if standing_at(path, f"proof, {path}", _WRITTEN) is Standing.NOTHING:
        return {}
    content = read_input(path, _WRITTEN, _LARGEST)
    try:
        said = json.loads(content)
        rows = [row_of(entry) for entry in said["rows"]]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise InputError(
            f"proof, {path}", "something else", _WRITTEN, "move that file away"
        ) from None
    return {row.key: row for row in rows if row.holds and row.verdict != "refused" and row.text}
