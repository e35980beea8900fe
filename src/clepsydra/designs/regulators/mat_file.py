"""A regulator in a MAT file, as Matlab and Octave save one: matrices A, B, C and D by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.controllers.conditioned_linear import MOST_STATES
from clepsydra.designs.regulators.given import GivenRegulator
from clepsydra.designs.regulators.mat_variables import Variable, mat_variables

_EXPECTED = "a MAT file with the matrices A, B, C and D"
_SAVE = "[A, B, C, D] = ssdata(F); save('reg1.mat', 'A', 'B', 'C', 'D', '-v7')"
#: Sixty states take 0.1 MB.
_LARGEST_FILE = 1_000_000
#: How Octave begins a file for which no version was asked.
_OCTAVES_OWN = {b"# Created by Octave": "Octave's text form", b"Octave-1-": "Octave's binary form"}
_REQUIRED = ("A", "B", "C", "D")
_OPTIONAL = ("E", "Ts")


def read_mat(path: str | Path) -> GivenRegulator:
    """Read a regulator from a MAT file of version 4, 6 or 7.

    Nothing but six matrices of numbers is read: A, B, C, D; Ts, the sampling period [s], zero or
    left out in continuous time; and E, which has to be the identity, or empty as Matlab's dssdata
    has it. Others may stand beside them.

    Raises
    ------
    InputError
        There is no such file, it is of version 7.3 or no MAT file, a matrix is missing, no matrix
        of numbers, or wrong; the place names the file and the matrix.
    """
    path = Path(path)
    content = read_input(path, _EXPECTED, _LARGEST_FILE)
    place = str(path) if str(path).isprintable() else ascii(str(path))
    remedy = f"save it as in {_SAVE}"
    if b"\x89HDF\r\n" in content[:520]:
        expected = f"{_EXPECTED} of version 7 or lower"
        raise InputError(place, "version 7.3, an HDF5 file", expected, remedy)
    for beginning, form in _OCTAVES_OWN.items():
        if content.startswith(beginning):
            raise InputError(place, Finding(form), _EXPECTED, remedy)
    try:
        found = mat_variables(content, MOST_STATES)
    except ValueError:
        raise InputError(
            place, "something that is not a MAT file, or is damaged", _EXPECTED, remedy
        ) from None
    missing = [name for name in _REQUIRED if name not in found]
    if missing:
        there = ", ".join(sorted(name for name in found if name.isidentifier()))[:60]
        expected = f"{_EXPECTED}; it lacks {', '.join(missing)}"
        raise InputError(place, there or Finding("no variables"), expected, remedy)
    matrices = {
        name: _numbers(f"{place}, {name}", found[name])
        for name in (*_REQUIRED, *_OPTIONAL)
        if name in found
    }
    A, B, C, D = (matrices[name] for name in _REQUIRED)
    return GivenRegulator(A, B, C, D, _period(place, matrices), place)


def _numbers(place: str, variable: Variable) -> np.ndarray:
    """Return the numbers of a matrix, and refuse what has none or too many."""
    if variable.numbers is None:
        size = " × ".join(map(str, variable.shape))
        expected = f"a matrix of numbers, at most {MOST_STATES} × {MOST_STATES}"
        remedy = (
            f"save numbers, as in {_SAVE}, of a regulator of low order; full(A) if it is sparse"
        )
        raise InputError(place, f"{variable.kind} {size}".strip(), expected, remedy)
    return variable.numbers


def _period(place: str, matrices: dict[str, np.ndarray]) -> float | None:
    """Return Ts, and refuse a descriptor system, which may be improper."""
    E = matrices.get("E", np.empty(0))
    if E.size and not np.array_equal(E, np.eye(len(matrices["A"]))):
        expected = "the identity: a regulator x' = A x + B e"
        remedy = "make it proper and explicit, as with ss(F, 'explicit')"
        raise InputError(f"{place}, E", "another matrix", expected, remedy)
    if "Ts" not in matrices:
        return None
    given = np.asarray(matrices["Ts"])
    if given.shape != (1, 1) or given.dtype.kind not in "iuf" or not given[0, 0] >= 0.0:
        shown, expected = str(given.ravel()[:3].tolist()), "one number, 0 or above [s]"
        remedy = "give the sampling period, or 0 in continuous time; Matlab's -1 is none"
        raise InputError(f"{place}, Ts", shown, expected, remedy)
    return float(given[0, 0]) or None
