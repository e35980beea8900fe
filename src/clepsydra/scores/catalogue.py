"""The scores by name: what the tables and reports say about each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class ScoreDescription:
    """What a reader must know of a score.

    Parameters
    ----------
    key : str
        Its name in results; a score of one signal has the key "key[signal]".
    title : str
        As in the head of a table.
    unit_rule : str
        Its unit in words, from the unit of the signal that it judges.
    better : {"less", "more"}
        Which way it improves.
    description : str
        One sentence.

    Examples
    --------
    >>> SCORES["iae"].title, SCORES["iae"].unit_rule, SCORES["iae"].better
    ('IAE', 'signal unit × s', 'less')
    """

    key: str
    title: str
    unit_rule: str
    better: Literal["less", "more"]
    description: str


SCORES: dict[str, ScoreDescription] = {
    score.key: score
    for score in (
        ScoreDescription(
            "iae",
            "IAE",
            "signal unit × s",
            "less",
            "Integral of the absolute error over the whole run.",
        ),
        ScoreDescription(
            "ise",
            "ISE",
            "signal unit² × s",
            "less",
            "Integral of the squared error over the whole run; large errors weigh more.",
        ),
        ScoreDescription(
            "overshoot",
            "Overshoot",
            "% of the step",
            "less",
            "How far the output passes its setpoint after a step of it, in the worst step.",
        ),
        ScoreDescription(
            "rise_time",
            "Rise time",
            "s",
            "less",
            "From 10 % to 90 % of a setpoint step, in the slowest step.",
        ),
        ScoreDescription(
            "settling_time",
            "Settling time",
            "s",
            "less",
            "From a setpoint step until the output stays within 5 % of it, in the slowest step.",
        ),
        ScoreDescription(
            "peak_deviation",
            "Peak deviation",
            "signal unit",
            "less",
            "Largest distance to the setpoint after a load step, in the worst load step.",
        ),
        ScoreDescription(
            "return_time",
            "Return time",
            "s",
            "less",
            "From a load step until the output stays near its setpoint, in the slowest case.",
        ),
        ScoreDescription(
            "total_variation",
            "Total variation",
            "signal unit",
            "less",
            "Sum of all moves of the manipulated variable: wear of the actuator.",
        ),
        ScoreDescription(
            "time_in_saturation",
            "Time in saturation",
            "s",
            "less",
            "How long the manipulated variable stood at a limit.",
        ),
    )
}
