"""Section 5: the tanks filled by conventional and by variable-structure PID, Figs. 3 to 6."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.comparison import claimed, compared, remark, undecided
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.decoupled import (
    DECOUPLED_READINGS,
    IN_VOLTS,
    LIMITS,
    READING,
    at_limit,
    decoupled,
)
from clepsydra.papers.four_tank_variable_structure.readings import (
    CONVENTIONAL,
    OTHERS,
    READINGS,
    SATURATED,
    UNDECOUPLED,
    USUAL,
    both,
    filled,
    saturating,
)
from clepsydra.papers.four_tank_variable_structure.rig import (
    SETTINGS,
    TARGET,
    VOLTS_PER_METRE,
    Filling,
    fill,
    in_nu,
    in_volts,
)
from clepsydra.papers.four_tank_variable_structure.settling import speed
from clepsydra.papers.row import Row

PLACE = "section 5"
#: So much of a filling is drawn [s].
SHOWN = 200.0
#: The levels nearest to the rim that the pumps still hold, with room for a little overshoot [m].
HIGH = (0.185, 0.185)
_WAYS = (CONVENTIONAL, "variable_structure")
#: Of the document's reading, and of the reading without decoupling.
_LANE, _PLAIN = at_limit(USUAL.limit), READINGS.index(USUAL)


def filling() -> Findings:
    """Fill the tanks with both controllers, after decoupling and without."""
    rows = [
        *_overshoots(),
        *speed(),
        _saturation(),
        _without_saturation(),
        _energy(),
        _overflow(),
    ]
    return Findings(tuple(rows), _figures())


def _overshoots() -> list[Row]:
    old, new = (decoupled(way) for way in _WAYS)
    in_volts = decoupled("variable_structure", DECOUPLED_READINGS[1])
    doubled = decoupled(CONVENTIONAL, DECOUPLED_READINGS[2])
    plain, limited = filled("variable_structure"), filled(CONVENTIONAL)
    lanes = saturating()
    most = max(plain.overshoot(tank, lane) for tank in (1, 2) for lane in lanes)
    farther = max((old.overshoot(tank, _LANE) for tank in (1, 2)), key=lambda v: abs(v - 12.0))
    others = "; ".join(
        f"{limit:g} V {both(old, 'overshoot', lane=at_limit(limit))}" for limit in (6.0, 15.0, 20.0)
    )
    conventional = compared(
        PLACE,
        "overshoot of the level, conventional PID",
        "12",
        farther,
        "%",
        tolerance=0.1,
        why=f"“Around” is taken as 10 %. {READING}",
        unprinted=f"{READING} “Around” is taken as 10 %. h1 and h2 overshoot by "
        f"{both(old, 'overshoot', lane=_LANE)} %, of which the farther stands here; with other "
        f"limits {others} %. {UNDECOUPLED} with pumps to {USUAL.limit:g} V it is "
        f"{both(limited, 'overshoot', lane=_PLAIN)} %.",
    )
    return [
        undecided(
            conventional,
            "It hangs on limit and settings: with sensors of 1 V/cm, which double the gains, and "
            f"pumps to 20 V it is {both(doubled, 'overshoot', lane=at_limit(20.0))} %, about 12, "
            "and else as follows.",
        ),
        remark(
            PLACE,
            "overshoot, variable-structure PID",
            "almost no overshoot",
            both(new, "overshoot", lane=_LANE),
            "%",
            reason=f"h1 and h2. {READING} It hangs on the reading: with α in volts it is "
            f"{both(in_volts, 'overshoot', lane=_LANE)} %. {IN_VOLTS} {UNDECOUPLED} it is "
            f"{both(plain, 'overshoot', lane=_PLAIN)} %, and at most {most:.1f} % in the "
            f"{len(lanes)} of {len(READINGS)} readings ({OTHERS}) in which the pumps saturate for "
            f"{SATURATED:g} s or more.",
        ),
    ]


def _saturation() -> Row:
    shares = []
    for reading in DECOUPLED_READINGS:
        old, new = (decoupled(way, reading) for way in _WAYS)
        shares += [
            new.saturated(pump, limit, lane) / old.saturated(pump, limit, lane)
            for lane, limit in enumerate(map(float, LIMITS))
            for pump in (1, 2)
            if old.saturated(pump, limit, lane) >= SATURATED
        ]
    plain, limited = filled("variable_structure"), filled(CONVENTIONAL)
    undecoupled = [
        plain.saturated(pump, READINGS[lane].limit, lane)
        / limited.saturated(pump, READINGS[lane].limit, lane)
        for lane in saturating()
        for pump in (1, 2)
    ]
    old, new = (decoupled(way) for way in _WAYS)
    return claimed(
        PLACE,
        "time of the pumps at a limit",
        "returns to the control range within a constrained range …. The PID control is much faster",
        max(shares) < 1.0 and max(undecoupled) < 1.0,
        _pumps(new, old, _LANE),
        "s",
        reason="Our reading of a garbled sentence: “returns to the control range within a "
        "constrained range [11-13]. The PID control is much faster, while the conventional PID "
        "control can only passively adjust the control input back”. At both limits; judged as "
        f"faster, since how much is much is not said. {READING} With limits from 4 to 20 V, 0.5 or "
        "1 V/cm, and α in ν or in volts it is "
        f"{min(shares):.2f} to {max(shares):.2f} of the time wherever conventional PID saturates "
        f"for {SATURATED:g} s or more. {UNDECOUPLED} it is {min(undecoupled):.2f} to "
        f"{max(undecoupled):.2f} of it in all {len(undecoupled) // 2} readings ({OTHERS}) in which "
        f"the pumps saturate, and with pumps to {USUAL.limit:g} V "
        f"{_pumps(plain, limited, _PLAIN)} s.",
    )


def _pumps(new: Filling, old: Filling, lane: int) -> str:
    return ", ".join(
        f"v{pump} {new.saturated(pump, USUAL.limit, lane):.1f} against "
        f"{old.saturated(pump, USUAL.limit, lane):.1f}"
        for pump in (1, 2)
    )


def _without_saturation() -> Row:
    apart = [
        max(abs(old.level(tank) - new.level(tank)).max() for tank in (1, 2))
        for controller in (in_nu, in_volts)
        for old, new in [[fill(controller(way), limits=1000.0) for way in _WAYS]]
    ]
    return claimed(
        "section 4, feature (1)",
        "behaviour without saturation",
        "If saturation does not occur, the behavior of the closed-loop system and the linear "
        "analysis result are the same",
        max(apart) == 0.0,
        f"{max(apart):.1g}",
        "cm",
        reason="Where u_n is u_s, (14) integrates e and nothing else: the loop is the one without "
        "anti-windup, which after decoupling by (9) is linear, dy/dt = ν with a PI controller of "
        "ν. Largest difference of the levels between the two in fillings where the pumps may go to "
        "1000 V, after decoupling and without; below zero they are limited as ever, which these "
        "fillings do not reach.",
    )


def _energy() -> Row:
    old, new = (decoupled(way) for way in _WAYS)
    squares, volumes = (
        [getattr(run, what)(_LANE) for run in (new, old)] for what in ("electric", "pumped")
    )
    plain, limited, lanes = filled("variable_structure"), filled(CONVENTIONAL), saturating()
    saved = [
        100.0 * (1.0 - plain.electric(lane) / limited.electric(lane))
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
        f"{100 * (1 - volumes[0] / volumes[1]):.1f} % less. {READING} {UNDECOUPLED} in "
        f"{len(lanes)} of {len(READINGS)} readings ({OTHERS}) "
        f"{min(usual):.1f} to {max(usual):.1f} % of the squared voltage are saved; in the others "
        f"nearly nothing saturates, and it is {min(rest):.1f} to {max(rest):.1f} %.",
    )


def _overflow() -> Row:
    (old, new), (limited, plain) = (
        [fill(controller(way), target=HIGH) for way in _WAYS] for controller in (in_nu, in_volts)
    )
    return claimed(
        PLACE,
        "water over the rims",
        "the conventional PID control is prone to overflow when the target liquid level is high",
        min(old.spilt(), limited.spilt()) > 0.0,
        f"{old.spilt():.0f}",
        "cm³",
        reason=f"Both levels filled to {100 * HIGH[0]:g} cm in tanks 20 cm high, as Johansson's "
        f"are, which is not printed; else as follows. {READING} By the printed overshoot of 12 % "
        f"any setpoint above {20.0 / 1.12:.1f} cm runs over. With variable structure it is "
        f"{new.spilt():.3g} cm³. {UNDECOUPLED} it is {limited.spilt():.0f} against "
        f"{plain.spilt():.3g} cm³.",
    )


def _figures() -> tuple[Figure, ...]:
    runs = zip(("conventional PID", "variable-structure PID"), map(decoupled, _WAYS), strict=True)
    both_runs = tuple(runs)
    time = both_runs[0][1].time
    seen = time <= SHOWN
    figures = []
    for number, lower, upper in (("Fig. 3", 1, 3), ("Fig. 4", 2, 4)):
        panels = []
        for tank in (lower, upper):
            curves = [
                Curve(name, time[seen], run.level(tank, _LANE)[seen]) for name, run in both_runs
            ]
            if tank == lower:
                target = np.full(2, 100.0 * TARGET[tank - 1])
                curves.append(Curve("setpoint", np.array([0.0, SHOWN]), target, "dashed"))
            panels.append(Panel(f"h{tank}", f"h{tank} [cm]", tuple(curves)))
        figures.append(Figure(number, f"Levels h{lower} and h{upper}", tuple(panels), READING))
    for number, pump in (("Fig. 5", 1), ("Fig. 6", 2)):
        curves = [
            Curve(name, time[seen], run.voltage(pump, _LANE)[seen], "held")
            for name, run in both_runs
        ]
        panel = Panel(f"v{pump}", f"v{pump} [V]", tuple(curves))
        figures.append(
            Figure(
                number,
                f"Voltage v{pump}",
                (panel,),
                f"After decoupling; PI with K = {SETTINGS[pump - 1].gain:g} V/V, Ti = "
                f"{SETTINGS[pump - 1].integral_time:g} s on {VOLTS_PER_METRE / 100:g} V/cm.",
            )
        )
    return tuple(figures)
