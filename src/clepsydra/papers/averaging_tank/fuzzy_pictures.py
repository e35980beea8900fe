"""Pictures of the fuzzy controller: the sets of Tables 2 and 3, and what the rules make of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clepsydra.controllers.fuzzy.inference import surface
from clepsydra.controllers.fuzzy.system import FuzzySystem
from clepsydra.papers.figure import Figure, Panel, curves

_UNITS = {"f_in": "m³/s", "f_out": "m³/s", "C_in": "kmol/m³"}
_POINTS = 401


def sets_and_surfaces(system: FuzzySystem) -> tuple[Figure, Figure]:
    """Return the membership functions, and sections of the control surface."""
    panels = []
    for variable in (*system.inputs, *system.outputs):
        if variable.name == "f_out":
            continue
        unit = _UNITS.get(variable.name)
        even = np.linspace(variable.low, variable.high, _POINTS)
        places = np.unique(np.concatenate([even, variable.samples]))
        degrees = {name: member.degrees(places) for name, member in variable.sets.items()}
        title = "f_in and f_out" if variable.name == "f_in" else variable.name
        label = f"{title} [{unit}]" if unit else f"{title}, scaled"
        panels.append(Panel(title, "degree", curves(places, degrees), label))
    return (
        Figure("", "Sets of Tables 2 and 3", tuple(panels)),
        Figure(
            "", "What the 27 rules make of the errors", tuple(_sections(system)),
            "Sections of the control surface; the other inputs are zero.",
        ),
    )  # fmt: skip


def _sections(system: FuzzySystem) -> Iterator[Panel]:
    function = surface(system)
    names, outputs = ([v.name for v in each] for each in (system.inputs, system.outputs))
    x = np.linspace(-1.0, 1.0, 2 * _POINTS)
    for output, along, across in (
        ("C_in", "e_C", "de_C"), ("f_in", "e_V", "de_V"), ("f_out", "e_V", "de_V"),
    ):  # fmt: skip
        found = {}
        for level in (-1.0, 0.0, 1.0):
            given = np.zeros((len(names), len(x)))
            given[names.index(along)], given[names.index(across)] = x, level
            found[f"{across} = {level:g}"] = np.array(function(given)[0])[outputs.index(output)]
        label = f"{output} [{_UNITS[output]}]"
        yield Panel(output, label, curves(x, found), f"{along}, scaled")
