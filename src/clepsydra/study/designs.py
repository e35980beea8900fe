"""The designs that a study tries, in the order in which they are named."""

from __future__ import annotations

from collections.abc import Callable

from clepsydra.controllers.controller import Controller
from clepsydra.design.bryson import design_lqi
from clepsydra.design.phase_margin import design_phase_margin
from clepsydra.design.simc import design_simc
from clepsydra.linear.analysis import Analysis

#: What the reader calls it, and how it is designed; a design that does not apply says why.
DESIGNS: dict[str, Callable[[Analysis], Controller]] = {
    "PI, SIMC": lambda analysis: design_simc(analysis.model, analysis.pairing),
    "PI, phase margin": lambda analysis: design_phase_margin(analysis.model, analysis.pairing),
    "LQI, Bryson": lambda analysis: design_lqi(analysis.model),
}
