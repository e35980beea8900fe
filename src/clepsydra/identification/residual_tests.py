"""The colour of residuals, and tests of what they should not depend on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: Largest order that is tried, and the share of the samples that it may be of.
_LARGEST, _SHARE = 12, 0.1
#: Below this probability a test speaks: once in a hundred records it does so by chance.
SIGNIFICANT = 0.01
_LAGS = 10
#: A direction this much weaker than the strongest is none.
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """e(k) + c1 e(k−1) + … + cp e(k−p) = w(k), w white: the coefficients are 1, c1 … cp."""

    coefficients: np.ndarray
    variance: float

    def whitened(self, signals: np.ndarray) -> np.ndarray:
        """Return w of signals [N, …] that have this colour."""
        from scipy.signal import lfilter

        return np.asarray(lfilter(self.coefficients, [1.0], signals, axis=0))

    def coloured(self, signals: np.ndarray) -> np.ndarray:
        """Return signals [N, …] whose w is given."""
        from scipy.signal import lfilter

        return np.asarray(lfilter([1.0], self.coefficients, signals, axis=0))


def noise_model(residuals: np.ndarray) -> NoiseModel:
    """Fit an autoregressive model to residuals [N], of the order that Schwarz's criterion chooses.

    By the Yule-Walker equations, solved by the recursion of Levinson and Durbin, whose models
    are stable.

    References
    ----------
    P. Stoica and R. Moses, Spectral Analysis of Signals, 2005, sections 3.4 and 3.5.
    G. Schwarz, Annals of Statistics 6(2), 1978, 461-464, doi 10.1214/aos/1176344136.

    Examples
    --------
    >>> white = np.random.default_rng(1).standard_normal(4000)
    >>> model = noise_model(NoiseModel(np.array([1.0, -0.8]), 1.0).coloured(white))
    >>> model.coefficients.round(1)
    array([ 1. , -0.8])
    """
    count = len(residuals)
    most = max(1, min(_LARGEST, int(_SHARE * count)))
    lagged = np.array([residuals[k:] @ residuals[: count - k] for k in range(most + 1)]) / count
    coefficients, variance = np.array([1.0]), float(lagged[0])
    best = NoiseModel(coefficients, variance)
    if variance <= 0.0:
        return best
    lowest = count * math.log(variance)
    for order in range(1, most + 1):
        reflection = -float(coefficients @ lagged[order:0:-1]) / variance
        padded = np.append(coefficients, 0.0)
        coefficients = padded + reflection * padded[::-1]
        variance *= 1.0 - reflection**2
        if variance <= 0.0:
            break
        criterion = count * math.log(variance) + order * math.log(count)
        if criterion < lowest:
            lowest, best = criterion, NoiseModel(coefficients, variance)
    return best


@dataclass(frozen=True, eq=False)
class ResidualTests:
    """Two tests of residuals.

    Parameters
    ----------
    whiteness : float
        Probability of residuals as correlated in time as these, were they white.
    independence : float
        Probability of residuals as correlated with earlier inputs as these, were they
        independent of them.
    noise : NoiseModel or None
        The colour of the residuals where they are not white.
    """

    whiteness: float
    independence: float
    noise: NoiseModel | None

    @property
    def white(self) -> bool:
        """Nothing speaks against white residuals."""
        return self.whiteness >= SIGNIFICANT

    @property
    def independent(self) -> bool:
        """Nothing speaks against residuals without a trace of the input."""
        return self.independence >= SIGNIFICANT

    @property
    def words(self) -> str:
        """What both say of the model."""
        if self.white and self.independent:
            return "white and free of the input: the model explains what the input does"
        if self.independent:
            return "free of the input but coloured: the dynamics fit, the disturbances are slow"
        return "still correlated with the input: the process does more than the model"


def residual_tests(
    residuals: np.ndarray, jacobian: np.ndarray, inputs: np.ndarray, rounding: float = 0.0
) -> ResidualTests:
    """Test the residuals [N] of a least-squares fit, with its Jacobian [N, p] and inputs [N, m].

    Both are Lagrange-multiplier tests by regression: residuals are regressed on the Jacobian of
    the fit and on what they should not depend on, their own last ten values or the inputs at
    lags up to an eighth of the record, and an F test says whether that explains more than chance
    would. So what the fit itself takes out of the residuals counts in neither. Where the
    residuals are coloured, everything is whitened by their noise model before the second test.
    Residuals that are no larger than the rounding are those of the arithmetic, and tell nothing.

    References
    ----------
    L. G. Godfrey, Econometrica 46(6), 1978, 1293-1301, doi 10.2307/1913829.
    R. Davidson and J. G. MacKinnon, Estimation and Inference in Econometrics, 1993, chapter 6.

    Examples
    --------
    >>> noise = np.random.default_rng(3).standard_normal(300)
    >>> u = np.sign(np.sin(1.7 * np.arange(300.0) ** 1.3))[:, None]
    >>> late = np.roll(u[:, 0], 3)
    >>> residual_tests(noise + late, np.ones((300, 1)), u).independent
    False
    """
    count = len(residuals)
    if np.linalg.norm(residuals) <= rounding * np.sqrt(count):
        return ResidualTests(1.0, 1.0, None)
    lags = range(1, _lags(count) + 1)
    own = np.stack([_late(residuals, lag) for lag in lags], axis=1)
    # A fit leaves residuals that are a little correlated even of white noise, E[e' L e] =
    # −s² tr(Q' L Q) with Q a basis of the Jacobian and L the lag, the more the smoother it is.
    basis = basis_of(jacobian)
    traces = np.array([-np.sum(basis[lag:] * basis[: count - lag]) for lag in lags])
    variance = float(residuals @ residuals) / max(count - basis.shape[1], 1)
    whiteness = _f_test(residuals, jacobian, own, variance * traces)
    noise = None if whiteness >= SIGNIFICANT else noise_model(residuals)
    if not inputs.shape[1]:
        return ResidualTests(whiteness, 1.0, noise)
    longest = max(2, count // 8)
    spread = np.unique(np.rint(np.geomspace(1, longest, _lags(count))).astype(int))
    moved = inputs - inputs[0]
    earlier = np.concatenate([_late(moved, lag) for lag in spread.tolist()], axis=1)
    regression = [residuals, jacobian, earlier]
    if noise is not None:
        regression = [noise.whitened(each) for each in regression]
    return ResidualTests(whiteness, _f_test(*regression), noise)


def _lags(count: int) -> int:
    return max(2, min(_LAGS, count // 12))


def _late(signal: np.ndarray, lag: int) -> np.ndarray:
    """Return a signal some samples late; zero before it."""
    late = np.zeros_like(signal)
    late[lag:] = signal[: len(signal) - lag]
    return late


def _f_test(
    residuals: np.ndarray,
    jacobian: np.ndarray,
    further: np.ndarray,
    expected: np.ndarray | None = None,
) -> float:
    """Return the probability of so good an explanation by `further` [N, q] by chance.

    `expected` are the products of `further` and residuals where it explains nothing.
    """
    from scipy.stats import f

    first = basis_of(jacobian)
    rest = residuals - first @ (first.T @ residuals)
    beside = further - first @ (first.T @ further)
    sizes = np.linalg.norm(further, axis=0)
    kept = np.linalg.norm(beside, axis=0) > _RANK * sizes
    beside, sizes = beside[:, kept] / sizes[kept], sizes[kept]
    products = beside.T @ rest
    if expected is not None:
        products = products - expected[kept] / sizes
    _, strengths, directions = np.linalg.svd(beside, full_matrices=False)
    strong = strengths > _RANK * strengths[:1].sum()
    shares = (directions[strong] @ products) / strengths[strong]
    explained = float(shares @ shares)
    freedom = len(residuals) - first.shape[1] - len(shares)
    unexplained = float(rest @ rest) - explained
    if not len(shares) or freedom < 1 or unexplained <= 0.0:
        return 1.0
    ratio = explained / len(shares) / (unexplained / freedom)
    return float(f.sf(ratio, len(shares), freedom))


def basis_of(columns: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the directions that some columns have."""
    sizes = np.linalg.norm(columns, axis=0)
    shares = columns[:, sizes > 0.0] / sizes[sizes > 0.0]
    if not shares.shape[1]:
        return shares
    left, strengths, _ = np.linalg.svd(shares, full_matrices=False)
    return np.asarray(left[:, strengths > _RANK * strengths[0]])


def chance_of_no_effect(
    alone: np.ndarray,
    left: np.ndarray,
    *,
    further: int,
    parameters: int,
    noise: NoiseModel | None = None,
    rounding: float = 0.0,
) -> float:
    """Return the probability that an input without any effect explains as much.

    An F test of a model, which leaves `left` [N], against the same model without its input, which
    leaves `alone`. Where the residuals are coloured, both are whitened by their noise model first.
    `further` counts the parameters that the input brought, with those that were searched, and
    `parameters` all; what is smaller than the rounding is the arithmetic's.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(200)
    >>> late = np.sign(np.sin(np.arange(200.0)))
    >>> chance_of_no_effect(noise + late, noise, further=2, parameters=4) < 1e-6
    True
    """
    from scipy.stats import f

    if noise is not None:
        alone, left = noise.whitened(alone), noise.whitened(left)
    freedom = len(left) - parameters
    least = len(left) * rounding**2
    unexplained = max(float(left @ left), least)
    explained = float(alone @ alone) - float(left @ left) - least
    if freedom < 1 or explained <= 0.0 or unexplained <= 0.0:
        return 1.0
    return float(f.sf(explained / further / (unexplained / freedom), further, freedom))
