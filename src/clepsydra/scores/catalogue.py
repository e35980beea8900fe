"""The scores by name: what the tables and reports say about each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ScoreDescription:
    """What a reader must know of a score; less is better, but for `volume_used`.

    Parameters
    ----------
    key : str
        Its name in results; a score of one signal has the key "key[signal]".
    title : str
        As in the head of a table.
    unit_rule : str
        Its unit in words, from the unit of the signal that it judges. A unit without the words
        "signal unit" is that of the value as it stands.
    description : str
        One sentence, with the definition.

    Examples
    --------
    >>> SCORES["iae"].title, SCORES["iae"].unit_rule
    ('IAE', 'signal unit × s')
    """

    key: str
    title: str
    unit_rule: str
    description: str


_INTEGRALS = (
    ScoreDescription(
        "ie",
        "IE",
        "signal unit × s",
        "Integral of the error over each step's segment, without its sign, added up; within a "
        "segment errors of both signs cancel.",
    ),
    ScoreDescription(
        "iae",
        "IAE",
        "signal unit × s",
        "Integral of the absolute error over the whole run.",
    ),
    ScoreDescription(
        "iae_setpoint",
        "IAE, setpoint",
        "signal unit × s",
        "Integral of the absolute error over the segments of all setpoint steps.",
    ),
    ScoreDescription(
        "iae_load",
        "IAE, load",
        "signal unit × s",
        "Integral of the absolute error over the segments of all load steps.",
    ),
    ScoreDescription(
        "ise",
        "ISE",
        "signal unit² × s",
        "Integral of the squared error over the whole run; large errors weigh more.",
    ),
    ScoreDescription(
        "itae",
        "ITAE",
        "signal unit × s²",
        "Integral of the absolute error times the time since its segment began, over the whole "
        "run.",
    ),
    ScoreDescription(
        "itse",
        "ITSE",
        "signal unit² × s²",
        "Integral of the squared error times the time since its segment began, over the whole run.",
    ),
    ScoreDescription(
        "iseg",
        "ISEG",
        "signal unit² × s",
        "ISE and 0.5 s² times the integral of the squared rate of change of the error between "
        "samples, steps of the setpoint included: these add 0.5 s² × step² / sampling period, "
        "whatever the controller does.",
    ),
)

_SETPOINT_STEPS = (
    ScoreDescription(
        "overshoot",
        "Overshoot",
        "% of the step",
        "How far the output passes its setpoint after a step of it, in the worst step; – where the "
        "controller follows no setpoint.",
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
        "settling_time_2",
        "Settling time, 2 %",
        "s",
        "From a setpoint step until the output stays within 2 % of it, in the slowest step.",
    ),
    ScoreDescription(
        "settling_time_noisy",
        "Settling time, measured",
        "s",
        "From a setpoint step until the measurement never again lies outside a band for three "
        "samples in a row on one side; the band is 5 % of the step, or three standard deviations "
        "of the noise if that is more.",
    ),
)

_ALL_STEPS = (
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
        "From a load step until the output stays near its setpoint, in the slowest case; near is "
        "5 % of the setpoint step, or of the peak deviation where there is none.",
    ),
    ScoreDescription(
        "offset",
        "Offset",
        "signal unit",
        "Mean error over the last tenth of a step's segment, without its sign, in the worst one.",
    ),
)

_AVERAGING = (
    ScoreDescription(
        "outflow_rate",
        "Outflow, fastest change",
        "m³/h per h",
        "Largest rate of change, from sample to sample, of what leaves the tank, during load "
        "steps.",
    ),
    ScoreDescription(
        "variance_ratio",
        "Outflow, variance ratio",
        "1",
        "Mean square of the change of the outflow since before a load step, over that of the "
        "inflow: 0 smooths all, 1 nothing.",
    ),
    ScoreDescription(
        "volume_used",
        "Volume used",
        "% of the tank",
        "Share of the tank between its lowest and its highest level during load steps; a small "
        "one leaves smoothing unused.",
    ),
)

_EFFORT = (
    ScoreDescription(
        "total_variation",
        "Total variation",
        "signal unit",
        "Sum of all moves of the manipulated variable: wear of the actuator.",
    ),
    ScoreDescription(
        "noise_movement",
        "Noise movement",
        "signal unit",
        "Standard deviation with which measurement noise alone throws the manipulated variable "
        "about, from its moves from sample to sample.",
    ),
    ScoreDescription(
        "travel",
        "Travel",
        "% of range per h",
        "Way of an actuator that follows the manipulated variable only where it differs by more "
        "than 0.1 % of the range.",
    ),
    ScoreDescription(
        "reversals",
        "Reversals",
        "1",
        "How often the manipulated variable turns and comes back by more than 0.1 % of the range.",
    ),
    ScoreDescription(
        "peak_move",
        "Largest move",
        "signal unit",
        "Largest distance of the manipulated variable from where it began.",
    ),
    ScoreDescription(
        "time_in_saturation",
        "Time in saturation",
        "s",
        "How long the manipulated variable stood at a limit, its own or a narrower one of the "
        "controller.",
    ),
)

_PLANT = (
    ScoreDescription(
        "starts_per_hour",
        "Starts",
        "1/h",
        "How often the pump starts to run, per hour of the run.",
    ),
    ScoreDescription(
        "volume_pumped",
        "Volume pumped",
        "m³",
        "What the pump delivers in the run.",
    ),
    ScoreDescription(
        "energy",
        "Energy to the liquid",
        "kWh",
        "What the pump gives to the liquid, flow times head, taken as water of 1000 kg/m³; what it "
        "draws is more by the losses of pump, motor and converter.",
    ),
    ScoreDescription(
        "volume_spilt",
        "Volume spilt",
        "m³",
        "What is lost over the rim of the tank in the run.",
    ),
)

_INNER_LOOPS = (
    ScoreDescription(
        "time_at_setpoint_limit",
        "Time at a setpoint limit",
        "s",
        "How long the setpoint that a cascade gives to an inner loop stood at one of its limits, "
        "where the outer loop moves nothing.",
    ),
)

#: Scores of pumps, tanks and inner loops, where the others are of controlled measurements and
#: manipulated variables.
PLANT_SCORES = tuple(score.key for score in (*_PLANT, *_INNER_LOOPS))

SCORES: dict[str, ScoreDescription] = {
    score.key: score
    for group in (
        _INTEGRALS,
        _SETPOINT_STEPS,
        _ALL_STEPS,
        _AVERAGING,
        _EFFORT,
        _PLANT,
        _INNER_LOOPS,
    )
    for score in group
}
