"""What hands do to a rig before a sample, and how a file says so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.laboratory.fields import AGAIN, Fields

#: How a controller takes the rig: as it has followed in manual so far; as it would stand after it
#: had followed for long, where its numbers are new; or with its state at zero.
Takeover = Literal["bumpless", "settled", "zero"]


@dataclass(frozen=True)
class Touch:
    """A hand on the rig before a sample.

    Parameters
    ----------
    sample : int
    """

    sample: int


@dataclass(frozen=True)
class InputTouch(Touch):
    """An input of the program is set.

    Parameters
    ----------
    input : str
    value : float
        [SI]
    """

    input: str
    value: float


@dataclass(frozen=True)
class ParameterTouch(Touch):
    """Parameters of the process get other values.

    Parameters
    ----------
    values : mapping
        Parameter to its value [SI].
    """

    values: Mapping[str, float]


@dataclass(frozen=True)
class SettingTouch(Touch):
    """Parameters of the law of a controller get other values.

    Parameters
    ----------
    values : mapping
        Parameter, as the program of the loop calls it, to its value [SI].
    controller : str
    """

    values: Mapping[str, float]
    controller: str


@dataclass(frozen=True)
class TakeoverTouch(Touch):
    """Another controller gets the rig.

    Parameters
    ----------
    controller : str
    start : {"bumpless", "settled", "zero"}
    """

    controller: str
    start: Takeover = "bumpless"


@dataclass(frozen=True)
class NoiseTouch(Touch):
    """Sensors and noisy disturbances are noisy from then on, or quiet.

    Parameters
    ----------
    is_noisy : bool
    """

    is_noisy: bool


@dataclass(frozen=True)
class DriftTouch(Touch):
    """A sensor drifts from then on.

    Parameters
    ----------
    measurement : str
    rate : float
        What is added to its reading in a second [SI/s]; 0 ends it.
    """

    measurement: str
    rate: float


def touch_of(found: Any, place: str) -> Touch:
    """Return a touch from an object of JSON.

    Parameters
    ----------
    place : str
        What messages call it.

    Examples
    --------
    >>> touch_of({"sample": 3, "input": "pump_1.mode", "value": 0}, "touches[0]")
    InputTouch(sample=3, input='pump_1.mode', value=0.0)
    """
    fields = Fields(found, place)
    sample = fields.take("sample", int, "the sample before which it was")
    if "parameters" in fields.found:
        return ParameterTouch(sample, _numbers(fields, "parameters"))
    if "settings" in fields.found:
        owner = fields.take("of", str, "the controller whose settings they are")
        return SettingTouch(sample, _numbers(fields, "settings"), owner)
    if "controller" in fields.found:
        start = fields.found.get("start", "bumpless")
        if start not in get_args(Takeover):
            expected = f"one of {', '.join(get_args(Takeover))}"
            raise InputError(f"{place}.start", start, expected, AGAIN)
        controller = fields.take("controller", str, "a controller")
        return TakeoverTouch(sample, controller, start)
    if "noise" in fields.found:
        return NoiseTouch(sample, fields.take("noise", bool, "true or false"))
    if "drift" in fields.found:
        return DriftTouch(
            sample, fields.take("drift", str, "a measurement"), _number(fields, "rate")
        )
    return InputTouch(sample, fields.take("input", str, "what was set"), _number(fields, "value"))


def _number(fields: Fields, name: str) -> float:
    value = fields.found.get(name)
    if value is None or not is_finite_number(value):
        raise InputError(f"{fields.place}.{name}", value, "a finite number, in SI", AGAIN)
    return float(value)


def _numbers(fields: Fields, name: str) -> dict[str, float]:
    inner = Fields(fields.take(name, dict, "numbers by name"), f"{fields.place}.{name}")
    return {each: _number(inner, each) for each in inner.found}
