"""Section 5: the tanks filled by conventional and by variable-structure PID, Figs. 3 to 6."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.comparison import claimed, compared
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
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
    "Settings and limits are not printed; read as Johansson's PI controllers in volts, pumps from "
    "0 to 10 V, tanks from empty to 12.4 and 12.7 cm."
)
#: An overshoot below this is "almost none" [%].
ALMOST_NONE = 1.0
#: So much of a filling is drawn [s].
SHOWN = 200.0
#: The levels nearest to the rim that the pumps still hold, with room for a little overshoot [m].
HIGH = (0.185, 0.185)


def filling() -> Findings:
    """Fill the tanks with both controllers, in volts and in ν."""
    runs = {
        "conventional": fill(in_volts("clamping")),
        "variable": fill(in_volts("variable_structure")),
        "conventional in ν": fill(in_nu("clamping")),
        "variable in ν": fill(in_nu("variable_structure")),
        "variable, α in volts": fill(in_nu("variable_structure", alpha_on="input")),
    }
    rows = [
        *_overshoots(runs),
        *_speed(runs["conventional"], runs["variable"]),
        *_saturation(runs["conventional"], runs["variable"]),
        *_energy(runs["conventional"], runs["variable"]),
        *_overflow(),
    ]
    return Findings(tuple(rows), _figures(runs["conventional"], runs["variable"]))


def _overshoots(runs: dict[str, Filling]) -> list[Row]:
    rows = []
    for tank in (1, 2):
        rows.append(
            compared(
                PLACE,
                f"overshoot of h{tank}, conventional PID",
                "12",
                runs["conventional"].overshoot(tank),
                "%",
                tolerance=0.1,
                why=f"printed as “around”. {_READING} While a pump stands at 10 V the integral "
                "does not reach its limit, so that clamping it changes nothing.",
                unprinted=_READING + " The two levels overshoot differently; one number is "
                "printed for both.",
            )
        )
    for tank in (1, 2):
        rows.append(
            compared(
                PLACE,
                f"overshoot of h{tank}, conventional PID on the linearised tanks",
                "12",
                runs["conventional in ν"].overshoot(tank),
                "%",
                tolerance=0.1,
                why="printed as “around”",
                unprinted="With ν from the same PI controllers (Kp = E K, M = 0, P = I) the "
                "lower tanks have no self-regulation left, and overshoot more than in volts.",
            )
        )
    for name, words in (
        ("variable", "in volts"),
        ("variable in ν", "on the linearised tanks, α in ν"),
        ("variable, α in volts", "on the linearised tanks, α in volts"),
    ):
        for tank in (1, 2):
            value = runs[name].overshoot(tank)
            rows.append(
                claimed(
                    PLACE,
                    f"overshoot of h{tank}, variable-structure PID {words}",
                    "almost no overshoot",
                    value <= ALMOST_NONE,
                    f"{value:.1f}",
                    "%",
                    reason=f"α = 0.1, pumps from 0 to 10 V; almost none is at most "
                    f"{ALMOST_NONE:g} %.",
                )
            )
    return rows


def _speed(conventional: Filling, variable: Filling) -> list[Row]:
    rows = []
    for tank in (1, 2):
        for what, old, new, words in (
            (
                "settling time to 2 %",
                conventional.settling(tank),
                variable.settling(tank),
                "It settles earlier because it does not overshoot.",
            ),
            (
                "rise time",
                conventional.rise(tank),
                variable.rise(tank),
                "From 10 to 90 % it is slower: while it saturates its integral is taken back, so "
                "that the pump leaves its limit early.",
            ),
            (
                "integral of the absolute error",
                conventional.absolute_error(tank),
                variable.absolute_error(tank),
                "What the overshoot costs and what the slower rise costs, in one number.",
            ),
        ):
            judged = what.startswith("integral")
            rows.append(
                claimed(
                    "abstract" if judged else PLACE,
                    f"{what} of h{tank}",
                    "improves the control performance" if judged else "the response is faster",
                    new < old,
                    f"{new:.3g} against {old:.3g}",
                    "cm s" if judged else "s",
                    reason=f"Variable structure against clamping, in volts. {words}",
                )
            )
    return rows


def _saturation(conventional: Filling, variable: Filling) -> list[Row]:
    rows = []
    for pump in (1, 2):
        old = conventional.saturated(pump, LIMIT)
        new = variable.saturated(pump, LIMIT)
        rows.append(
            claimed(
                PLACE,
                f"time of v{pump} at a limit",
                "returns within the constrained range much faster",
                new < 0.5 * old,
                f"{new:.3g} against {old:.3g}",
                "s",
                reason="Counted at both limits; much faster is less than half the time. "
                "Leaving the limit early is what makes the rise slower.",
            )
        )
    analysis = at_target()
    equal = _unsaturated()
    rows.append(
        claimed(
            "section 4, (1)",
            "behaviour without saturation",
            "the same as the linear analysis",
            equal == 0.0,
            f"{equal:.1g}",
            "cm",
            reason="Largest difference of the levels between variable structure and no "
            "anti-windup where the pumps may go to 1000 V; below zero they are limited as ever, "
            f"which a filling to {100 * analysis.operating_point.state[0]:.3g} cm does not reach.",
        )
    )
    return rows


def _unsaturated() -> float:
    """Return by how much the structure changes a filling with pumps without upper limit [cm]."""
    runs = [fill(in_volts(way), limits=1000.0) for way in ("none", "variable_structure")]
    return max(abs(runs[0].level(j) - runs[1].level(j)).max() for j in (1, 2))


def _energy(conventional: Filling, variable: Filling) -> list[Row]:
    old, new = conventional.pumped(), variable.pumped()
    squares = conventional.electric(), variable.electric()
    return [
        claimed(
            PLACE,
            "water lifted in ten minutes",
            "saves energy",
            new < old,
            f"{new:.2f} against {old:.2f}",
            "l",
            reason="The pumps lift through one height, so that the energy to the water is in "
            f"proportion to the volume: {100 * (1 - new / old):.1f} % less, once for a filling "
            "and nothing afterwards.",
        ),
        claimed(
            PLACE,
            "squared voltage of both pumps in ten minutes",
            "saves energy",
            squares[1] < squares[0],
            f"{squares[1]:.0f} against {squares[0]:.0f}",
            "V² s",
            reason="What the motors turn into heat goes with the square of the voltage: "
            f"{100 * (1 - squares[1] / squares[0]):.0f} % less, since the pumps stand at 10 V "
            "for a shorter time.",
        ),
    ]


def _overflow() -> list[Row]:
    old = fill(in_volts("clamping"), target=HIGH)
    new = fill(in_volts("variable_structure"), target=HIGH)
    level = f"{100 * HIGH[0]:g}"
    return [
        claimed(
            PLACE,
            f"water over the rims, conventional PID to {level} cm",
            "prone to overflow when the target level is high",
            old.spilt() > 0.0,
            f"{old.spilt():.3g}",
            "cm³",
            reason="The tanks are 20 cm high, with the rim as a weir; the overshoot of 12 % "
            "passes it.",
        ),
        claimed(
            PLACE,
            f"water over the rims, variable-structure PID to {level} cm",
            "almost no overshoot",
            new.spilt() == 0.0,
            f"{new.spilt():.3g}",
            "cm³",
            reason=f"It overshoots by {new.overshoot(1):.1f} and {new.overshoot(2):.1f} %, and "
            "the rim is 8 % above the target.",
        ),
    ]


def _figures(conventional: Filling, variable: Filling) -> tuple[Figure, ...]:
    both = (("conventional PID, clamping", conventional), ("variable-structure PID", variable))
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
