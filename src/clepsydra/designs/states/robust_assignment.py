"""A gain that assigns eigenvalues, with eigenvectors as orthogonal as possible."""

from __future__ import annotations

import numpy as np

#: The eigenvectors stand when a sweep changes their determinant by less than this share ...
_SETTLED = 1e-3
#: ... of at least this.
_LEAST_DETERMINANT = float(np.sqrt(np.spacing(1.0)))
_SWEEPS = 30
#: Two numbers are one that differ by less than this share and size.
_SAME, _NOTHING = 1e-5, 1e-8


def assigned_gain(A: np.ndarray, B: np.ndarray, eigenvalues: np.ndarray) -> np.ndarray:
    """Return F with which A - B F has the given eigenvalues.

    The eigenvectors of an eigenvalue λ lie in the null space of U₁ᵀ (A - λ I), where U₁ spans
    what is orthogonal to B. Within these spaces two real ones at a time, or a conjugate pair, are
    turned so that the determinant of all grows, until it stands. SciPy's `place_poles` takes the
    same steps, at three times the cost and with the import of all of `scipy.signal`.

    Parameters
    ----------
    A, B : ndarray [n, n], [n, m]
        Every mode of A within reach of B.
    eigenvalues : ndarray [n]
        Each with its conjugate, none more often than the rank of B.

    Raises
    ------
    LinAlgError
        Columns of B or the eigenvectors depend on each other, or a conjugate is missing.

    References
    ----------
    J. Kautsky, N. K. Nichols and P. Van Dooren, Robust pole assignment in linear state feedback,
    International Journal of Control 41(5), 1985, 1129-1155, doi 10.1080/0020718508961188.
    A. L. Tits and Y. Yang, Globally convergent algorithms for robust pole assignment by state
    feedback, IEEE Transactions on Automatic Control 41(10), 1996, 1432-1452,
    doi 10.1109/9.539425.

    Examples
    --------
    >>> A, B = np.diag([0.0, 1.0]), np.ones((2, 1))
    >>> gain = assigned_gain(A, B, np.array([-1.0, -2.0]))
    >>> np.sort(np.linalg.eigvals(A - B @ gain)).round(9)
    array([-2., -1.])
    """
    n, rank = len(A), int(np.linalg.matrix_rank(B))
    wanted, real = _ordered(eigenvalues)
    pairs = range(real, n, 2)
    if rank == n:  # any eigenvectors will do, and those of the identity are orthogonal
        return np.asarray(np.linalg.lstsq(B, A - _block_diagonal(wanted, pairs), rcond=-1)[0])
    U, R = np.linalg.qr(B, mode="complete")
    vectors, spaces = np.empty((n, n)), []
    for place in (*range(real), *pairs):
        value = wanted[place].real if place < real else wanted[place].conj()
        rows = U[:, rank:].T @ (A - value * np.eye(n))
        space = np.linalg.qr(rows.conj().T, mode="complete")[0][:, n - rank :]
        # Their sum, for one of a basis may have zeros, or no imaginary part.
        first = np.sum(space, axis=1)
        first /= np.linalg.norm(first)
        if place < real:
            vectors[:, place] = first
            spaces += [space]
        else:
            vectors[:, place], vectors[:, place + 1] = first.real, first.imag
            spaces += [space, space]
    if rank > 1:
        _orthogonalise(vectors, spaces, real)
    eigenvectors = vectors.astype(complex)
    for i in pairs:
        eigenvectors[:, i] = vectors[:, i] - 1j * vectors[:, i + 1]
        eigenvectors[:, i + 1] = vectors[:, i] + 1j * vectors[:, i + 1]
    closed = np.linalg.solve(eigenvectors.T, wanted[:, None] * eigenvectors.T).T
    return np.asarray(-np.real(np.linalg.solve(R[:rank], U[:, :rank].T @ (closed - A))))


def _ordered(eigenvalues: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the real ones, then the pairs, those below the axis first, and how many are real."""
    real = np.sort(eigenvalues[eigenvalues.imag == 0.0])
    below = np.sort(eigenvalues[eigenvalues.imag < 0.0])
    if len(real) + 2 * len(below) != len(eigenvalues):
        raise np.linalg.LinAlgError("a complex eigenvalue lacks its conjugate")
    return np.concatenate([real, np.stack([below, below.conj()], axis=1).ravel()]), len(real)


def _block_diagonal(wanted: np.ndarray, pairs: range) -> np.ndarray:
    """Return a real matrix with these eigenvalues: of a pair [[a, b], [-b, a]]."""
    found = np.diag(wanted.real)
    for i in pairs:
        found[i, i + 1], found[i + 1, i] = -wanted[i].imag, wanted[i].imag
    return found


def _orthogonalise(vectors: np.ndarray, spaces: list[np.ndarray], real: int) -> None:
    """Turn the vectors within their spaces, in place; of a pair they are its two parts."""
    turns = _turns(real, len(vectors))
    for _ in range(_SWEEPS):
        before = abs(float(np.linalg.det(vectors)))
        for i, j in turns:
            others = np.delete(vectors, (i, j), axis=1)
            free = np.linalg.qr(others, mode="complete")[0]
            if i == j:
                _turn_one(vectors, spaces, free, i)
            elif i < real:
                _turn_two(vectors, spaces, free, i, j)
            else:
                _turn_pair(vectors, spaces, free, i)
        after = max(_LEAST_DETERMINANT, abs(float(np.linalg.det(vectors))))
        if abs(after - before) < _SETTLED * after and after > _LEAST_DETERMINANT:
            break


def _turns(real: int, count: int) -> list[tuple[int, int]]:
    """Return which vectors are turned together in a sweep, in the order of Tits and Yang.

    Every real one with every other, and between these the pairs; a single real one by itself.
    """
    half, more = real // 2, real // 2 + real % 2
    others = [(0, 0)] if real == 1 else []
    pairs = [(i, i + 1) for i in range(real, count, 2)]
    return [
        *([(real - 1, 0)] if real else []),
        *((2 * i - 1, 2 * i) for i in range(1, more)),
        *pairs,
        *((2 * i, 2 * i + 1) for i in range(half)),
        *others,
        *pairs,
        *((i, i + j) for j in range(2, more) for i in range(half)),
        *others,
        *pairs,
        *((i, (i + j) % real) for j in range(2, more) for i in range(half, real)),
        *others,
        *pairs,
        *((i, i + half) for i in range(half)),
        *others,
        *pairs,
    ]


def _turn_one(vectors: np.ndarray, spaces: list[np.ndarray], free: np.ndarray, i: int) -> None:
    """Turn a real vector as near as its space allows to what is orthogonal to the others."""
    found = spaces[i] @ spaces[i].T @ free[:, -1]
    if _is_something(found):
        vectors[:, i] = found / np.linalg.norm(found)


def _turn_two(
    vectors: np.ndarray, spaces: list[np.ndarray], free: np.ndarray, i: int, j: int
) -> None:
    """Turn two real vectors so that their area across the others is largest."""
    n, (u, v) = len(vectors), free[:, -2:].T
    left, sizes, right = np.linalg.svd(spaces[i].T @ (np.outer(u, v) - np.outer(v, u)) @ spaces[j])
    taken = 2 if _is_one(sizes[0], sizes[1]) else 1
    basis = np.vstack([spaces[i] @ left[:, :taken], spaces[j] @ right[:taken].T])
    found = basis @ basis.T @ np.concatenate([vectors[:, i], vectors[:, j]])
    if _is_something(found):
        found *= np.sqrt(2.0) / np.linalg.norm(found)
    else:
        found = basis[:, 0]
    vectors[:, i], vectors[:, j] = found[:n], found[n:]


def _turn_pair(vectors: np.ndarray, spaces: list[np.ndarray], free: np.ndarray, i: int) -> None:
    """Turn a conjugate pair so that the area of its two parts across the others is largest."""
    u = np.sqrt(2.0) * (free[:, -2] + 1j * free[:, -1])
    across = np.outer(u, u.conj())
    sizes, directions = np.linalg.eig(spaces[i].conj().T @ (across - across.conj()) @ spaces[i])
    order = np.argsort(np.abs(sizes))[::-1]
    largest, second = np.abs(sizes[order[:2]])
    taken = order[: 2 if _is_one(largest, second) else 1]
    basis = spaces[i] @ directions[:, taken]
    found = basis @ basis.conj().T @ (vectors[:, i] + 1j * vectors[:, i + 1])
    found = found / np.linalg.norm(found) if _is_something(found) else basis[:, 0]
    vectors[:, i], vectors[:, i + 1] = found.real, found.imag


def _is_one(first: float, second: float) -> bool:
    return bool(abs(first - second) <= _NOTHING + _SAME * abs(second))


def _is_something(vector: np.ndarray) -> bool:
    return bool(np.max(np.abs(vector)) > _NOTHING)
