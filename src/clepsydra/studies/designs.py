"""The designs that a study tries, in the order in which they are named."""

from __future__ import annotations

from collections.abc import Callable

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.amigo import design_amigo
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arrest_time import design_arrest_time
from clepsydra.designs.bryson import design_lqi
from clepsydra.designs.extended_kalman import design_lqi_extended_kalman
from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.fuzzy_control import design_fuzzy_pi
from clepsydra.designs.gain_scheduling import (
    design_gain_scheduled_lqi,
    design_gain_scheduled_pid,
)
from clepsydra.designs.glover_mcfarlane import design_glover_mcfarlane
from clepsydra.designs.lambda_tuning import design_lambda
from clepsydra.designs.linear_quadratic_regulator import design_lqr
from clepsydra.designs.lqi_kalman import design_lqi_kalman
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.pole_placement import design_pole_placement
from clepsydra.designs.polynomial.polynomial_control import design_polynomial
from clepsydra.designs.recomputed_lqi import design_recomputed_lqi
from clepsydra.designs.simc import design_simc
from clepsydra.designs.smith_predictor import design_smith_predictor
from clepsydra.designs.start_stop_levels import design_start_stop_levels
from clepsydra.designs.tyreus_luyben import design_tyreus_luyben
from clepsydra.designs.variable_structure_pid import design_variable_structure_pid
from clepsydra.designs.ziegler_nichols import design_ziegler_nichols
from clepsydra.linear.analysis import Analysis

Design = Callable[[Analysis], Controller]

_PID = PidForm("PID")


def _differentiated(controller: Controller, analysis: Analysis) -> Controller:
    """Refuse PID control whose derivative times are below the sampling period.

    It would differentiate the noise of single samples. Who asks for it in a study file gets it,
    with a warning.
    """
    period = analysis.operating_point.process.sampling_period
    law, values = controller.law, controller.values
    times = [values[p.name] for p in law.parameters if p.part == "derivative_time"]
    if max(times) < period:
        raise NotApplicable(
            controller.name,
            f"its longest derivative time of {max(times):.3g} s is shorter than the sampling "
            f"period of {period:g} s; sample faster, or use PI control",
        )
    return controller


#: What the reader calls it, and how it is designed; a design that does not apply says why.
DESIGNS: dict[str, Design] = {
    "PI, arrest time": lambda a: design_arrest_time(a.model, a.pairing),
    "PI, SIMC": lambda a: design_simc(a.model, a.pairing),
    "PI, lambda": lambda a: design_lambda(a.model, a.pairing),
    "PI, phase margin": lambda a: design_phase_margin(a.model, a.pairing),
    "PI, AMIGO": lambda a: design_amigo(a.model, a.pairing),
    "PI, Ziegler-Nichols": lambda a: design_ziegler_nichols(a.model, a.pairing),
    "PI, Tyreus-Luyben": lambda a: design_tyreus_luyben(a.model, a.pairing),
    "PI, SIMC, static decoupling": lambda a: design_simc(a.model, a.pairing, decoupling="static"),
    "PI, SIMC, dynamic decoupling": lambda a: design_simc(a.model, a.pairing, decoupling="dynamic"),
    "PI, variable structure": lambda a: design_variable_structure_pid(a.model, a.pairing),
    "PI, gain scheduling": lambda a: design_gain_scheduled_pid(a.model, a.pairing),
    "PID, SIMC": lambda a: _differentiated(design_simc(a.model, a.pairing, form=_PID), a),
    "PID, phase margin": lambda a: _differentiated(
        design_phase_margin(a.model, a.pairing, form=_PID), a
    ),
    "PID, AMIGO": lambda a: _differentiated(design_amigo(a.model, a.pairing, form=_PID), a),
    "PID, Ziegler-Nichols": lambda a: _differentiated(
        design_ziegler_nichols(a.model, a.pairing, form=_PID), a
    ),
    "LQI, Bryson": lambda a: design_lqi(a.model),
    "LQI with Kalman filter": lambda a: design_lqi_kalman(a.model),
    "LQI with extended Kalman filter": lambda a: design_lqi_extended_kalman(a.model),
    "LQI, gain scheduling": lambda a: design_gain_scheduled_lqi(a.model),
    "LQI, recomputed": lambda a: design_recomputed_lqi(a.model),
    "LQR with precompensator": lambda a: design_lqr(a.model),
    "2DOF polynomial, LQ": lambda a: design_polynomial(a.model, a.pairing),
    "Smith predictor, LQ": lambda a: design_smith_predictor(a.model, a.pairing),
    "Smith predictor, PI": lambda a: design_smith_predictor(a.model, a.pairing, primary="PI"),
    "Feedback linearisation": lambda a: design_feedback_linearisation(a.model),
    "Glover-McFarlane on PI, SIMC": lambda a: design_glover_mcfarlane(a.model, a.pairing),
    "Fuzzy PI": lambda a: design_fuzzy_pi(a.model, a.pairing),
    "Start/stop levels": lambda a: design_start_stop_levels(a.model),
    "State feedback, pole placement": lambda a: design_pole_placement(a.model),
}
