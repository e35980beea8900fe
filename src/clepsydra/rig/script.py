"""A script of a rig: what happens to it at which time, as a file says."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.units import to_si
from clepsydra.process.process import Process
from clepsydra.rig.instructor import Instructor, check_delay, check_loss, faults_of
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import Refused, TagTable

_WHAT = "a script of a rig"
_EXAMPLE = '[[do]], at = "30 s", fail = { level_1 = "dead" }'
_WIRES_EXAMPLE = 'write as in wires = { delay = "0.2 s", loss = "10 %", cut = false }'
_KEYS = ("at", "fail", "write", "disturb", "noise", "wires")


@dataclass(frozen=True)
class Wires:
    """What happens to the wires; what is left out stays as it is.

    Parameters
    ----------
    delay : float, optional
        By which answers are sent later [s].
    loss : float, optional
        Share of requests that nobody answers [1].
    cut : bool, optional
        Whether the cable is pulled.
    """

    delay: float | None = None
    loss: float | None = None
    cut: bool | None = None

    def said(self) -> list[str]:
        """Return what happens, in words."""
        said = [] if self.delay is None else [f"answers {self.delay:g} s late"]
        said += [] if self.loss is None else [f"{100.0 * self.loss:g} % of requests lost"]
        return said + (
            [] if self.cut is None else [f"cable {'pulled' if self.cut else 'plugged in'}"]
        )


@dataclass(frozen=True)
class Action:
    """What is done at one time.

    Parameters
    ----------
    at : float
        Of the plant, from the start of the rig [s].
    fail : dict
        Measurement or input to its fault.
    write : dict
        Tag to its value, in the unit of the tag.
    disturb : dict
        Disturbance to its value [SI].
    noise : bool, optional
    wires : Wires
    """

    at: float
    fail: dict[str, str]
    write: dict[str, float]
    disturb: dict[str, float]
    noise: bool | None
    wires: Wires

    def do(self, table: TagTable, instructor: Instructor) -> str:
        """Do it, and say what was done."""
        for name, fault in self.fail.items():
            instructor.fail(name, fault)
        for name, value in self.write.items():
            table.write(table.tags[name], value)
        for name, value in self.disturb.items():
            instructor.disturb(name, value)
        if self.noise is not None:
            instructor.noise(self.noise)
        wires = self.wires
        instructor.wires(delay=wires.delay, loss=wires.loss, cut=wires.cut)
        said = [f"{name}: {fault}" for name, fault in self.fail.items()]
        said += [f"{name} := {value:g}" for name, value in self.write.items()]
        said += [f"{name} := {value:g} (SI)" for name, value in self.disturb.items()]
        said += [] if self.noise is None else [f"noise {'on' if self.noise else 'off'}"]
        return ", ".join([*said, *wires.said()])


def read_script(path: Path, process: Process, tags: Sequence[Tag]) -> list[Action]:
    """Read a script, its actions in the order of their times.

    Parameters
    ----------
    path : Path
        Of a TOML file of tables [[do]], each with `at` and what is done then: `fail`, `write`,
        `disturb`, `noise`, `wires`.

    Raises
    ------
    InputError
        It is no such file, or something in it is not of this rig.
    """
    place = str(path)
    try:
        found = tomllib.loads(read_input(path, _WHAT).decode())
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(place, Finding(str(error)), _WHAT, f"write as in {_EXAMPLE}") from None
    known = {tag.name: tag for tag in tags}
    tables = found.get("do")
    if set(found) != {"do"} or not isinstance(tables, list):
        raise InputError(place, Finding("no [[do]]"), _WHAT, f"write as in {_EXAMPLE}")
    actions = [
        _action(table, f"{place}, do[{number}]", process, known)
        for number, table in enumerate(tables)
    ]
    return sorted(actions, key=lambda action: action.at)


def _action(table: Any, place: str, process: Process, tags: dict[str, Tag]) -> Action:
    if not isinstance(table, dict) or "at" not in table:
        raise InputError(place, Finding("no time"), _WHAT, f"write as in {_EXAMPLE}")
    for key in table:
        require_known(place, key, _KEYS)
    at = to_si(table["at"], "s", f"{place}.at")
    parts = {key: table.get(key, {}) for key in ("fail", "write", "disturb")}
    for key, each in parts.items():
        if not isinstance(each, dict):
            raise InputError(f"{place}.{key}", each, "names and values", f"write as in {_EXAMPLE}")
    faults = faults_of(process)
    for name, fault in parts["fail"].items():
        require_known(f"{place}.fail", name, [*faults])
        require_known(f"{place}.fail.{name}", fault, [*faults[name]])
    disturbances = {signal.name: signal for signal in process.disturbances}
    for name in parts["disturb"]:
        require_known(f"{place}.disturb", name, [*disturbances])
    noise = table.get("noise")
    if noise is not None and not isinstance(noise, bool):
        raise InputError(f"{place}.noise", noise, "true or false", "write as in noise = true")
    return Action(
        at, parts["fail"],
        {name: _written(f"{place}.write.{name}", name, value, tags)
         for name, value in parts["write"].items()},
        {name: to_si(value, disturbances[name].unit, f"{place}.disturb.{name}")
         for name, value in parts["disturb"].items()},
        noise, _wires(table.get("wires", {}), f"{place}.wires"),
    )  # fmt: skip


def _wires(given: Any, place: str) -> Wires:
    if not isinstance(given, dict):
        raise InputError(place, given, "delay, loss and cut", _WIRES_EXAMPLE)
    for key in given:
        require_known(place, key, ("delay", "loss", "cut"))
    cut = given.get("cut")
    if cut is not None and not isinstance(cut, bool):
        raise InputError(f"{place}.cut", cut, "true or false", _WIRES_EXAMPLE)

    def quantity(key: str, unit: str) -> float | None:
        return to_si(given[key], unit, f"{place}.{key}") if key in given else None

    delay, loss = quantity("delay", "s"), quantity("loss", "1")
    return Wires(
        None if delay is None else check_delay(delay, f"{place}.delay"),
        None if loss is None else check_loss(loss, f"{place}.loss"),
        cut,
    )


def _written(place: str, name: str, value: Any, tags: dict[str, Tag]) -> float:
    require_known(place, name, [*tags])
    tag = tags[name]
    if tag.signal.kind == "real":
        found = tag.on_wire(to_si(value, tag.unit, place))
    else:
        found = float(value) if isinstance(value, (int, float)) else float("nan")
    try:
        TagTable.check(tag, found)
    except Refused as refused:
        raise InputError(place, value, "a value that the tag takes", refused.why.value) from None
    return found
