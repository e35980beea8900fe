"""IAE, ISE, ITAE and the other integrals of the control error: what a run cost, whenever it was.

Each is written as the mean over a sample whose error runs on a straight line from a to b, and is
exact for such errors, see `clepsydra.scores.sample`.

K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4; ITAE as in D. Graham and
R. C. Lathrop, The synthesis of optimum transient response: criteria and standard forms,
Transactions of the AIEE, part II, 72(5), 1953, pages 273–288.
"""

from __future__ import annotations

from dataclasses import replace

from clepsydra.scores.sample import Expression, Fold, Sample, magnitude, where
from clepsydra.scores.score import Ranks, Score

#: The weight a of ISEG in the document that names it [s²].
WEIGHT = 0.5


def error(sample: Sample) -> Expression:
    """Return the mean of e."""
    return (sample.first + sample.last) / 2


def absolute_error(sample: Sample) -> Expression:
    """Return the mean of \\|e\\|.

    (\\|a\\| + \\|b\\|)/2, and where the error changes its sign (a² + b²) / (2 (\\|a\\| + \\|b\\|)),
    written so that it neither overflows nor underflows.

    Examples
    --------
    >>> absolute_error(Sample(before=0.0, now=4.0, setpoint=1.0))  # two triangles, 1/8 and 9/8
    np.float64(1.25)
    """
    p, q = magnitude(sample.first), magnitude(sample.last)
    return (p + q) / 2 - p * where(_crosses(sample), q / (p + q), 0)


def squared_error(sample: Sample) -> Expression:
    """Return the mean of e², (a² + a b + b²)/3."""
    a, b = sample.first, sample.last
    return (a * a + a * b + b * b) / 3


def time_absolute_error(sample: Sample) -> Expression:
    """Return the mean of t \\|e\\|, with t from the start of the segment.

    Where the sign changes after a share c of the sample, the error makes two triangles.
    """
    p, q = magnitude(sample.first), magnitude(sample.last)
    c, rest = p / (p + q), q / (p + q)
    late = where(_crosses(sample), c * c * p + rest * (2 + c) * q, p + 2 * q)
    return sample.elapsed * absolute_error(sample) + sample.length / 6 * late


def time_squared_error(sample: Sample) -> Expression:
    """Return the mean of t e², with t from the start of the segment."""
    a, b = sample.first, sample.last
    late = a * a + 2 * a * b + 3 * b * b
    return sample.elapsed * squared_error(sample) + sample.length / 12 * late


def generalised_squared_error(sample: Sample) -> Expression:
    """Return the mean of e² + a ė², with the rate from error to error at the samples.

    A step of the setpoint therefore costs a step²/Δt whatever the controller does, and ever more
    the shorter the samples are: compare the index only between runs of the same samples and steps.

    M. Kolankowski and R. Piotrowski, Design of Three Control Algorithms for an Averaging Tank
    with Variable Filling, 2022, equation (79e), with a = 0.5.
    """
    rate = (sample.error - sample.first) / sample.period
    return squared_error(sample) + WEIGHT * rate * rate


def _crosses(sample: Sample) -> Expression:
    return (sample.first > 0) != (sample.last > 0)


IE = Score(
    "ie",
    "IE",
    "Integral of the error over each step's segment, without its sign, added up; within a "
    "segment errors of both signs cancel.",
    powers=(1, 1),
    integrand=lambda sample: sample.of_step * error(sample),
    fold=Fold.SEGMENTS,
).registered()
#: The integral with its sign, over the whole of a run. Under a PI controller that ends at rest it
#: is T_i/K times the change of the manipulated variable.
SIGNED_ERROR = replace(IE, fold=Fold.INTEGRAL)
IAE = Score(
    "iae",
    "IAE",
    "Integral of the absolute error over the whole run.",
    powers=(1, 1),
    integrand=absolute_error,
).registered()
Score(
    "iae_setpoint",
    "IAE, setpoint",
    "Integral of the absolute error over the segments of all setpoint steps.",
    powers=(1, 1),
    ranks=Ranks.HELD,
    phrase="setpoint error",
    wants="setpoint",
    integrand=lambda sample: sample.of_setpoint * absolute_error(sample),
).registered()
Score(
    "iae_load",
    "IAE, load",
    "Integral of the absolute error over the segments of all load steps.",
    powers=(1, 1),
    ranks=Ranks.HELD,
    phrase="load error",
    wants="load",
    integrand=lambda sample: sample.of_load * absolute_error(sample),
).registered()
ISE = Score(
    "ise",
    "ISE",
    "Integral of the squared error over the whole run; large errors weigh more.",
    powers=(2, 1),
    integrand=squared_error,
).registered()
ITAE = Score(
    "itae",
    "ITAE",
    "Integral of the absolute error times the time since its segment began, over the whole run.",
    powers=(1, 2),
    integrand=time_absolute_error,
).registered()
ITSE = Score(
    "itse",
    "ITSE",
    "Integral of the squared error times the time since its segment began, over the whole run.",
    powers=(2, 2),
    integrand=time_squared_error,
).registered()
ISEG = Score(
    "iseg",
    "ISEG",
    "ISE and 0.5 s² times the integral of the squared rate of change of the error between "
    "samples, steps of the setpoint included: these add 0.5 s² × step² / sampling period, "
    "whatever the controller does.",
    powers=(2, 1),
    integrand=generalised_squared_error,
).registered()
