"""The scores by name: what the tables and reports say about each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ScoreDescription:
    """What a reader must know of a score; of every score, less is better.

    Parameters
    ----------
    key : str
        Its name in results; a score of one signal has the key "key[signal]".
    title : str
        As in the head of a table.
    unit_rule : str
        Its unit in words, from the unit of the signal that it judges.
    description : str
        One sentence.

    Examples
    --------
    >>> SCORES["iae"].title, SCORES["iae"].unit_rule
    ('IAE', 'signal unit × s')
    """

    key: str
    title: str
    unit_rule: str
    description: str


SCORES: dict[str, ScoreDescription] = {
    score.key: score
    for score in (
        ScoreDescription(
            "iae",
            "IAE",
            "signal unit × s",
            "Integral of the absolute error over the whole run.",
        ),
        ScoreDescription(
            "ise",
            "ISE",
            "signal unit² × s",
            "Integral of the squared error over the whole run; large errors weigh more.",
        ),
        ScoreDescription(
            "overshoot",
            "Overshoot",
            "% of the step",
            "How far the output passes its setpoint after a step of it, in the worst step.",
        ),
        ScoreDescription(
            "rise_time",
            "Rise time",
            "s",
            "From 10 % to 90 % of a setpoint step, in the slowest step.",
        ),
        ScoreDescription(
            "settling_time",
            "Settling time",
            "s",
            "From a setpoint step until the output stays within 5 % of it, in the slowest step.",
        ),
        ScoreDescription(
            "peak_deviation",
            "Peak deviation",
            "signal unit",
            "Largest distance to the setpoint after a load step, in the worst load step.",
        ),
        ScoreDescription(
            "return_time",
            "Return time",
            "s",
            "From a load step until the output stays near its setpoint, in the slowest case.",
        ),
        ScoreDescription(
            "total_variation",
            "Total variation",
            "signal unit",
            "Sum of all moves of the manipulated variable: wear of the actuator.",
        ),
        ScoreDescription(
            "time_in_saturation",
            "Time in saturation",
            "s",
            "How long the manipulated variable stood at a limit.",
        ),
    )
}
