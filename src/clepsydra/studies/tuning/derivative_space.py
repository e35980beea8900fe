"""The search space of PID loops that begin as PI loops: derivatives with filters that filter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.signals import owners
from clepsydra.designs.loops.multiloop import MultiloopPid
from clepsydra.linear.analysis import Analysis
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.parameters import settings_of

#: Derivative time of the start, a share of the integral time.
_SHARE = 0.1
#: Smallest and largest derivative time over the time constant of its filter.
_LEAST, _MOST = 1.0, 10.0
#: The filter is longer than the sampling period by this factor, within which values are rounded.
_BEYOND_ROUNDING = 1.0001


def with_derivative(controller: Controller, analysis: Analysis) -> Controller:
    """Return PID loops with the settings of PI loops, and a derivative time of a tenth of Ti.

    No derivative time is below the sampling period.

    Raises
    ------
    NotApplicable
        As `clepsydra.designs.loops.multiloop.MultiloopPid`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> pi = cl.design.simc(plant)
    >>> pid = with_derivative(pi, plant.analysis)
    >>> ratio = pid.values["level_1.derivative_time"] / pi.values["level_1.integral_time"]
    >>> round(ratio, 9), pid.name
    (0.1, 'PI, SIMC with a derivative')
    """
    together = MultiloopPid(analysis.model, analysis.pairing, PidForm("PID"), "tuned")
    blank, period = together.blank, together.process.sampling_period
    own = {name: value for name, value in controller.values.items() if name in blank.values}
    values = {**blank.values, **own}
    loops = owners(blank.law.parameters, "derivative_time")
    for loop in loops:
        tenth = _SHARE * values[path(loop, "integral_time")]
        values[path(loop, "derivative_time")] = max(tenth, _BEYOND_ROUNDING * period)
    values |= {name: float(value) for name, value in _following(loops, values, period).items()}
    return replace(
        blank,
        name=f"{controller.name} with a derivative",
        values=values,
        initial_state=state_at_rest(blank.law, values, together.point.as_dict()),
        design=controller.design,
        notes=controller.notes,
    )


@dataclass(frozen=True, eq=False)
class DerivativeSpace(LawSpace):
    """The settings of PID loops, each derivative filtered with a sampling period at least.

    A filter that is shorter has forgotten everything by the next sample. The tracking time is
    √(Ti Td), as designs have it.

    Examples
    --------
    At a corner with Td/N below the sampling period of 60 s, N comes down until it is one:

    >>> import clepsydra as cl
    >>> plant = cl.load("eight-tanks")
    >>> space = DerivativeSpace.around(with_derivative(cl.design.simc(plant), plant.analysis), 60.0)
    >>> found = space.values_at(np.ones(5))
    >>> time = found["level_8.derivative_time"] / found["level_8.derivative_filter"]
    >>> time.round(1)
    array([60.])
    """

    period: float = field(kw_only=True)

    @classmethod
    def around(cls, controller: Controller, period: float) -> DerivativeSpace:
        """Return the space around loops that `with_derivative` made, at a sampling period [s]."""
        parameters = []
        for each in settings_of(controller):
            part = each.name.rpartition(".")[2]
            if part == "derivative_time":
                each = replace(each, low=max(each.low, _BEYOND_ROUNDING * period))
            elif part == "derivative_filter":
                each = replace(each, low=_LEAST, high=_MOST)
            parameters.append(each)
        return cls(controller, parameters, period=period)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the values of the tuned parameters and of what follows them [n]."""
        values = super().values_at(points)
        loops = owners(self.controller.law.parameters, "derivative_time")
        return values | _following(loops, values, self.period)


def _following(
    loops: Iterable[str], values: Mapping[str, ArrayLike], period: float
) -> dict[str, np.ndarray]:
    """Return the filters, shortened at most to the period [s], and the tracking times of loops."""
    found = {}
    for loop in loops:
        time = np.asarray(values[path(loop, "derivative_time")])
        longest = np.maximum(_LEAST, time / (_BEYOND_ROUNDING * period))
        ratio = path(loop, "derivative_filter")
        found[ratio] = np.minimum(values[ratio], longest)
        found[path(loop, "tracking_time")] = np.sqrt(values[path(loop, "integral_time")] * time)
    return found
