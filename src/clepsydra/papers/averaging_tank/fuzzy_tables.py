"""Tables 2 to 5, judged by each other, and pictures of their sets and of what the rules make."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clepsydra.controllers.fuzzy.inference import surface
from clepsydra.controllers.fuzzy.membership import Trapezoid
from clepsydra.controllers.fuzzy.rule import Some, atoms
from clepsydra.controllers.fuzzy.system import FuzzySystem
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.row import Rows

#: Names of the sets of the flows, as printed; the file has one name for S and S0.
_TABLE_3 = ("ZO", "S0", "M", "LM", "LL")
_UNITS = {"f_in": "m³/s", "f_out": "m³/s", "C_in": "kmol/m³"}
_POINTS = 401


def tables(system: FuzzySystem, with_printed_top: FuzzySystem) -> Rows:
    """Judge Tables 2 to 5 by each other, and with the top of LL at 8.0, as Table 3 prints it."""
    flow, inlet = system.outputs[0], system.outputs[2]
    named = {a.set for rule in system.rules for a in atoms(rule.condition) if a.variable == "e_V"}
    printed = ("NL", "NS", "ZO", "AP", "LP")
    lower, upper = ({v.name for v in system.used_by(output)} for output in ("f_out", "C_in"))
    moved_by_c = {
        output.name
        for output in system.outputs
        for rule in system.rules_for(output.name)
        if {a.variable for a in atoms(rule.condition)} == {"e_C", "de_C"}
    }
    lower_rules = [r for r in system.rules_for("f_out") if len(list(atoms(r.condition))) == 2]
    unions = sum(_has_union(rule.condition) for rule in system.rules)
    degree = float(with_printed_top.outputs[0].sets["LL"].degrees(flow.high))
    shapes = [
        (variable, name, member)
        for variable in (*system.inputs, flow, inlet)
        for name, member in variable.sets.items()
        if isinstance(member, Trapezoid)
    ]
    (edge,) = (member for _, name, member in shapes if name == "LM")
    shoulders_reach_one = all(
        member.degrees([variable.low, variable.high]).max() == 1.0
        for variable, _, member in shapes
        if len(member.corners) == 2
    )
    yield PRINTED["Table 2", "names of the last two sets of eV"].stated(
        "PS, PL", set(printed) <= named
    )
    yield PRINTED["Table 3", "top of LL"].compared(
        edge.end,
        right_if=[
            ("8.0 lies beyond the range 0 to 1, and LM ends at 0.8", 8.0 > flow.high == 1.0),
            (
                "every other shoulder of Tables 2 and 3 reaches 1 within its range",
                degree < 0.1 and shoulders_reach_one,
            ),
        ],
    )
    yield PRINTED["Table 4", "caption"].stated("regarding V(t)", lower == {"e_C", "de_C"})
    yield PRINTED["Table 5", "caption"].stated("regarding C(t)", upper == {"e_V", "de_V"})
    yield PRINTED["Table 4", "name of the set small"].stated("S0", "S" in _TABLE_3)
    ruled = {v.name for v in (flow, inlet)}
    yield PRINTED["section 3.3", "what Table 3 presents"].stated(
        "FLC's outputs", ruled <= {v.name for v in system.inputs}
    )
    yield PRINTED["section 3.3", "form of Tables 4 and 5"].stated(
        "Tab. 4 is presented in the form f_in/f_out", moved_by_c == {"f_in", "f_out"}
    )
    yield PRINTED["section 3.3", "union"].remark(
        f"{unions} of {len(system.rules)} rules have an OR"
    )
    yield PRINTED["(103a)", "number of the first added rule"].compared(
        float(len(lower_rules) + 9 + 1)
    )
    yield PRINTED["Tables 2 and 3", "shapes"].claimed(
        all(
            _is_symmetrical(member) == (name not in ("M", "LM"))
            for _, name, member in shapes
            if len(member.corners) == 4
        ),
        "all triangles but M and LM are symmetrical",
    )


def _has_union(condition: object) -> bool:
    parts = getattr(condition, "parts", ())
    return isinstance(condition, Some) or any(map(_has_union, parts))


def _is_symmetrical(member: Trapezoid) -> bool:
    return abs((member.top - member.foot) - (member.end - member.end_of_top)) < 1e-9


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
