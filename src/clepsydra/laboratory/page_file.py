"""The page of a laboratory read again, for the numbers with which its sessions run."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.laboratory.packed_data import unpacked_data
from clepsydra.laboratory.page_data import FORM
from clepsydra.laboratory.rig import STARTS, Numbers, Standing

#: A page with all designs of a laboratory takes half a megabyte [bytes].
LARGEST = 20_000_000
_WHAT = "a page that clepsydra lab wrote"
_AGAIN = "give the page in which the session was saved, or make it once more"
_DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


def numbers_of_page(path: str | Path) -> dict[str, Numbers]:
    """Return the numbers of each controller of a page by its name.

    A controller that was tuned on one machine may differ in its last digits on another one; with
    those of its page a session runs the same everywhere.

    Raises
    ------
    InputError
        It is no such page, of another version, or damaged.
    """
    place = str(path)
    text = read_input(Path(path), _WHAT, LARGEST).decode("utf-8", errors="replace")
    found = _DATA.search(text)
    if found is None:
        raise InputError(place, Finding("no page of a laboratory"), _WHAT, _AGAIN)
    try:
        data = json.loads(found[1])
        if data["form"] != FORM:
            words = "make it once more, or run this with the version that wrote it"
            raise InputError(f"{place}, form", data["form"], f"{FORM}", words)
        return {each["name"]: _numbers(each) for each in unpacked_data(data)["controllers"]}
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        raise InputError(place, Finding("a damaged page"), _WHAT, _AGAIN) from None


def _numbers(controller: dict[str, Any]) -> Numbers:
    rings, states = controller["rings"], list(controller["states"])
    moving = controller["moving"]
    of_law = [each for each in rings if not each["isOfProcess"]]
    return Numbers(
        parameters={name: float(value) for name, value in controller["parameters"]},
        at_rest={name: float(value) for name, value in controller["inputs"]},
        starts={start: _standing(states, rings, controller["starts"][start]) for start in STARTS},
        cold=_standing(states[moving:], of_law, controller["cold"]),
    )


def _standing(
    states: list[str], rings: list[dict[str, Any]], found: dict[str, list[float]]
) -> Standing:
    numbers = iter(found["rings"])
    return Standing(
        {name: float(value) for name, value in zip(states, found["state"], strict=True)},
        {each["name"]: np.array(list(_taken(numbers, each["length"]))) for each in rings},
    )


def _taken(numbers: Iterator[float], count: int) -> Iterator[float]:
    return (float(next(numbers)) for _ in range(count))
