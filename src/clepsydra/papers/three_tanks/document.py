"""The document and its experiments, in the order of its text."""

from __future__ import annotations

from clepsydra.papers.experiment import Document, Experiment
from clepsydra.papers.three_tanks import (
    conclusion,
    linear_model,
    linear_quadratic,
    pid_design,
    servo_and_load,
    state_feedback,
)

DOCUMENT = Document(
    "three-tanks",
    "Design of optimal controllers for a three tank process",
    "S. Nagammai and S. Latha, Journal of Scientific and Innovative Research 5(2), 2016, 65-70",
    (
        Experiment("linear-model", "The levels at rest and the linear model", linear_model.run),
        Experiment("pid-design", "PID control by Ziegler and Nichols", pid_design.run),
        Experiment("state-feedback", "State feedback with a precompensator", state_feedback.run),
        Experiment("linear-quadratic", "Linear-quadratic control", linear_quadratic.run),
        Experiment("conclusion", "The conclusion, on the linear model", conclusion.run),
        Experiment("servo-and-load", "Setpoint and load, with a real pump", servo_and_load.run),
    ),
)
