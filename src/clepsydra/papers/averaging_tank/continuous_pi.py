"""The tank under PI control in continuous time, as the document has it: no hold distorts it.

The integral time of (81), 0.8 ms, makes the loop of C swing with 95 rad/s: held over 0.2 ms, its
IAE would be 0.0168 and not 0.0115.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.step_run import STEPS
from clepsydra.papers.averaging_tank.symbols import C0, FLOW, INLET, V0, Variant, constant_flow
from clepsydra.papers.settling_bands import BANDS
from clepsydra.scores.step_response import overshoot, rise_time, settling_time

#: Between points that are kept [s].
_KEPT = 1e-4
HIGHEST_FLOW, HIGHEST_INLET = PRINTED.numbers(
    "section 3.3", "highest f_in and f_out", "highest C_in"
)
_REST = {"C": C0, "V": V0}
#: Where the document starts.
_START = PRINTED.numbers("section 2.2", "C_p", "V_p")
_TARGET = {output: rest + STEPS[output] for output, rest in _REST.items()}


class Constants(NamedTuple):
    """K_pC, T_iC [s], K_pV [1/s] and T_iV [s] of one variant."""

    constant: Variant
    tuned: str
    gain_c: float
    time_c: float
    gain_v: float
    time_v: float

    def summed(self, period: float) -> Constants:
        """Return those of a sum for the integral without the present error that have it in it.

        In it the present error counts for a sampling period [s]: Kp (1 + Δt/Ti) and Ti + Δt.

        Examples
        --------
        >>> Constants("outflow", "", 50.0, 1.0, 8.0, 2.0).summed(0.5)[2:]
        (75.0, 1.5, 10.0, 2.5)
        """
        return self._replace(
            gain_c=self.gain_c * (1.0 + period / self.time_c),
            time_c=self.time_c + period,
            gain_v=self.gain_v * (1.0 + period / self.time_v),
            time_v=self.time_v + period,
        )

    @property
    def title(self) -> str:
        """What the reader sees."""
        return f"{constant_flow(self.constant)}, {self.tuned}"


@dataclass(frozen=True)
class ContinuousRun:
    """The document's step in continuous time."""

    time: np.ndarray  # [n] [s]
    outputs: dict[str, np.ndarray]  # C [kmol/m³] and V [m³], each [n]
    flow: np.ndarray  # the one that is moved [n] [m³/s]
    inlet: np.ndarray  # C_in [n] [kmol/m³]
    indices: dict[tuple[str, str], float]  # ("IAE", "C") and so on, integrated with the states

    def settling(self, output: str, band: float = BANDS[0]) -> float:
        """Return when C or V stays within a share of its step [s]."""
        return settling_time(*self._step(output), band=band)

    def rise_time(self, output: str) -> float:
        """Return from when to when C or V covers 10 to 90 % of its step [s]."""
        return rise_time(*self._step(output))

    def overshoot(self, output: str) -> float:
        """Return the overshoot of C or V [% of its step]."""
        return overshoot(*self._step(output))

    def _step(self, output: str) -> tuple[np.ndarray, np.ndarray, float, float]:
        return self.time, self.outputs[output], _REST[output], _TARGET[output]

    def at_limit(self, name: str) -> float:
        """Return how long "flow" or "inlet" stands at a limit [s]."""
        values, high = (self.flow, HIGHEST_FLOW) if name == "flow" else (self.inlet, HIGHEST_INLET)
        return _KEPT * float(np.count_nonzero((values <= 1e-9) | (values >= high - 1e-9)))


@cache
def continuous_run(
    constants: Constants, *, free: bool = False, horizon: float = 20.0, longest_step: float = 1e-3
) -> ContinuousRun:
    """Return the document's step of both references under PI control without a hold.

    Times are in s; `free` lets C_in go without limits.

    Examples
    --------
    >>> best = Constants("outflow", "(81)", 74.37, 8.325e-4, 8.0, 0.5)
    >>> round(continuous_run(best, free=True, horizon=2.0).indices["IAE", "C"], 4)
    0.0115
    """
    from scipy.integrate import odeint

    gain_c, time_c, gain_v, time_v = constants[2:]
    sign = 1.0 if constants.constant == "outflow" else -1.0
    lowest, highest = (-np.inf, np.inf) if free else (0.0, HIGHEST_INLET)

    def wanted(C: Any, V: Any, sum_c: Any, sum_v: Any) -> tuple[Any, Any]:
        """Return the flow that is moved and C_in as the controllers want them."""
        inlet = INLET + gain_c * (_TARGET["C"] - C + sum_c / time_c)
        return FLOW + sign * gain_v * (_TARGET["V"] - V + sum_v / time_v), inlet

    def rates(t: float, x: np.ndarray) -> tuple[float, ...]:
        """Return the slopes of C and V, and of IE, IAE, ISE and ITAE of each."""
        C, V, sum_c, _, _, _, sum_v, *_ = x.tolist()
        flow, inlet = wanted(C, V, sum_c, sum_v)
        flow, inlet = min(max(flow, 0.0), HIGHEST_FLOW), min(max(inlet, lowest), highest)
        inflow, outflow = (flow, FLOW) if sign > 0.0 else (FLOW, flow)
        of_c, of_v = _TARGET["C"] - C, _TARGET["V"] - V
        return (
            inflow / V * (inlet - C), inflow - outflow,
            of_c, abs(of_c), of_c * of_c, t * abs(of_c),
            of_v, abs(of_v), of_v * of_v, t * abs(of_v),
        )  # fmt: skip

    kept = np.linspace(0.0, horizon, round(horizon / _KEPT) + 1)
    # In one call of LSODA, whose steps are too many to come back to Python after each.
    found = odeint(
        rates, [*_START, *np.zeros(8)], kept, tfirst=True, tcrit=[horizon],
        rtol=1e-8, atol=1e-10, hmax=longest_step,
    ).T  # fmt: skip
    keys = [(index, output) for output in _REST for index in ("IE", "IAE", "ISE", "ITAE")]
    indices = dict(zip(keys, map(float, found[2:, -1]), strict=True))
    outputs = dict(zip(_REST, found, strict=False))
    flow, inlet = wanted(*found[[0, 1, 2, 6]])
    limited = np.clip(flow, 0.0, HIGHEST_FLOW), np.clip(inlet, lowest, highest)
    return ContinuousRun(kept, outputs, *limited, indices)
