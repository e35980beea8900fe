"""What a drawing has for a page that moves it: marks that it turns, shows and hides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from clepsydra.report.drawing.outline import TANK_HEIGHT, TANK_WIDTH
from clepsydra.report.drawing.shapes import ALARM, INK, PIPE, element, path, text, titled

#: What only the page knows: its places are empty at first.
UNKNOWN = ("flow", "state")
#: Half the size of an arrow in the middle of a pipe, and the least room that it needs [px].
_HALF, _ROOM = 5.0, 15.0
#: Width and height of the mark of an alarm [px].
_ALARM = 34.0, 16.0
#: Where liquid that hands pour may come down, from the middle of a tank, best first [px].
_STREAMS = (0.0, 32.0, -32.0, 16.0, -16.0, 48.0, -48.0)

Points = Sequence[tuple[float, float]]


def marked(what: str, name: str) -> dict[str, str]:
    """Return the attribute by which a page finds a line of words; none where it never changes.

    Examples
    --------
    >>> marked("value", "pump_1"), marked("", "pump_1")
    ({'data_value': 'pump_1'}, {})
    """
    return {f"data_{what}": name} if what else {}


def state_mark(name: str, scale: tuple[float, float] | None) -> dict[str, str]:
    """Return the attributes of a line that tells a percent, or what is abnormal.

    Parameters
    ----------
    name : str
        Of the signal.
    scale : (float, float) or None
        What 0 and 100 % of it are; without them it tells only what is abnormal.

    Examples
    --------
    >>> state_mark("pump_1", (0.0, 10.0))
    {'data_state': 'pump_1', 'data_zero': '0.0', 'data_hundred': '10.0'}
    """
    ends = {} if scale is None else {"data_zero": repr(scale[0]), "data_hundred": repr(scale[1])}
    return marked("state", name) | ends


def direction_mark(points: Points, colour: str) -> str:
    """Return an arrow on the longest piece of a pipe, which the page turns where liquid turns.

    Examples
    --------
    >>> direction_mark([(0.0, 0.0), (0.0, 40.0)], "red")[:60]
    '<g class="way" transform="translate(0 20) rotate(180)"><path'
    >>> direction_mark([(0.0, 0.0), (0.0, 9.0)], "red")
    ''
    """
    (x1, y1), (x2, y2) = max(pairwise(points), key=lambda piece: math.dist(*piece))
    if math.dist((x1, y1), (x2, y2)) < _ROOM:
        return ""
    angle = math.degrees(math.atan2(x2 - x1, y1 - y2))
    place = f"translate({(x1 + x2) / 2:g} {(y1 + y2) / 2:g}) rotate({angle:g})"
    tip = element("path", d=f"M{-_HALF:g} 4L0 -5L{_HALF:g} 4Z", fill=colour, class_="arrow")
    return element("g", tip, class_="way", transform=place)


def vessel_marks(name: str, x: float, y: float, entries: Sequence[float], side: int) -> list[str]:
    """Return what hands pour into a tank, its extra outlet, and what it spills; hidden at first.

    Parameters
    ----------
    name : str
    x, y : float
        Middle and rim of the tank [px].
    entries : sequence of float
        Where pipes come in over the rim [px].
    side : {-1, 1}
        The wall at which there are no instruments.
    """
    shift = max(_STREAMS, key=lambda each: min([abs(x + each - at) for at in entries] or [0.0]))
    down = x + shift
    stream = path(f"M{down:g} {y - 34:g}V{y + 8:g}", 5.0, stroke=PIPE)
    tip = element("path", d=f"M{down - 8:g} {y + 2:g}h16l-8 14Z", fill=PIPE)
    pour = titled(f"poured into {name}", stream, tip, kind="mark", data_pour=name)
    wall, floor = x + side * TANK_WIDTH / 2, y + TANK_HEIGHT
    nozzle = path(f"M{wall:g} {floor - 9:g}h{12 * side}v20", 5.0, stroke=PIPE)
    drop = element("path", d=f"M{wall + 12 * side - 8:g} {floor + 6:g}h16l-8 14Z", fill=PIPE)
    extra = titled(f"extra outlet of {name}", nozzle, drop, kind="mark", data_extra=name)
    rims = "".join(
        f"M{x + way * (TANK_WIDTH / 2 - 9):g} {y + 1:g}h{9 * way}q{9 * way} 1 {9 * way} 12v16"
        for way in (-1, 1)
    )
    spills = titled(f"{name} spills", path(rims, 3.0, stroke=ALARM), kind="mark", data_spills=name)
    return [pour, extra, spills]


def aim_mark(measurement: str, x: float, y: float, side: int, ends: tuple[float, float]) -> str:
    """Return a pointer at the wall of a tank, which the page moves to where a setpoint is.

    Parameters
    ----------
    measurement : str
    x, y : float
        The wall, and the rim of the tank [px].
    side : {-1, 1}
        Which wall it is.
    ends : (float, float)
        What the measurement reads of an empty tank and of a full one.
    """
    empty, full = ends
    pointer = path(f"M{2 * side:g} 0l{10 * side:g} -5v10Z", 1.0, INK, "none")
    return titled(
        f"setpoint of {measurement}", element("g", pointer, data_aim=measurement,
        data_empty=repr(empty), data_full=repr(full), data_height=TANK_HEIGHT),
        moved=f"translate({x:g} {y:g})",
    )  # fmt: skip


def alarm_mark(measurement: str, x: float, y: float, radius: float) -> str:
    """Return the mark of an alarm at a transmitter, whose letters the page writes; hidden at first.

    Parameters
    ----------
    measurement : str
    x, y, radius : float
        Of the transmitter [px].
    """
    width, height = _ALARM
    x, y = x + radius + 0.3 * width, y - radius
    frame = element(
        "rect", x=f"{x - width / 2:g}", y=f"{y - height / 2:g}", width=f"{width:g}",
        height=f"{height:g}", rx="3",
    )  # fmt: skip
    letters = text(x, y + 4, "", style="tag")
    return titled("", frame, letters, kind="mark", data_alarms=measurement)


def plug_mark(name: str) -> str:
    """Return a cross over what is plugged, around 0; hidden at first."""
    return element("g", path("M-8 -8L8 8M-8 8L8 -8", 2.6, stroke=ALARM), class_="mark",
                   data_plug=name)  # fmt: skip
