"""Every design as a function of a plant: `cl.design.simc(plant)`.

`dir(cl.design)` lists them, `help(cl.design.simc)` says all about one.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import UnknownName
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.wired import WiredFuzzy
from clepsydra.designs.amigo import design_amigo
from clepsydra.designs.arrest_time import design_arrest_time
from clepsydra.designs.bryson import design_lqi
from clepsydra.designs.extended_kalman import design_lqi_extended_kalman
from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.fuzzy_control import design_fuzzy_pi
from clepsydra.designs.gain_scheduling import design_gain_scheduled_lqi, design_gain_scheduled_pid
from clepsydra.designs.glover_mcfarlane import design_glover_mcfarlane
from clepsydra.designs.lambda_tuning import design_lambda
from clepsydra.designs.linear_quadratic_regulator import design_lqr
from clepsydra.designs.lqi_by_weights import design_lqi_by_weights
from clepsydra.designs.lqi_kalman import design_lqi_kalman
from clepsydra.designs.own_law import own_controller
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
from clepsydra.interface.controller import Controller, of_plant
from clepsydra.interface.lift import of_model
from clepsydra.interface.plant import Plant

amigo = of_model(design_amigo)
arrest_time = of_model(design_arrest_time)
feedback_linearisation = of_model(design_feedback_linearisation)
fuzzy_pi = of_model(design_fuzzy_pi)
gain_scheduled_lqi = of_model(design_gain_scheduled_lqi)
gain_scheduled_pid = of_model(design_gain_scheduled_pid)
glover_mcfarlane = of_model(design_glover_mcfarlane)
lambda_ = of_model(design_lambda)
lqi = of_model(design_lqi)
lqi_by_weights = of_model(design_lqi_by_weights)
lqi_extended_kalman = of_model(design_lqi_extended_kalman)
lqi_kalman = of_model(design_lqi_kalman)
lqr = of_model(design_lqr)
own = of_model(own_controller)
phase_margin = of_model(design_phase_margin)
pole_placement = of_model(design_pole_placement)
polynomial = of_model(design_polynomial)
recomputed_lqi = of_model(design_recomputed_lqi)
simc = of_model(design_simc)
smith_predictor = of_model(design_smith_predictor)
start_stop_levels = of_model(design_start_stop_levels)
tyreus_luyben = of_model(design_tyreus_luyben)
variable_structure_pid = of_model(design_variable_structure_pid)
ziegler_nichols = of_model(design_ziegler_nichols)


def fuzzy(plant: Plant, path: str | Path, *, name: str = "Fuzzy") -> Controller:
    """Return the controller of a fuzzy file, which docs/fuzzy-files.md describes.

    Parameters
    ----------
    plant : Plant
    path : str or Path
    name : str
        What the reader sees.

    Raises
    ------
    InputError
        The file cannot be used; the message names the line.
    """
    law = WiredFuzzy(load_fuzzy(path), plant.process)
    return of_plant(law.controller(plant.point, name), plant)


__all__ = [
    "amigo",
    "arrest_time",
    "feedback_linearisation",
    "fuzzy",
    "fuzzy_pi",
    "gain_scheduled_lqi",
    "gain_scheduled_pid",
    "glover_mcfarlane",
    "lambda_",
    "lqi",
    "lqi_by_weights",
    "lqi_extended_kalman",
    "lqi_kalman",
    "lqr",
    "own",
    "phase_margin",
    "pole_placement",
    "polynomial",
    "recomputed_lqi",
    "simc",
    "smith_predictor",
    "start_stop_levels",
    "tyreus_luyben",
    "variable_structure_pid",
    "ziegler_nichols",
]


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:  # where a type checker would take any name for known

    def __getattr__(name: str) -> object:
        # What Python itself looks for, __path__ and the like, is no misspelt design.
        if name.startswith("__"):
            raise AttributeError(name)
        raise UnknownName("cl.design", name, __all__)
