"""How an uncertain number is distributed: its quantiles, what lies below a value, its ends."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text

#: No unit number is nearer to 0 or to 1: what is less likely than that is never drawn.
LEAST_SHARE = 2.0**-53


class Distribution(ABC):
    """Of one number, in the SI unit of its signal.

    Examples
    --------
    >>> Uniform(2.0, 4.0).quantile(np.array([0.25, 0.5])).tolist(), Uniform(2.0, 4.0).below(2.5)
    ([2.5, 3.0], 0.25)
    """

    @abstractmethod
    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie, each share inside of (0, 1)."""

    @abstractmethod
    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""

    @property
    @abstractmethod
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value; infinite where there is none."""

    @abstractmethod
    def words(self, signal: Signal) -> str:
        """Return it in words, in the unit that the reader sees of its signal."""

    @property
    def has_tails(self) -> bool:
        """Whether a little of it may lie outside of what is possible, to be cut off."""
        return False

    def outside(self, low: float, high: float) -> float:
        """Return the share that lies outside of a range."""
        least, most = self.ends
        lower = self.below(low) if least < low else 0.0
        return lower + (1.0 - self.below(high) if most > high else 0.0)

    def truncated(self, low: float, high: float) -> Distribution:
        """Return what of it lies in a range, as large a part as is needed to be the whole."""
        if self.outside(low, high) <= LEAST_SHARE:
            return self
        return Truncated(self, low, high)


@dataclass(frozen=True)
class Uniform(Distribution):
    """Every value from `low` to `high` is as likely as any other."""

    low: float
    high: float

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        return np.asarray(self.low + (self.high - self.low) * unit)

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        return min(max((value - self.low) / (self.high - self.low), 0.0), 1.0)

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value."""
        return self.low, self.high

    def truncated(self, low: float, high: float) -> Distribution:
        """Return what of it lies in a range."""
        return Uniform(max(self.low, low), min(self.high, high))

    def words(self, signal: Signal) -> str:
        """Return it in words.

        >>> Uniform(0.0026, 0.003).words(Signal("tank_1.area", "m^2", "cm^2", initial=0.0028))
        'uniform within 7.143 %, 26 to 30 cm²'
        """
        middle, half = (self.low + self.high) / 2.0, (self.high - self.low) / 2.0
        centred = signal.initial and math.isclose(middle, signal.initial, rel_tol=1e-9)
        within = f" within {_percent(half / abs(signal.initial))}" if centred else ""
        return f"uniform{within}, {shown(signal, self.low, self.high)}"


@dataclass(frozen=True)
class Normal(Distribution):
    """Bell-shaped, with a mean and a standard deviation."""

    mean: float
    deviation: float

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        from scipy.special import ndtri

        return np.asarray(self.mean + self.deviation * ndtri(unit))

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        return _normal_share((value - self.mean) / self.deviation)

    @property
    def ends(self) -> tuple[float, float]:
        """None."""
        return -math.inf, math.inf

    @property
    def has_tails(self) -> bool:
        """It has."""
        return True

    def words(self, signal: Signal) -> str:
        """Return it in words.

        >>> Normal(3e-6, 9e-8).words(Signal("pump_1.gain", "m^3/s", "cm^3/s", initial=3e-6))
        'normal with a deviation of 3 %, about 3 cm³/s'
        """
        share = self.deviation / abs(self.mean) if self.mean else None
        deviation = shown(signal, self.deviation) if share is None else _percent(share)
        return f"normal with a deviation of {deviation}, about {shown(signal, self.mean)}"


@dataclass(frozen=True)
class LogNormal(Distribution):
    """Its logarithm is normal, with a deviation; of a negative median, that of its size."""

    median: float
    deviation: float

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        from scipy.special import ndtri

        growth = math.copysign(self.deviation, self.median)
        return np.asarray(self.median * np.exp(growth * ndtri(unit)))

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        ratio = value / self.median
        if ratio <= 0.0:
            return 0.0 if self.median > 0.0 else 1.0
        return _normal_share(math.log(ratio) / math.copysign(self.deviation, self.median))

    @property
    def ends(self) -> tuple[float, float]:
        """Zero at one side, none at the other."""
        return (0.0, math.inf) if self.median > 0.0 else (-math.inf, 0.0)

    @property
    def has_tails(self) -> bool:
        """It has."""
        return True

    def words(self, signal: Signal) -> str:
        """Return it in words.

        >>> LogNormal(7.1e-6, 0.05).words(Signal("outlet_1.area", "m^2", "cm^2", initial=7.1e-6))
        'log-normal with a deviation of 5 %, median 0.071 cm²'
        """
        deviation = _percent(self.deviation)
        return f"log-normal with a deviation of {deviation}, median {shown(signal, self.median)}"


@dataclass(frozen=True)
class Measured(Distribution):
    """One of a few values, ascending, each as often as its share of all."""

    values: tuple[float, ...]
    shares: tuple[float, ...]

    @classmethod
    def of(cls, values: tuple[float, ...], weights: tuple[float, ...] = ()) -> Measured:
        """Return it by values in any order with their weights, alike where there are none.

        >>> Measured.of((3.0, 1.0), (1.0, 3.0))
        Measured(values=(1.0, 3.0), shares=(0.75, 0.25))
        """
        weights = weights or (1.0,) * len(values)
        pairs = sorted(zip(values, weights, strict=True))
        total = math.fsum(weights)
        return cls(tuple(v for v, _ in pairs), tuple(weight / total for _, weight in pairs))

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        # The last step is left out: there is nothing above the last value.
        steps = np.cumsum(self.shares)[:-1]
        return np.array(self.values)[np.searchsorted(steps, unit, side="left")]

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        pairs = zip(self.values, self.shares, strict=True)
        return math.fsum(share for each, share in pairs if each <= value)

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value."""
        return self.values[0], self.values[-1]

    def words(self, signal: Signal) -> str:
        """Return it in words.

        >>> Measured.of((6.9e-6, 7.1e-6, 7.5e-6)).words(Signal("outlet_1.area", "m^2", "cm^2"))
        'one of 3 values, 0.069 to 0.075 cm²'
        """
        return f"one of {len(self.values)} values, {shown(signal, *self.ends)}"


@dataclass(frozen=True)
class Scaled(Distribution):
    """As far above or below its own value, as a share of it, as another number is.

    Parameters
    ----------
    other : str
        The name of that number.
    source : Distribution
        Of that.
    centre, own : float
        Its value and the own one, neither 0.
    """

    other: str
    source: Distribution
    centre: float
    own: float

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        return self.own + self._ratio * (self.source.quantile(unit) - self.centre)

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        return self.source.below(self.centre + (value - self.own) / self._ratio)

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value; infinite where there is none."""
        low, high = (self.own + self._ratio * (end - self.centre) for end in self.source.ends)
        return low, high

    @property
    def has_tails(self) -> bool:
        """Whether a little of it may lie outside of what is possible, to be cut off."""
        return self.source.has_tails

    def words(self, signal: Signal) -> str:
        """Return it in words."""
        return f"as {self.other}, about {shown(signal, self.own)}"

    @property
    def _ratio(self) -> float:
        return abs(self.own / self.centre)


@dataclass(frozen=True)
class Truncated(Distribution):
    """What of another distribution lies from `low` to `high`."""

    whole: Distribution
    low: float
    high: float

    def quantile(self, unit: np.ndarray) -> np.ndarray:
        """Return the values below which these shares lie."""
        first, last = self._shares
        # Near the ends a share's last bit is more than a value's.
        return np.clip(self.whole.quantile(first + (last - first) * unit), self.low, self.high)

    def below(self, value: float) -> float:
        """Return the share that lies at a value or below it."""
        first, last = self._shares
        return min(max((self.whole.below(value) - first) / (last - first), 0.0), 1.0)

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest value."""
        low, high = self.whole.ends
        return max(low, self.low), min(high, self.high)

    @property
    def has_tails(self) -> bool:
        """Whether a little of it may lie outside of what is possible, to be cut off."""
        return self.whole.has_tails

    def words(self, signal: Signal) -> str:
        """Return it in words.

        >>> Truncated(Normal(0.9, 0.03), 0.0, 1.0).words(Signal("splitter_1.tank_1", initial=0.9))
        'normal with a deviation of 3.333 %, about 0.9, of which 0 to 1 is left'
        """
        return f"{self.whole.words(signal)}, of which {span_words(signal, *self.ends)} is left"

    @property
    def _shares(self) -> tuple[float, float]:
        least, most = self.whole.ends
        first = self.whole.below(self.low) if least < self.low else 0.0
        return first, self.whole.below(self.high) if most > self.high else 1.0


def shown(signal: Signal, *values: float) -> str:
    """Return values [SI] with the unit that the reader sees, from the first to the last.

    >>> shown(Signal("tank_1.area", "m^2", "cm^2"), 0.00266, 0.00294)
    '26.6 to 29.4 cm²'
    """
    unit = signal.shown_unit
    text = " to ".join(f"{from_si(each, signal.unit, unit):.4g}" for each in values)
    return f"{text} {unit_text(unit)}".rstrip()


def span_words(signal: Signal, low: float, high: float) -> str:
    """Return a range [SI] in words, where it may be open at an end.

    >>> span_words(Signal("tank_1.area", "m^2", "cm^2"), 0.0, math.inf)
    '0 cm² or more'
    """
    if math.isinf(high):
        return f"{shown(signal, low)} or more"
    return f"{shown(signal, high)} or less" if math.isinf(low) else shown(signal, low, high)


def _percent(share: float) -> str:
    return f"{100.0 * share:.4g} %"


def _normal_share(deviates: float) -> float:
    from scipy.special import ndtr

    return float(ndtr(deviates))
