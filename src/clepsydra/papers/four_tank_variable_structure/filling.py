"""Section 5: the tanks filled by conventional and by variable-structure PID, Figs. 3 to 6."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.comparison import claimed, compared, remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.readings import READINGS, USUAL, Reading, filled
from clepsydra.papers.four_tank_variable_structure.rig import (
    SETTINGS,
    TARGET,
    VOLTS_PER_METRE,
    Filling,
    at_target,
    fill,
    in_nu,
    in_volts,
)
from clepsydra.papers.row import Row

PLACE = "section 5"
LIMIT = 10.0
_READING = (
    "Limits and settings, those of its [5], are not printed; read as Johansson's PI controllers in "
    f"volts, without decoupling, on {USUAL.sensor:g} V/cm without bias, pumps from 0 to "
    f"{USUAL.limit:g} V, tanks from empty to "
    "12.4 and 12.7 cm."
)
#: Others than that reading.
_OTHERS = "0.5 or 1 V/cm, no bias or 3 V, pumps up to 6, 10 or 20 V"
#: What a conventional controller stands at a limit at least where the pumps saturate [s].
SATURATED = 1.0
#: So much of a filling is drawn [s].
SHOWN = 200.0
#: The levels nearest to the rim that the pumps still hold, with room for a little overshoot [m].
HIGH = (0.185, 0.185)
#: The document's conventional PID has a limiter at its output and nothing against windup.
CONVENTIONAL = "none"


def filling() -> Findings:
    """Fill the tanks with both controllers, in volts and in ν."""
    runs = {
        "conventional": fill(in_volts(CONVENTIONAL)),
        "variable": fill(in_volts("variable_structure")),
        "conventional in ν": fill(in_nu(CONVENTIONAL)),
        "variable in ν": fill(in_nu("variable_structure")),
        "variable, α in volts": fill(in_nu("variable_structure", alpha_on="input")),
    }
    old, new = runs["conventional"], runs["variable"]
    rows = [
        *_overshoots(runs),
        *_speed(runs),
        _saturation(runs),
        _without_saturation(),
        _energy(old, new),
        _overflow(),
    ]
    return Findings(tuple(rows), _figures(old, new))


def _both(run: Filling, what: str, form: str = ".1f") -> str:
    """Return a score of both lower levels in words."""
    return " and ".join(format(getattr(run, what)(tank), form) for tank in (1, 2))


def saturating() -> list[int]:
    """Return the lanes of the readings in which a pump saturates, as the document's do."""
    old = filled(CONVENTIONAL)
    return [
        lane
        for lane, reading in enumerate(READINGS)
        if max(old.saturated(pump, reading.limit, lane) for pump in (1, 2)) >= SATURATED
    ]


def _overshoots(runs: dict[str, Filling]) -> list[Row]:
    old, new = runs["conventional"], runs["variable"]
    found, lanes = filled("variable_structure"), saturating()
    most = max(found.overshoot(tank, lane) for tank in (1, 2) for lane in lanes)
    farther = max((old.overshoot(tank) for tank in (1, 2)), key=lambda value: abs(value - 12.0))
    return [
        compared(
            PLACE,
            "overshoot of the level, conventional PID",
            "12",
            farther,
            "%",
            tolerance=0.1,
            why=f"“Around” is taken as 10 %. {_READING}",
            unprinted=f"{_READING} “Around” is taken as 10 %. So h1 and h2 overshoot by "
            f"{_both(old, 'overshoot')} %, of which "
            "the farther stands here; on the linearised tanks it is "
            f"{_both(runs['conventional in ν'], 'overshoot')} %.",
        ),
        remark(
            PLACE,
            "overshoot, variable-structure PID",
            "almost no overshoot",
            _both(new, "overshoot"),
            "%",
            reason=f"h1 and h2. {_READING} In the "
            f"{len(lanes)} of {len(READINGS)} readings ({_OTHERS}) in which the pumps saturate for "
            f"{SATURATED:g} s or more it is at most {most:.1f} %. It hangs on the reading: on the "
            f"linearised tanks it is {_both(runs['variable in ν'], 'overshoot')} % with α in ν "
            f"and {_both(runs['variable, α in volts'], 'overshoot')} % with α in volts.",
        ),
    ]


def _speed(runs: dict[str, Filling]) -> list[Row]:
    old, new = runs["conventional"], runs["variable"]
    both = filled("variable_structure"), filled(CONVENTIONAL)
    sooner = sum(
        all(both[0].settling(tank, lane) < both[1].settling(tank, lane) for tank in (1, 2))
        for lane in range(len(READINGS))
    )
    double = READINGS.index(Reading(2.0 * USUAL.sensor, USUAL.bias, USUAL.limit))
    lanes = saturating()
    slower = sum(
        all(both[0].rise(tank, lane) > both[1].rise(tank, lane) for tank in (1, 2))
        for lane in lanes
    )
    return [
        remark(
            PLACE,
            "settling time",
            "the response is faster",
            f"{_both(new, 'settling', '.0f')} against {_both(old, 'settling', '.0f')}",
            "s",
            reason=f"h1 and h2 to 2 %. {_READING} It hangs on this reading: of {len(READINGS)} "
            f"({_OTHERS}) both levels settle sooner in {sooner}, and with {READINGS[double]} h1 "
            f"in {both[0].settling(1, double):.1f} s after {both[1].settling(1, double):.1f} s. On "
            f"the linearised tanks it is {_both(runs['variable in ν'], 'settling', '.0f')} against "
            f"{_both(runs['conventional in ν'], 'settling', '.0f')} s.",
        ),
        remark(
            PLACE,
            "rise time",
            "the response is faster",
            f"{_both(new, 'rise')} against {_both(old, 'rise')}",
            "s",
            reason="h1 and h2 from 10 to 90 %: while a pump saturates the integral is taken back, "
            "so that it leaves its limit early and the level rises slower, in "
            f"{slower} of {len(lanes)} readings in which the pumps saturate. The integrals of the "
            f"absolute error are {_both(new, 'absolute_error', '.0f')} against "
            f"{_both(old, 'absolute_error', '.0f')} cm s.",
        ),
    ]


def _saturation(runs: dict[str, Filling]) -> Row:
    times, linear = (
        [(runs[new].saturated(pump, LIMIT), runs[old].saturated(pump, LIMIT)) for pump in (1, 2)]
        for new, old in (("variable", "conventional"), ("variable in ν", "conventional in ν"))
    )
    shares = [
        filled("variable_structure").saturated(pump, READINGS[lane].limit, lane)
        / filled(CONVENTIONAL).saturated(pump, READINGS[lane].limit, lane)
        for lane in saturating()
        for pump in (1, 2)
    ]
    return claimed(
        PLACE,
        "time of the pumps at a limit",
        "returns within the constrained range much faster",
        max(shares) < 1.0 and all(one < other for one, other in linear),
        _pumps(times),
        "s",
        reason="Our reading of a garbled sentence: “returns to the control range within a "
        "constrained range [11-13]. The PID control is much faster, while the conventional PID "
        "control can only passively adjust the control input back”. At both limits; judged as "
        f"faster, since how much is much is not said. {_READING} In all {len(shares) // 2} "
        f"readings ({_OTHERS}) in which the pumps saturate it is {min(shares):.2f} to "
        f"{max(shares):.2f} of the time. On the linearised tanks it is {_pumps(linear)} s.",
    )


def _pumps(times: list[tuple[float, float]]) -> str:
    return ", ".join(
        f"v{pump} {new:.1f} against {old:.1f}" for pump, (new, old) in enumerate(times, 1)
    )


def _without_saturation() -> Row:
    equal = _unsaturated()
    return claimed(
        "section 4, (1)",
        "behaviour without saturation",
        "the same as the linear analysis",
        equal == 0.0,
        f"{equal:.1g}",
        "cm",
        reason="Where u_n is u_s, (14) integrates e and nothing else: the loop is the one without "
        "anti-windup, to which linear analysis applies. Largest difference of the levels between "
        "the two in a filling where the pumps may go to 1000 V; below zero they are limited "
        "as ever, which a filling to "
        f"{100 * at_target().operating_point.state[0]:.3g} cm does not reach.",
    )


def _unsaturated() -> float:
    """Return by how much the structure changes a filling with pumps without upper limit [cm]."""
    runs = [fill(in_volts(way), limits=1000.0) for way in (CONVENTIONAL, "variable_structure")]
    return max(abs(runs[0].level(j) - runs[1].level(j)).max() for j in (1, 2))


def _energy(old: Filling, new: Filling) -> Row:
    squares, volumes = (new.electric(), old.electric()), (new.pumped(), old.pumped())
    others, lanes = (filled("variable_structure"), filled(CONVENTIONAL)), saturating()
    saved = [
        100.0 * (1.0 - others[0].electric(lane) / others[1].electric(lane))
        for lane in range(len(READINGS))
    ]
    usual = [saved[lane] for lane in lanes]
    rest = [saved[lane] for lane in range(len(READINGS)) if lane not in lanes]
    return remark(
        PLACE,
        "energy of a filling",
        "practical significance for saving energy",
        f"{squares[0]:.0f} against {squares[1]:.0f} V² s, "
        f"{volumes[0]:.2f} against {volumes[1]:.2f} l",
        reason="No measure of energy is printed: squared voltage of both pumps in ten minutes, "
        f"{100 * (1 - squares[0] / squares[1]):.0f} % less, and water lifted, "
        f"{100 * (1 - volumes[0] / volumes[1]):.1f} % less. {_READING} In {len(lanes)} of "
        f"{len(READINGS)} readings ({_OTHERS}) "
        f"{min(usual):.1f} to {max(usual):.1f} % of the squared voltage are saved; in the others "
        f"nearly nothing saturates, and it is {min(rest):.1f} to {max(rest):.1f} %.",
    )


def _overflow() -> Row:
    old = fill(in_volts(CONVENTIONAL), target=HIGH)
    new = fill(in_volts("variable_structure"), target=HIGH)
    return claimed(
        PLACE,
        "water over the rims",
        "conventional PID is prone to overflow when the target level is high",
        old.spilt() > 0.0,
        f"{old.spilt():.0f}",
        "cm³",
        reason=f"Both levels filled to {100 * HIGH[0]:g} cm, in Johansson's tanks, 20 cm high, "
        f"with his PI controllers in volts, pumps from 0 to {LIMIT:g} V; by the printed "
        f"overshoot of 12 % any setpoint above {20.0 / 1.12:.1f} cm runs over. With variable "
        f"structure it is {new.spilt():.3g} cm³.",
    )


def _figures(conventional: Filling, variable: Filling) -> tuple[Figure, ...]:
    both = (("conventional PID", conventional), ("variable-structure PID", variable))
    seen = conventional.time <= SHOWN
    figures = []
    for number, lower, upper in (("Fig. 3", 1, 3), ("Fig. 4", 2, 4)):
        panels = []
        for tank in (lower, upper):
            curves = [Curve(name, run.time[seen], run.level(tank)[seen]) for name, run in both]
            if tank == lower:
                target = np.full(2, 100.0 * TARGET[tank - 1])
                curves.append(Curve("setpoint", np.array([0.0, SHOWN]), target, "dashed"))
            panels.append(Panel(f"h{tank}", f"h{tank} [cm]", tuple(curves)))
        figures.append(Figure(number, f"Levels h{lower} and h{upper}", tuple(panels), _READING))
    for number, pump in (("Fig. 5", 1), ("Fig. 6", 2)):
        curves = [
            Curve(name, run.time[seen], run.voltage(pump)[seen], "held") for name, run in both
        ]
        panel = Panel(f"v{pump}", f"v{pump} [V]", tuple(curves))
        figures.append(
            Figure(
                number,
                f"Voltage v{pump}",
                (panel,),
                f"PI with K = {SETTINGS[pump - 1].gain:g} V/V, Ti = "
                f"{SETTINGS[pump - 1].integral_time:g} s on {VOLTS_PER_METRE / 100:g} V/cm.",
            )
        )
    return tuple(figures)
