"""The document and its experiments, in the order of its text."""

from __future__ import annotations

from clepsydra.papers.averaging_tank import (
    closed_loops,
    fuzzy,
    lqi,
    model,
    operating_range,
    pi,
    pid_types,
)
from clepsydra.papers.experiment import Document, Experiment

DOCUMENT = Document(
    "averaging-tank",
    "Design of three control algorithms for an averaging tank with variable filling",
    "M. Kolankowski and R. Piotrowski, 2022",
    (
        Experiment("model", "The balances and the linear model", model.run),
        Experiment(
            "closed-loops", "Pairing, decoupler and closed loops in symbols", closed_loops.run
        ),
        Experiment("pi", "Multivariable PI control and its tuning", pi.run),
        Experiment("pid-types", "P, PI and PID, each tuned over each index", pid_types.run),
        Experiment("lqi", "State and output feedback with integral action", lqi.run),
        Experiment("fuzzy", "Mamdani fuzzy control", fuzzy.run),
        Experiment(
            "operating-range",
            "Large steps: wind-up or nonlinearity, and what helps",
            operating_range.run,
        ),
    ),
)
