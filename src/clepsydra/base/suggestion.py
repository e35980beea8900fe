"""A hint at the name that was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping

#: The symbols that books and panels have for a name, that of tables first.
SYMBOLS = {
    "gain": ("K", "Kp", "Kc"),
    "integral_gain": ("Ki",),
    "derivative_gain": ("Kd",),
    "integral_time": ("Ti", "Tn", "tau_i"),
    "derivative_time": ("Td", "Tv", "tau_d"),
    "filter_time": ("Tf", "tau_f"),
    "derivative_filter": ("N",),
    "setpoint_weight": ("b", "beta"),
    "closed_loop_time_constant": ("tau_c", "lambda", "lambda_", "lam", "Tc", "Tcl"),
    "maximum_sensitivity": ("max|S|", "Ms"),
    "damping": ("zeta",),
    "maximum_errors": ("Q",),
    "maximum_moves": ("R",),
    "weights": ("Q", "R"),
}
#: What ISA-18.2 and alarm lists call the keys of alarms.
_ALARMS = {
    "high_high": ("HH", "HiHi"),
    "high": ("H", "Hi"),
    "low": ("L", "Lo"),
    "low_low": ("LL", "LoLo"),
    "deviation": ("DEV",),
    "rate": ("ROC", "rate_of_change"),
}
#: What the command line calls a call in Python, where that is not the same.
_VERBS = {
    "audit": ("papers",),
    "catalogue": ("processes",),
    "design": ("designs",),
    "new_process": ("new",),
}


def symbol_of(name: str) -> str:
    """Return what tables call a name.

    Examples
    --------
    >>> symbol_of("integral_time"), symbol_of("tracking_time")
    ('Ti', 'tracking_time')
    """
    return SYMBOLS.get(name, (name,))[0]


def suggestion(wrong: object, known: Iterable[str], otherwise: str) -> str:
    """Return "perhaps … was meant" where a known name is close, else what to do instead.

    Close is what is spelt alike, or what a symbol stands for.

    It is the remedy of an `InputError` about a name.

    Parameters
    ----------
    wrong : object
        What was given as a name.
    known : iterable of str
        The names that there are.
    otherwise : str
        What to do where none of them is close.

    Examples
    --------
    >>> suggestion("tnak_1", ["tank_1", "basin"], "choose one")
    "perhaps 'tank_1' was meant"
    >>> suggestion("pi, simc", ["PI, arrest time", "PI, SIMC"], "choose one")
    "perhaps 'PI, SIMC' was meant"
    >>> suggestion("tau_c", ["pairing", "closed_loop_time_constant"], "choose one")
    "perhaps 'closed_loop_time_constant' was meant"
    >>> suggestion("HH", ["high_high", "high", "low", "low_low"], "choose one")
    "perhaps 'high_high' was meant"
    >>> suggestion("pump", ["tank_1", "basin"], "choose one")
    'choose one'
    """
    close = nearest(wrong, known)
    return f"perhaps '{close}' was meant" if close else otherwise


def nearest(wrong: object, known: Iterable[str]) -> str:
    """Return the known name that is close, as for `suggestion`; empty where none is.

    Examples
    --------
    >>> nearest("smic", ["lqi", "simc"]), nearest("pid", ["lqi", "simc"])
    ('simc', '')
    """
    spelt, given = {name.lower(): name for name in known}, str(wrong)[:80].lower()
    close = [*_synonyms(given, spelt), *difflib.get_close_matches(given, spelt, n=1)]
    return spelt[close[0]] if close else ""


def nearest_few(wrong: object, known: Iterable[str], most: int = 3) -> list[str]:
    """Return the one known name that is all but the same, or a few that hold it or are not far.

    Examples
    --------
    >>> nearest_few("feedback", ["PI, SIMC", "Feedback linearisation", "State feedback"])
    ['State feedback', 'Feedback linearisation']
    >>> nearest_few("PI SIMC", ["PI, SIMC", "PID, SIMC", "PI, SIMC, tuned"])
    ['PI, SIMC']
    """
    spelt, given = {name.lower(): name for name in known}, str(wrong)[:80].lower()
    same = difflib.get_close_matches(given, spelt, n=1, cutoff=0.85)
    if same:
        return [spelt[same[0]]]
    holding = [name for lower, name in spelt.items() if given in lower]
    similar = difflib.get_close_matches(given, spelt, n=most, cutoff=0.5)
    found = [nearest(wrong, spelt.values()), *holding, *(spelt[name] for name in similar)]
    return list(dict.fromkeys(name for name in found if name))[:most]


def _synonyms(given: str, spelt: Mapping[str, str]) -> list[str]:
    """Return the known names for what a symbol stands for."""
    known = SYMBOLS | _ALARMS | _VERBS
    groups = ([each.lower() for each in (*more, name)] for name, more in known.items())
    return [each for group in groups if given in group for each in group if each in spelt]
