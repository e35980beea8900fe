"""The designs that a study file can name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

from clepsydra.controllers.controller import Controller


class NamedDesign(NamedTuple):
    """Where a design is, and what it is in a few words.

    Its arguments are read from its signature: each keyword is a key of the study file.

    Parameters
    ----------
    module, function : str
        It takes a model first, and a pairing second if it has one.
    words : str

    Examples
    --------
    >>> DESIGN_NAMES["simc"].load().__name__
    'design_simc'
    """

    module: str
    function: str
    words: str

    def load(self) -> Callable[..., Controller]:
        """Return the function."""
        found: Callable[..., Controller] = getattr(import_module(self.module), self.function)
        return found


def _design(module: str, name: str, words: str) -> NamedDesign:
    return NamedDesign(f"clepsydra.designs.{module}", f"design_{name}", words)


#: What a study file calls a design.
DESIGN_NAMES: dict[str, NamedDesign] = {
    "simc": _design("simc", "simc", "PI or PID by SIMC"),
    "lambda": _design("lambda_tuning", "lambda", "PI by lambda tuning"),
    "arrest_time": _design("arrest_time", "arrest_time", "PI that averages, by its arrest time"),
    "phase_margin": _design("phase_margin", "phase_margin", "PI or PID by phase margin"),
    "ziegler_nichols": _design(
        "ziegler_nichols", "ziegler_nichols", "PI or PID by Ziegler and Nichols"
    ),
    "tyreus_luyben": _design("tyreus_luyben", "tyreus_luyben", "PI or PID by Tyreus and Luyben"),
    "amigo": _design("amigo", "amigo", "PI or PID by AMIGO"),
    "lqi": _design("bryson", "lqi", "LQI from measured states, by Bryson's rule"),
    "lqi_by_weights": _design("lqi_by_weights", "lqi_by_weights", "LQI by given weights"),
    "lqi_kalman": _design("lqi_kalman", "lqi_kalman", "LQI with a Kalman filter"),
    "lqi_extended_kalman": _design(
        "extended_kalman", "lqi_extended_kalman", "LQI with an extended Kalman filter"
    ),
    "gain_scheduled_lqi": _design(
        "gain_scheduling", "gain_scheduled_lqi", "LQI whose gains follow the operating point"
    ),
    "gain_scheduled_pid": _design(
        "gain_scheduling", "gain_scheduled_pid", "PI or PID whose gains follow the operating point"
    ),
    "recomputed_lqi": _design("recomputed_lqi", "recomputed_lqi", "LQI recomputed in each sample"),
    "lqr": _design("linear_quadratic_regulator", "lqr", "LQR with a precompensator"),
    "start_stop_levels": _design(
        "start_stop_levels", "start_stop_levels", "pumps by start and stop levels"
    ),
    "pole_placement": _design(
        "pole_placement", "pole_placement", "state feedback by pole placement"
    ),
    "glover_mcfarlane": _design(
        "glover_mcfarlane", "glover_mcfarlane", "robust control by Glover and McFarlane"
    ),
    "polynomial": NamedDesign(
        "clepsydra.designs.polynomial.polynomial_control",
        "design_polynomial",
        "polynomial control with two degrees of freedom",
    ),
    "smith_predictor": _design("smith_predictor", "smith_predictor", "Smith predictor"),
    "feedback_linearisation": _design(
        "feedback_linearisation", "feedback_linearisation", "feedback linearisation"
    ),
    "variable_structure_pid": _design(
        "variable_structure_pid", "variable_structure_pid", "PI or PID with variable structure"
    ),
    "fuzzy_pi": _design("fuzzy_control", "fuzzy_pi", "fuzzy PI by the standard table"),
}
