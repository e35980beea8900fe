"""The designs that a study tries, in the order in which they are named."""

from __future__ import annotations

from collections.abc import Callable

from clepsydra.controllers.controller import Controller
from clepsydra.design.bryson import design_lqi
from clepsydra.design.phase_margin import design_phase_margin
from clepsydra.design.simc import design_simc
from clepsydra.linear.analysis import Analysis
from clepsydra.process.process import Process

#: What the reader calls it, and how it is designed; a design that does not apply says why.
DESIGNS: dict[str, Callable[[Process, Analysis], Controller]] = {
    "PI, SIMC": lambda process, analysis: design_simc(process, analysis.model, analysis.pairing),
    "PI, phase margin": lambda process, analysis: design_phase_margin(
        process, analysis.model, analysis.pairing
    ),
    "LQI, Bryson": lambda process, analysis: design_lqi(process, analysis.model),
}
