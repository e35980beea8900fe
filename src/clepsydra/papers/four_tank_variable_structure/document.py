"""The document on four tanks with input constraint, and its experiments."""

from __future__ import annotations

from clepsydra.papers.experiment import Document, Experiment
from clepsydra.papers.four_tank_variable_structure.alpha import alpha
from clepsydra.papers.four_tank_variable_structure.filling import filling
from clepsydra.papers.four_tank_variable_structure.internal import internal
from clepsydra.papers.four_tank_variable_structure.linearisation import linearisation
from clepsydra.papers.four_tank_variable_structure.pump_limits import pump_limits
from clepsydra.papers.four_tank_variable_structure.robustness import robustness

DOCUMENT = Document(
    key="four-tank-variable-structure",
    title="Variable structure PID control of four-tank system with input constraint",
    reference="Wang Chen and Han Guangxin, New Materials and Intelligent Manufacturing, 2018, "
    "363-366, doi 10.26480/icnmim.01.2018.363.366",
    experiments=(
        Experiment("linearisation", "Feedback linearisation, in symbols", linearisation),
        Experiment("filling", "Filling the tanks, conventional and variable structure", filling),
        Experiment("pump-limits", "Pump limits from 4 to 20 V", pump_limits),
        Experiment("alpha", "The choice of α", alpha),
        Experiment("robustness", "Pumps and outlets other than assumed", robustness),
        Experiment("internal", "The non-minimum-phase trap", internal),
    ),
)
