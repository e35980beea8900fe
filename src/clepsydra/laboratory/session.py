"""A session of a laboratory: the file that a page saves, read and checked."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clepsydra import __version__
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.engine.philox import WORD
from clepsydra.laboratory.fields import AGAIN, WHAT, Fields
from clepsydra.laboratory.page_data import FORM
from clepsydra.laboratory.rig import STARTS, Start
from clepsydra.laboratory.touch import Touch, touch_of

#: Of a file: some hundred thousand touches [bytes].
LARGEST = 20_000_000
#: Four months at a sample a second.
MOST_SAMPLES = 10_000_000
#: Of what a reader calls a controller.
LONGEST_TITLE = 300
#: What a page counts exactly.
MOST_SEED = WORD


@dataclass(frozen=True)
class Session:
    """What was done in a laboratory.

    Parameters
    ----------
    process : str
        Of the catalogue, or the path of its file.
    controllers : tuple of str
        Their names; the first has the rig at the start.
    digest : str
        Of the rig.
    start : {"rest", "empty"}
    samples : int
    seed : int
        Of the noise.
    touches : tuple of Touch
        In the order of their samples.
    titles : dict
        Controller to what its reader called it, as by the file that was loaded.
    """

    process: str
    controllers: tuple[str, ...]
    digest: str
    start: Start
    samples: int
    seed: int
    touches: tuple[Touch, ...]
    titles: dict[str, str]


def read_session(path: str | Path) -> Session:
    """Read a session; what is damaged, or of another version, is refused with its place.

    Raises
    ------
    InputError
        It is no such file, or something in it is missing or wrong.
    """
    place = str(path)
    content = read_input(Path(path), WHAT, LARGEST)
    try:
        found = json.loads(content)
    except UnicodeDecodeError:
        raise InputError(place, Finding("no text in UTF-8"), WHAT, AGAIN) from None
    except json.JSONDecodeError as error:
        where = f"{place}, line {error.lineno}, column {error.colno}"
        raise InputError(where, Finding("no JSON"), WHAT, AGAIN) from None
    except RecursionError:
        raise InputError(place, Finding("too many brackets"), WHAT, AGAIN) from None
    return session_of(found, place)


def session_of(found: Any, place: str) -> Session:
    """Return a session from values of JSON.

    Parameters
    ----------
    place : str
        What messages call it.

    Examples
    --------
    >>> session_of({"form": 2, "version": "0.0.1"}, "session.json")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: session.json, version: got '0.0.1', expected the version of \
this installation, '0.1.0'; run it with Clepsydra 0.0.1, or make the page once more.
    """
    fields = Fields(found, place)
    form = fields.take("form", int, "a number")
    if form != FORM:
        raise InputError(
            f"{place}, form", form, f"{FORM}, the form of this version",
            "run it with the version that wrote it",
        )  # fmt: skip
    version = fields.take("version", str, "the version that wrote it")
    if version != __version__:
        raise InputError(
            f"{place}, version", version, f"the version of this installation, {__version__!r}",
            f"run it with Clepsydra {version[:30]}, or make the page once more",
        )  # fmt: skip
    start = fields.take("start", str, "where it begins")
    if start not in STARTS:
        raise InputError(f"{place}, start", start, f"one of {', '.join(STARTS)}", AGAIN)
    names = fields.take("controllers", list, "the names of its controllers")
    if not names or not all(isinstance(each, str) for each in names):
        raise InputError(f"{place}, controllers", names, "names", AGAIN)
    samples = fields.take("samples", int, "how many samples it has")
    if not 1 <= samples <= MOST_SAMPLES:
        expected = f"a whole number from 1 to {MOST_SAMPLES}"
        raise InputError(f"{place}, samples", samples, expected, AGAIN)
    seed = fields.take("seed", int, "the seed of its noise")
    if not 0 <= seed <= MOST_SEED:
        expected = f"a whole number from 0 to {MOST_SEED}"
        raise InputError(f"{place}, seed", seed, expected, AGAIN)
    touches, last = [], 0
    for number, each in enumerate(fields.take("touches", list, "what was done")):
        touch = touch_of(each, f"{place}, touches[{number}]")
        if not last <= touch.sample < samples:
            raise InputError(
                f"{place}, touches[{number}].sample", touch.sample,
                f"a sample from {last}, that of the touch before, to {samples - 1}", AGAIN,
            )  # fmt: skip
        last = touch.sample
        touches.append(touch)
    return Session(
        fields.take("process", str, "the process"),
        tuple(names),
        fields.take("digest", str, "the digest of its rig"),
        next(known for known in STARTS if known == start),
        samples,
        seed,
        tuple(touches),
        _titles(fields),
    )


def _titles(fields: Fields) -> dict[str, str]:
    if "titles" not in fields.found:
        return {}
    titles: dict[str, Any] = fields.take("titles", dict, "texts by controller")
    for name, title in titles.items():
        if not isinstance(title, str) or len(title) > LONGEST_TITLE:
            expected = f"a text of up to {LONGEST_TITLE} letters"
            raise InputError(f"{fields.place}, titles.{name[:30]}", title, expected, AGAIN)
    return titles
