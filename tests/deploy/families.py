"""One designed controller of each family of laws, as the program that is printed."""

from functools import cache

from plants import plant

from clepsydra.deploy.exportable import exportable
from clepsydra.program.program import Program
from clepsydra.studies.designs import DESIGNS

PROCESSES = {
    "PI, SIMC": "quadruple-tank",
    "PID, phase margin": "quadruple-tank",
    "PI, variable structure": "quadruple-tank",
    "PI, gain scheduling": "three-tanks",
    "LQI with Kalman filter": "quadruple-tank",
    "LQI, gain scheduling": "quadruple-tank",
    "2DOF polynomial, LQ": "quadruple-tank",
    "Smith predictor, PI": "eight-tanks",
    "Feedback linearisation": "quadruple-tank",
    "One-step inverse": "averaging-tank",
    "Glover-McFarlane on PI, SIMC": "quadruple-tank",
    "Fuzzy PI": "quadruple-tank",
    "Start/stop levels": "wet-well:start-stop",
}
#: With those that are refused in single precision, whose numbers end at 3.4E38.
IN_DOUBLE = {**PROCESSES, "MPC": "quadruple-tank"}


@cache
def family(name: str):
    """Return the bare program, and the controller in its plant shell with its origin."""
    analysis = plant(IN_DOUBLE[name]).analysis
    controller = DESIGNS[name](analysis)
    return controller.program(), exportable(controller, analysis.operating_point)


def bare(name: str) -> Program:
    return family(name)[0]
