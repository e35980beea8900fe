"""Slowing a design down until its loops, all closed, are robust."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from clepsydra.designs.applicability import NotApplicable

#: The largest peak of the sensitivity that is let pass.
SENSITIVITY_LIMIT = 2.0
#: What it means that a design was slowed, where that is told.
SLOWED_WORDS = (
    "how many times slower a rule was made than it says, with lower gains, until max|S| was at "
    f"most {SENSITIVITY_LIMIT:g}."
)
#: The most that a design is slowed down by.
LARGEST_FACTOR = 1000.0
_ITERATIONS = 60
# Factors that differ by less than this share are one: where the peak jumps, it is never just 2.
_CLOSED = 1e-10

T = TypeVar("T")


class SlowedDown(NamedTuple, Generic[T]):
    """A design, the factor that it is slower by, and the peak of its sensitivity."""

    design: T
    factor: float
    peak: float


class Search(NamedTuple):
    """How the factor is searched for.

    Parameters
    ----------
    step : float
        By which the factor grows.
    accuracy : float
        The search ends with a peak this near below the limit, a share of it.
    interpolates : bool
        1/peak between two factors, which needs fewer designs of a smooth peak; else it bisects.
    hopeless : str
        What to say where no factor is enough: {most}, {limit} and {reached}.
    unstable : str
        What was reached where no peak is finite.
    """

    step: float
    accuracy: float
    interpolates: bool
    hopeless: str
    unstable: str


#: For state feedback, whose gains are a Riccati equation's.
OF_STATE_FEEDBACK = Search(
    math.sqrt(2.0),
    1e-3,
    False,
    "slowing it down by up to {most:.0f} times does not bring the sensitivity peak to {limit:g}: "
    "{reached}",
    "every loop is unstable",
)
#: For the PID controllers of several loops.
OF_LOOPS = Search(
    2.0**0.25,
    1e-5,
    True,
    "no common slowing down of the loops by up to {most:.0f} times brings the sensitivity peak to "
    "{limit:g}: {reached}; another pairing or a multivariable controller is needed",
    "every one of them is unstable",
)


def slow_down(
    design_at: Callable[[float], T],
    peak: Callable[[T], float],
    search: Search = OF_STATE_FEEDBACK,
) -> SlowedDown[T]:
    """Return the fastest design whose loops have a sensitivity peak of 2 or less.

    A factor F ≥ 1 grows until the largest singular value of S(e^jωT) is at most 2 at every
    frequency, and is then brought back to where it is 2. For PID controllers that is Luyben's
    detuning, with the peak of the multiloop sensitivity in the place of his log modulus. An
    optimal regulator has wide margins where it acts on the measured state; with an observer it
    may have none at all (Doyle), so that the peak is computed and not trusted.

    Parameters
    ----------
    design_at : callable
        Takes F and returns a design that is slower by F.
    peak : callable
        Takes a design and returns the peak of its sensitivity, infinite where it is unstable.

    Raises
    ------
    NotApplicable
        No factor up to 1000 is enough.

    References
    ----------
    W. L. Luyben, Simple method for tuning SISO controllers in multivariable systems,
    Industrial & Engineering Chemistry Process Design and Development 25(3), 1986, 654-660.
    J. C. Doyle, Guaranteed margins for LQG regulators, IEEE Transactions on Automatic Control
    23(4), 1978, 756-757, doi 10.1109/TAC.1978.1101812.

    Examples
    --------
    Where the peak is 1 + K, a gain of 3 has to be divided by 3:

    >>> found = slow_down(lambda factor: 3.0 / factor, lambda gain: 1.0 + gain, OF_LOOPS)
    >>> round(found.factor, 3), round(found.peak, 3)
    (3.0, 2.0)
    """

    def at(factor: float) -> SlowedDown[T]:
        design = design_at(factor)
        return SlowedDown(design, factor, peak(design))

    steps = [at(1.0)]
    while steps[-1].peak > SENSITIVITY_LIMIT:
        if steps[-1].factor >= LARGEST_FACTOR:
            raise NotApplicable(_hopeless(min(each.peak for each in steps), search))
        steps.append(at(min(steps[-1].factor * search.step, LARGEST_FACTOR)))
    return _brought_back(steps[-2], steps[-1], at, search) if len(steps) > 1 else steps[0]


def _brought_back(
    fast: SlowedDown[T],
    slow: SlowedDown[T],
    at: Callable[[float], SlowedDown[T]],
    search: Search,
) -> SlowedDown[T]:
    """Return the design between two, of which the slower is robust, that just is."""
    # Aimed half the accuracy inside, so that the search ends on the allowed side.
    aim = (1.0 + 0.5 * search.accuracy) / SENSITIVITY_LIMIT

    def beyond(found: SlowedDown[T]) -> float:
        """Return how far the design is from the limit, of which a bisection asks the sign."""
        if search.interpolates:
            return 1.0 / found.peak - aim
        return 1.0 if found.peak <= SENSITIVITY_LIMIT else -1.0

    # The end that stays counts half from the second time on: the Illinois rule.
    kept = 0.5 if search.interpolates else 1.0
    low, high = math.log(fast.factor), math.log(slow.factor)
    below, above, moved = beyond(fast), beyond(slow), ""
    for _ in range(_ITERATIONS):
        if slow.peak >= SENSITIVITY_LIMIT * (1.0 - search.accuracy) or high - low < _CLOSED:
            break
        middle = high - above * (high - low) / (above - below)
        found = at(math.exp(middle))
        if found.peak <= SENSITIVITY_LIMIT:
            below *= kept if moved == "high" else 1.0
            slow, high, above, moved = found, middle, beyond(found), "high"
        else:
            above *= kept if moved == "low" else 1.0
            low, below, moved = middle, beyond(found), "low"
    return slow


def as_given(design: T, peak: Callable[[T], float], choice: str) -> SlowedDown[T]:
    """Return a design that the user chose, as it is, with the peak that it has.

    Parameters
    ----------
    peak : callable
        As for `slow_down`.
    choice : str
        For the message: "a closed-loop time constant of 10 s".

    Raises
    ------
    NotApplicable
        The loops are unstable.

    Examples
    --------
    >>> as_given(3.0, lambda gain: 2.5, "your gain").peak
    2.5
    """
    found = unslowed(design, peak)
    if math.isinf(found.peak):
        raise NotApplicable(f"the loops together are unstable at {choice}")
    return found


def unslowed(design: T, peak: Callable[[T], float]) -> SlowedDown[T]:
    """Return a design as it is, with the peak that it has."""
    return SlowedDown(design, 1.0, peak(design))


def note_on_slowing(found: SlowedDown[T], what: str) -> tuple[str, ...]:
    """Return a note where a design was slowed down.

    Examples
    --------
    >>> note_on_slowing(SlowedDown(None, 1.0, 1.5), "the regulator")
    ()
    """
    if found.factor == 1.0:
        return ()
    return (
        f"{what[0].upper()}{what[1:]} was slowed down {found.factor:.3g} times, so that the loop "
        f"keeps a sensitivity peak of at most {SENSITIVITY_LIMIT:g}.",
    )


def note_on_peak(peak: float, remedy: str) -> tuple[str, ...]:
    """Return a note where a design that the user chose has thin margins.

    Examples
    --------
    >>> note_on_peak(2.5, "choose a lower crossover")
    ('The sensitivity peak is 2.50, above 2: choose a lower crossover.',)
    """
    if peak <= SENSITIVITY_LIMIT:
        return ()
    return (f"The sensitivity peak is {peak:.2f}, above {SENSITIVITY_LIMIT:g}: {remedy}.",)


def _hopeless(smallest: float, search: Search) -> str:
    best = f"the best sensitivity peak is {smallest:.2f}"
    reached = search.unstable if math.isinf(smallest) else best
    return search.hopeless.format(most=LARGEST_FACTOR, limit=SENSITIVITY_LIMIT, reached=reached)
