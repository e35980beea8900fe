"""Whether workers compute the same bits: what each says of itself, and who may work."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import casadi as ca
import numpy as np
import scipy

import clepsydra
from clepsydra.base.errors import Finding, InputError
from clepsydra.engine.host import host
from clepsydra.studies.robustness.drawn_loops import DrawnLoops

#: Draws of which the plants are compared.
_COMPARED = 256


@dataclass(frozen=True)
class WorkerAnswer:
    """What a worker says of itself.

    Neither Python nor llvmlite is asked for: compiled kernels hold what is written in them, without
    liberties, whoever compiles them.

    Attributes
    ----------
    versions : dict
        Those that decide bits: of Clepsydra, of what makes programs, and of what draws plants.
    fuses : bool
        Whether its processor fuses multiply-adds.
    """

    versions: dict[str, str]
    fuses: bool


def own_answer() -> WorkerAnswer:
    """Return what this process says of itself."""
    versions = {
        "Clepsydra": clepsydra.__version__,
        "CasADi": ca.CasadiMeta.version(),
        "NumPy": np.__version__,
        "SciPy": scipy.__version__,
    }
    return WorkerAnswer(versions, host().fuses)


def refusal(address: str, said: WorkerAnswer, own: WorkerAnswer) -> InputError | None:
    """Return why a worker may not work beside others; None where it may.

    Examples
    --------
    >>> old = WorkerAnswer({"Clepsydra": "0.1.0", "NumPy": "2.0.1"}, fuses=True)
    >>> new = WorkerAnswer({"Clepsydra": "0.2.0", "NumPy": "2.0.1"}, fuses=True)
    >>> print(refusal("tcp://10.0.0.7:4000", old, new))
    worker tcp://10.0.0.7:4000: got Clepsydra 0.1.0, expected Clepsydra 0.2.0, as here; install \
the same there.
    """
    differing = [name for name, version in own.versions.items() if said.versions[name] != version]
    if not differing:
        return None
    found, wanted = (
        ", ".join(f"{name} {each.versions[name]}" for name in differing) for each in (said, own)
    )
    return InputError(
        f"worker {address}", Finding(found), f"{wanted}, as here", "install the same there"
    )


def drawing_nothing(address: str, error: BaseException | None) -> InputError:
    """Return why a worker may not work that lacks Clepsydra, or what a law is defined in."""
    package = (getattr(error, "name", None) or "clepsydra").partition(".")[0]
    if package == "clepsydra":
        found, expected = "no Clepsydra, or another", f"Clepsydra {clepsydra.__version__}, as here"
    else:
        found, expected = f"no module {package}", f"module {package}, as here"
    return InputError(f"worker {address}", Finding(found), expected, "install the same there")


def drawing_others(address: str) -> InputError:
    """Return why a worker that draws other plants, or has another program, may not work."""
    return InputError(
        f"worker {address}", Finding("other plants, or another program, from the same numbers"),
        "the same bits as here",
        "give it the same Clepsydra, source and all, or leave out distributions whose elementary "
        "functions its processor rounds otherwise",
    )  # fmt: skip


def sample(loops: DrawnLoops, draws: int) -> str:
    """Return what tells loops and the plants of their first draws, of so many, bit by bit.

    NumPy computes an exponential with other instructions, and another last digit, on processors
    of another kind: of a log-normal distribution such a worker draws other plants.
    """
    digest = hashlib.sha256(loops.digest.encode())
    numbers = np.arange(1, min(draws, _COMPARED) + 1)
    values = loops.plants.values(numbers)
    rest = loops.plants.rest(numbers, values)
    for array in (*(values[name] for name in sorted(values)), rest.state, rest.inputs):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
