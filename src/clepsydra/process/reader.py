"""A process file → `Process`."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.document import Document, parse, read_bytes
from clepsydra.process.element import Element
from clepsydra.process.equations import join
from clepsydra.process.kinds import KINDS
from clepsydra.process.operating_outputs import check_sensor_ranges, read_nominal_outputs
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, checked_name
from clepsydra.process.wiring import check_wiring

_GENERAL_KEYS = (
    "name",
    "title",
    "source",
    "gravity",
    "sampling_period",
    "controlled",
    "operating_point",
)


def load_process(name_or_path: str | Path) -> Process:
    """Read a process from the catalogue or from a file.

    Parameters
    ----------
    name_or_path : str or Path
        A name of the catalogue, "quadruple-tank", or the path of a TOML file. A text is a
        path where it ends in ".toml", contains a separator of folders or names a file.

    Returns
    -------
    Process

    Raises
    ------
    InputError
        There is no such process, or its file is wrong: the message names the line.

    Examples
    --------
    >>> process = load_process("quadruple-tank")
    >>> [signal.name for signal in process.inputs], process.signal("tank_1.area").initial
    (['pump_1', 'pump_2'], 0.0028)
    """
    require_type(
        name_or_path,
        (str, Path),
        "process",
        f"a name of the catalogue ({', '.join(catalogue_names())}) or the path of a .toml file",
        "give it as text or as a Path",
    )
    if isinstance(name_or_path, str) and name_or_path in catalogue_names():
        file = catalogue_file(name_or_path)
        return _process(parse(file.read_bytes(), file.name), None)
    path = Path(name_or_path)
    if isinstance(name_or_path, str) and not _means_a_path(name_or_path):
        names = catalogue_names()
        raise InputError(
            "process",
            name_or_path[:60],
            f"a name of the catalogue ({', '.join(names)}) or the path of a .toml file",
            suggestion(name_or_path, names, "choose a name, or check the path"),
        )
    return _process(parse(read_bytes(path), str(path)), path)


def _means_a_path(text: str) -> bool:
    separators = [os.sep, os.altsep] if os.altsep else [os.sep]
    if text.lower().endswith(".toml") or any(separator in text for separator in separators):
        return True
    return len(text) < 256 and "\0" not in text and bool(text) and Path(text).exists()


def _process(document: Document, path: Path | None) -> Process:
    """Build a process from a parsed file; every mistake in it ends here as an `InputError`."""
    general = TableReader(document, (), (*_GENERAL_KEYS, *(kind.table for kind in KINDS)))
    name = general.text("name", "a name", 'write as in name = "my-tanks"')
    if not re.fullmatch(r"[A-Za-z](?:[-_]?[A-Za-z0-9]){0,59}", name):
        raise general.refused(
            "name",
            general.written("name"),
            "letters, digits and single hyphens after a first letter",
            'write as in name = "my-tanks"',
        )
    elements = _elements(document, general)
    _check_complete(general, elements)
    check_wiring(elements, document.place)
    check_sensor_ranges(document, elements)
    gravity = Signal(
        "gravity",
        "m/s^2",
        display_unit=general.display_units("gravity").get("gravity", ""),
        low=0.0,
        initial=general.quantity(
            "gravity",
            "m/s^2",
            "an acceleration",
            'leave it out for "9.81 m/s^2"',
            above=0.0,
            default=9.81,
        ),
        description="acceleration of gravity",
    )
    joined = join(elements, gravity)
    return Process(
        name=name,
        title=general.text("title", "one line of text", "correct it", default=name),
        source=general.text("source", "one line of text", "correct it", default="not given"),
        state=joined.state,
        inputs=joined.inputs,
        disturbances=joined.disturbances,
        measurements=joined.measurements,
        controlled=_controlled(general, joined.measurements, len(joined.inputs)),
        parameters=joined.parameters,
        dynamics=joined.dynamics,
        measure=joined.measure,
        measured_state=joined.measured_state,
        elements=elements,
        nominal_outputs=read_nominal_outputs(document, elements),
        sampling_period=general.quantity(
            "sampling_period",
            "s",
            "a time",
            "give about a thirtieth of the dominant time constant",
            above=0.0,
        ),
        path=path,
    )


def _check_complete(general: TableReader, elements: Sequence[Element]) -> None:
    """Refuse a plant without tank, pump or sensor: there is nothing to control."""
    for present, table, expected in (
        (any(element.states() for element in elements), "tanks", "at least one tank"),
        (any(element.inputs() for element in elements), "pumps", "at least one pump"),
        (any(element.measurements() for element in elements), "sensors", "at least one sensor"),
    ):
        if not present:
            remedy = f"add a table, as in [{table}.{table[:-1]}_1]"
            raise InputError(general.place(), f"no {table}", expected, remedy)


def _elements(document: Document, general: TableReader) -> tuple[Element, ...]:
    """Read the elements of every kind, in the order of the file within each kind."""
    elements: list[Element] = []
    for kind in KINDS:
        if not general.has(kind.table):
            continue
        for name in TableReader(document, (kind.table,), None).present:
            path = (kind.table, name)
            checked_name(name, document.place(*path))
            elements.append(kind.read(name, TableReader(document, path, kind.keys)))
    return tuple(elements)


def _controlled(
    general: TableReader, measurements: Sequence[Signal], inputs: int
) -> tuple[str, ...]:
    """Read the measurements that follow setpoints."""
    known = [signal.name for signal in measurements]
    expected = "a list of sensors"
    names = general.names("controlled", expected, f'write as in controlled = ["{known[0]}"]')
    for name in names:
        if name not in known:
            raise general.refused(
                "controlled",
                name[:60],
                "the name of a sensor",
                suggestion(name, known, f"choose from {', '.join(known)}"),
            )
    if len(names) > inputs:
        raise general.refused(
            "controlled",
            ", ".join(names),
            f"at most as many as there are pumps, {inputs}",
            "leave the others uncontrolled, or add a pump",
        )
    return names
