"""The document and its experiments, in the order of its text."""

from __future__ import annotations

from clepsydra.papers.eight_tanks import (
    chain_of_tanks,
    control_courses,
    cross_references,
    identification,
    polynomials,
    predictor_structure,
    robustness,
    second_order_model,
)
from clepsydra.papers.experiment import Document, Experiment

DOCUMENT = Document(
    "eight-tanks",
    "Polynomial digital control of a series equal liquid tanks",
    "V. Bobál, S. Talaš, P. Dostál and M. Kubalčík, Tomas Bata University in Zlín",
    (
        Experiment("chain", "Equations and numbers of the chain", chain_of_tanks.run),
        Experiment("identification", "Least squares and the delay", identification.run),
        Experiment("second-order-model", "The model of second order", second_order_model.run),
        Experiment("polynomials", "Diophantine equations and poles", polynomials.run),
        Experiment("predictor", "Structure of the predictor", predictor_structure.run),
        Experiment("control-courses", "The six experiments", control_courses.run),
        Experiment("robustness", "Robustness beside a plain PID", robustness.run),
        Experiment("cross-references", "References of the text", cross_references.run),
    ),
)
