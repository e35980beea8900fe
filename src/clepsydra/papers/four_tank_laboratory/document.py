"""The document and its experiments, in the order of its text."""

from __future__ import annotations

from clepsydra.papers.experiment import Document, Experiment
from clepsydra.papers.four_tank_laboratory import (
    decentralised_control,
    identification,
    manual_control,
    margins,
    modelling,
    robust_control,
)

DOCUMENT = Document(
    "four-tank-laboratory",
    "The four-tank process",
    "J. Feng, Y. F. Yu and Z. Wang, project report of the course EL2520 Control Theory and "
    "Practice, KTH, 2021",
    (
        Experiment("modelling", "Linear model, zeros and relative gains", modelling.run),
        Experiment("identification", "Gains of the pumps and holes", identification.run),
        Experiment("manual-control", "Levels at constant voltages", manual_control.run),
        Experiment("decentralised-control", "Decentralised PI control", decentralised_control.run),
        Experiment("robust-control", "Glover-McFarlane control", robust_control.run),
        Experiment("margins", "Margins as designed and in the simulator", margins.run),
    ),
)
