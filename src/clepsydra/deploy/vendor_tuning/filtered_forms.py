"""The ISA and the series form of a PID with a derivative filter, each from the other."""

from __future__ import annotations

import math
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.controllers.pid_form import DerivativeOn


class FilteredPid(NamedTuple):
    """Numbers of a PID with a first-order filter on its derivative, in ISA or in series form.

    With D(s) = s/(1 + Tf s), e = r − y, and the derivative on the measurement:

    - ISA: u = K (b r − y) + K/(Ti s) e − K Td D y
    - series: u = K (b r − y′) + K/(Ti s) (r − y′), y′ = (1 + Td D) y

    Parameters
    ----------
    gain : float
        K, signed [unit of what is moved / unit of the measurement]
    integral_time : float
        Ti [s]; infinite without integral action.
    derivative_time, filter_time : float
        Td and Tf [s]
    setpoint_weight : float
        b

    Examples
    --------
    >>> FilteredPid(2.0, 30.0).derivative_time
    0.0
    """

    gain: float
    integral_time: float = math.inf
    derivative_time: float = 0.0
    filter_time: float = 0.0
    setpoint_weight: float = 1.0


def from_series(series: FilteredPid, derivative_on: DerivativeOn) -> FilteredPid:
    """Return the ISA form of a series form, exactly, with the same filter.

    1/(1 + Tf s) = 1 − Tf D takes the product of the two factors apart: with f = 1 + Td′/Ti′,
    K = K′ f, Ti = Ti′ f = Ti′ + Td′, Td = Td′ (1 − Tf/Ti′)/f. The setpoint acts as before with
    b = b′/f, or, with the derivative on the error, b = (b′ + Td′/Ti′)/f.

    Parameters
    ----------
    series : FilteredPid
    derivative_on : {"measurement", "error"}

    Examples
    --------
    >>> from_series(FilteredPid(2.0, 10.0, 2.5, 0.5), "measurement")
    FilteredPid(gain=2.5, integral_time=12.5, derivative_time=1.9, filter_time=0.5, \
setpoint_weight=0.8)
    """
    gain, integral_time, derivative_time, filter_time, weight = series
    interaction = derivative_time / integral_time
    factor = 1.0 + interaction
    if derivative_on == "error":
        weight = weight + interaction
    return FilteredPid(
        gain * factor,
        integral_time * factor,
        derivative_time * (1.0 - filter_time / integral_time) / factor,
        filter_time,
        weight / factor,
    )


def to_series(
    isa: FilteredPid, derivative_on: DerivativeOn, place: str = "series form"
) -> FilteredPid:
    """Return the series form of an ISA form, exactly, with the same filter.

    With q = √((Ti − Tf)² − 4 Ti Td): Ti′ = (Ti + Tf + q)/2, the larger of its two times,
    Td′ = Ti Td/(Ti′ − Tf) and K′ = K Ti′/Ti. Without a filter this is the known condition
    Ti ≥ 4 Td.

    Parameters
    ----------
    isa : FilteredPid
    derivative_on : {"measurement", "error"}
    place : str
        For the message.

    Raises
    ------
    InputError
        (Ti − Tf)² < 4 Ti Td: the zeros of the controller are complex, those of the series form
        are real.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3, without filter.

    Examples
    --------
    >>> to_series(FilteredPid(2.5, 12.5, 1.9, 0.5, 0.8), "measurement")
    FilteredPid(gain=2.0, integral_time=10.0, derivative_time=2.5, filter_time=0.5, \
setpoint_weight=1.0)
    """
    gain, integral_time, derivative_time, filter_time, weight = isa
    if derivative_time == 0.0 or math.isinf(integral_time):
        return isa
    apart = integral_time - filter_time
    inside = apart * apart - 4.0 * integral_time * derivative_time
    if inside < 0.0 or apart < 0.0:
        raise InputError(
            place,
            f"Ti = {integral_time:.5g} s, Td = {derivative_time:.5g} s, Tf = {filter_time:.5g} s",
            "(Ti − Tf)² of at least 4 Ti Td, that is Ti of four times Td and a little more",
            "choose the standard form of the block, or tune again with a shorter derivative time",
        )
    past = 0.5 * (apart + math.sqrt(inside))
    series_time = filter_time + past
    lead = integral_time * derivative_time / past
    factor = integral_time / series_time
    weight = weight * factor
    if derivative_on == "error":
        weight -= lead / series_time
    return FilteredPid(gain / factor, series_time, lead, filter_time, weight)
