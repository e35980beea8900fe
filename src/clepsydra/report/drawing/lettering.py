"""How wide words are at most, so that they get their room before anything is drawn."""

from __future__ import annotations

#: Letters by their width in DejaVu Sans, the widest of the fonts that a viewer may take [em].
_WIDTHS = {
    0.42: " !'\"()*,-./:;I[\\]fijlrt|°²³·",
    0.65: "?_`abcdeghknopqsuvxyz$0123456789{}µτFJLP",
    0.8: "ABCDEGHKNOQRSTUVXYZ&",
}
_WIDTH = {letter: width for width, letters in _WIDTHS.items() for letter in letters}
_WIDEST, _BOLD = 1.0, 1.13


def width(words: str, size: float, bold: bool = False) -> float:
    """Return how wide words are at most, in the unit of the size of their letters.

    Examples
    --------
    >>> round(width("pump_1", 10.0), 1), round(width("pump_1", 10.0, bold=True), 1)
    (42.5, 48.0)
    """
    return size * (_BOLD if bold else 1.0) * sum(_WIDTH.get(letter, _WIDEST) for letter in words)


def shortened(words: str, room: float, size: float, bold: bool = False) -> str:
    """Return words with their middle left out where they are wider than their room.

    Examples
    --------
    >>> shortened("a_rather_long_tank_name", 100.0, 10.0)
    'a_rathe…nk_name'
    """
    shown, kept = words, len(words)
    while width(shown, size, bold) > room and kept > 2:
        kept -= 1
        shown = f"{words[: (kept + 1) // 2]}…{words[len(words) - kept // 2 :]}"
    return shown


def wrapped(name: str, room: float, size: float, bold: bool = False) -> list[str]:
    """Return a name in one line, or in two, parted where its words are.

    Examples
    --------
    >>> wrapped("level_1", 80.0, 10.0), wrapped("outlet_temperature", 80.0, 10.0)
    (['level_1'], ['outlet_', 'temperature'])
    """
    fitting = [k for k in range(1, len(name) + 1) if width(name[:k], size, bold) <= room]
    place = name.rfind("_", 0, len(fitting)) + 1
    if len(fitting) == len(name) or not place:
        return [shortened(name, room, size, bold)]
    return [name[:place], shortened(name[place:], room, size, bold)]
