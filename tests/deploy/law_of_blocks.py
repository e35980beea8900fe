"""A law of blocks in small: two instances of one with a state, inside a third, with cold starts."""

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, step_law

#: A filter that counts its scans up to 9 and says whether it is high and how often it was.
FILTER = Block(
    "filter",
    (Signal("x"), Signal("share"), Signal("most", low=0, high=99, kind="integer")),
    (
        Signal("kept"),
        Signal("scans", low=0, high=9, kind="integer"),
        Signal("was_high", kind="boolean"),
    ),
    (
        Signal("y"),
        Signal("high", kind="boolean"),
        Signal("count", low=0, high=9, kind="integer"),
    ),
    lambda s: Equations(
        {
            "kept": s["kept"] + s["share"] * (s["x"] - s["kept"]),
            "scans": ca.fmin(8, ca.fmax(0, s["scans"])) + 1,
            "was_high": s["kept"] > 1,
        },
        {
            "y": ca.if_else(s["scans"] < s["most"], 2 * s["kept"], -s["kept"]) + s["scans"],
            "high": ca.logic_or(s["kept"] > 1, s["was_high"]),
            "count": ca.fmin(9, ca.fmax(0, s["scans"])),
        },
    ),
    ("Smooths its input.",),
)
_STATE = [
    (f"{name}_{place}", entry.kind, 0.5 if name == "kept" else 0.0)
    for place in ("inner", "outer")
    for name, entry in ((each.name, each) for each in FILTER.state)
]
STATE = tuple(Signal(name, initial=initial, kind=kind) for name, kind, initial in _STATE)


def _two(s):
    def called(place, x, share):
        names = [entry.name for entry in FILTER.state]
        state = {name: s[f"{name}_{place}"] for name in names}
        given = {"x": x, "share": share, "most": s["most"]}
        found = FILTER(f"{place}_filter", given, state)
        return found.outputs, {f"{k}_{place}": v for k, v in found.next_state.items()}

    first, following = called("inner", s["x"], 0.5)
    choice = ca.if_else(first["high"], first["y"], s["x"])
    second, more = called("outer", choice * first["count"], s["share"])
    return Equations(following | more, {"y": second["y"], "high": second["high"]})


PAIR = Block(
    "filter_pair",
    (Signal("x"), Signal("share"), Signal("most", low=0, high=99, kind="integer")),
    STATE,
    (Signal("y"), Signal("high", kind="boolean")),
    _two,
    ("Two filters in a row.",),
)


def law_of_blocks(other=None, *, shown=False):
    """The pair with a cold start; with `other` also another block; `shown`: a state read beside."""

    def equations(s):
        initial = {signal.name: signal.initial for signal in STATE}
        state = {name: ca.if_else(s["cold"], first, s[name]) for name, first in initial.items()}
        given = {"x": s["u"], "share": s["share"], "most": s["most"]}
        pair = PAIR("pair", given, state)
        y = pair.outputs["y"] + (s["kept_inner"] if shown else 0.0)
        if other is not None:
            y += other("beside", {"x": y, "most": s["most"]}, {}).outputs["y"]
        return Equations(pair.next_state, {"y": y, "high": pair.outputs["high"]})

    return step_law(
        "two_filters",
        inputs=[
            Signal("u"),
            Signal("cold", kind="boolean"),
            Signal("most", initial=4, low=0, high=99, kind="integer"),
        ],
        parameters=[Signal("share", initial=0.25)],
        state=STATE,
        outputs=[Signal("y"), Signal("high", kind="boolean")],
        equations=equations,
    )
