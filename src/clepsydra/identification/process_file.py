"""A process file with fitted parameters: a copy of the file with one more variant in force."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.base.input_file import read_input
from clepsydra.base.units import from_si
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.process.catalogue_names import catalogue_file
from clepsydra.process.document import Document, parse
from clepsydra.process.elements.flow_splitter import FlowSplitter
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.toml_lines import entries

_VARIANT = "identified"
#: The file gives back the fitted numbers to this share.
_SAME = 1e-6


def _folder_of(path: Path) -> str:
    """Return the folder of a file, links followed, also those that lead to each other."""
    return os.path.realpath(path.parent)


def write_fitted_process(fit: ProcessFit, path: Path) -> None:
    """Write the process file with the fitted parameters in force.

    It is the file that the process was read from, comments and all, and behind it a variant
    `identified` with the fitted numbers in the units of the file; `default_variant` puts it in
    force, behind the variants that were in force already. The sampling period stays that of the
    file.

    Raises
    ------
    InputError
        A parameter is no key of the file, the file has elements of its own and is to be written
        to another folder, or it cannot be written.
    """
    if path.suffix.lower() != ".toml":
        raise InputError("fitted process file", str(path), "a file that ends in .toml", "rename it")
    text = fitted_process_text(fit)
    own = parse(text.encode(), str(path)).tables.get("elements")
    if own and fit.process.path and _folder_of(path) != _folder_of(fit.process.path):
        raise InputError(
            "fitted process file", str(path),
            f"a file beside {fit.process.path}, whose elements are in {own}",
            "write it to that folder",
        )  # fmt: skip
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
        written = load_process(part).parameter_values
        if not np.allclose(written, fit.process.parameter_values, rtol=_SAME, atol=0.0):
            raise InputError(
                "fitted process file", str(path),
                "a process file that a variant can give the fitted numbers",
                "enter the numbers of the report by hand",
            )  # fmt: skip


def fitted_process_text(fit: ProcessFit) -> str:
    r"""Return the process file with the fitted parameters in force, as text.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.process_fit import fit_process
    >>> from clepsydra.identification.record import Record
    >>> tanks = load_process("quadruple-tank")
    >>> steps = [cl.step("pump_1", to=4.0, at=60.0), cl.step("pump_1", to=2.0, at=300.0)]
    >>> run = cl.simulate(cl.Plant(tanks), None, steps, duration="10 min")
    >>> record = Record("by hand", run.signals, run.values, tanks.sampling_period)
    >>> text = fitted_process_text(fit_process(tanks, record, ["splitter_1.tank_1"]))
    >>> print("\n".join(text.splitlines()[-3:]))
    [variants.identified]
    description = "Parameters identified from by hand"
    splitters.splitter_1.fractions = { tank_1 = 0.7, tank_4 = 0.3 }
    """
    process = fit.process
    if process.path is not None:
        content = read_input(process.path, "a process file")
    else:
        content = catalogue_file(process.name).read_bytes()
    document = parse(content, process.address)
    text = content.decode("utf-8-sig").replace("\r\n", "\n").rstrip() + "\n"
    variant, number = _VARIANT, 1
    while variant in document.tables.get("variants", {}):
        number += 1
        variant = f"{_VARIANT}-{number}"
    names = ", ".join(f'"{name}"' for name in (*process.variant, variant))
    text = _with_default(text, f"default_variant = [{names}]")
    source = "".join(c for c in Path(fit.record.place).name if c.isprintable() and c not in '"\\')
    lines = [
        "",
        "# The numbers before are the ones that the search began with.",
        f"[variants.{variant}]",
        f'description = "Parameters identified from {source}"',
    ]
    return text + "\n".join([*lines, *_assignments(fit, document)]) + "\n"


def _with_default(text: str, assignment: str) -> str:
    """Return the text with the variants in force: a new line, or instead of the old entry."""
    found = {entry.path: entry for entry in entries(text)}
    old, name = found.get(("default_variant",)), found["name",]
    if old is not None:
        return text[: old.start] + assignment + text[old.end :]
    return f"{text[: name.end]}\n{assignment}{text[name.end :]}"


def _assignments(fit: ProcessFit, document: Document) -> list[str]:
    process = fit.process
    values = {signal.name: signal.initial for signal in process.parameters}
    elements = {element.name: element for element in process.elements}
    found: dict[str, str] = {}
    for estimate in fit.estimates:
        signal = estimate.signal
        owner, _, key = signal.name.partition(".")
        element = elements.get(owner)
        if isinstance(element, FlowSplitter):
            first = [d for d in element.destinations if f"{owner}.{d}" in values]
            shares = {d: round(values[f"{owner}.{d}"], 9) for d in first}
            last = next(d for d in element.destinations if d not in first)
            shares[last] = round(1.0 - sum(shares.values()), 9)
            inner = ", ".join(f"{name} = {share!r}" for name, share in shares.items())
            found[f"splitters.{owner}.fractions"] = f"{{ {inner} }}"
            continue
        path = (owner,) if element is None else (element.table, owner, key)
        _check_key(process, path, document)
        shown = from_si(estimate.value, signal.unit, signal.shown_unit)
        number = f"{shown:.9g}"
        unit = signal.shown_unit
        found[".".join(path)] = number if unit == "1" else f'"{number} {unit}"'
    return [f"{key} = {value}" for key, value in found.items()]


def _check_key(process: Process, path: tuple[str, ...], document: Document) -> None:
    """Refuse a parameter that the file gives in another way than by a key of its name."""
    if len(path) == 1:
        return
    table, name, key = path
    element = next(e for e in process.elements if e.name == name)
    given = document.tables.get(table, {}).get(name, {})
    if key not in type(element).keys or (key == "gain" and "span" in given):
        raise InputError(
            document.place(table, name), f"{name}.{key}", f"a key {key} of {name}",
            "change what it follows from by hand, by the number of the report",
        )  # fmt: skip
