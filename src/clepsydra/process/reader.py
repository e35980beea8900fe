"""A process file → `Process`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import MISSING
from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.quantity import Quantity
from clepsydra.base.signal import Signal
from clepsydra.base.standing import Standing, standing_at
from clepsydra.base.suggestion import suggestion
from clepsydra.process import told
from clepsydra.process.alarm_reader import ALARMS, read_alarms
from clepsydra.process.averaging import read_averaging, read_bands
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.component import Component
from clepsydra.process.components import check_components, read_components
from clepsydra.process.document import Document, kind_of, parse
from clepsydra.process.drawn import drawn, split_number
from clepsydra.process.element import Element
from clepsydra.process.elements.tank import Tank
from clepsydra.process.equations import Equations, join
from clepsydra.process.kinds import kinds
from clepsydra.process.known_names import known_names
from clepsydra.process.operating_outputs import check_sensor_ranges, read_nominal_outputs
from clepsydra.process.own_elements import joining_own, read_own_kinds
from clepsydra.process.process import Process
from clepsydra.process.process_name import check_process_name
from clepsydra.process.table_reader import TableReader, checked_name
from clepsydra.process.tags import read_tags
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.process.uncertainty_reader import UNCERTAINTY, read_uncertainty
from clepsydra.process.unused import without_unused
from clepsydra.process.variants import (
    VARIANT_KEYS,
    choose_variants,
    split_variants,
    variants_asked,
)
from clepsydra.process.vessels.vessel import Vessel
from clepsydra.process.whole_samples import in_whole_samples
from clepsydra.process.wiring import check_wiring

_STANDARD_GRAVITY = 9.81
_GRAVITY = Quantity(
    "gravity",
    "m/s^2",
    low=0.0,
    strict=True,
    expected="an acceleration",
    remedy='leave it out for "9.81 m/s^2"',
)
_SAMPLING_PERIOD = Quantity(
    "sampling_period",
    "s",
    low=0.0,
    strict=True,
    expected="a time",
    remedy="give about a thirtieth of the dominant time constant",
)
#: The keys of a process file beside the tables of its elements.
GENERAL_KEYS = {
    "name": told.text("letters, digits and hyphens; reports and data are named after it"),
    "title": told.text("one line for people"),
    "source": told.text("where the numbers come from, one line"),
    "gravity": _GRAVITY.schema(_STANDARD_GRAVITY, "acceleration of gravity"),
    "sampling_period": _SAMPLING_PERIOD.schema(words="of the controllers"),
    "controlled": told.names("the sensors that follow setpoints"),
    "averaging": told.names("controlled levels whose tank is there to smooth the flow"),
    "manipulated": told.names("what controllers move; all pumps and valves if left out"),
    "components": told.by_name("what is dissolved in the liquid", {"type": "object"}),
    "alarms": ALARMS,
    "uncertainty": UNCERTAINTY,
    "elements": told.text("a Python file with elements of your own, which is run"),
    "operating_point": told.by_name("measurements at the operating point"),
    **VARIANT_KEYS,
}
#: Those that a process must have.
REQUIRED_KEYS = ("name", "sampling_period", "controlled")


def load_process(name_or_path: str | Path, variant: str | Sequence[str] | None = None) -> Process:
    """Read a process from the catalogue or from a file.

    A process file that names Python, ``elements = "my_elements.py"``, runs it: open such files
    only where you trust whoever wrote them.

    Parameters
    ----------
    name_or_path : str or Path
        A name of the catalogue, "quadruple-tank", or the path of a TOML file. A text is a
        path where it ends in ".toml", contains a separator of folders or names a file. Variants
        may follow a colon, "averaging-tank:inflow-constant" or "plant.toml:large,cold", and the
        number that draws its holes, splits and gains a sign, "quadruple-tank#7".
    variant : str or sequence of str, optional
        Variants of the file, laid over it in this order. Without any, those that the file
        names in `default_variant`.

    Raises
    ------
    InputError
        There is no such process or variant, or its file is wrong: the message names the line.

    Examples
    --------
    >>> process = load_process("quadruple-tank")
    >>> [signal.name for signal in process.inputs], process.signal("tank_1.area").initial
    (['pump_1', 'pump_2'], 0.0028)
    >>> load_process("averaging-tank:inflow-constant").variant
    ('inflow-constant',)
    """
    require_type(
        name_or_path,
        (str, Path),
        "process",
        _expected(),
        "give it as text or as a Path",
    )
    if isinstance(name_or_path, str) and not _exists(name_or_path):
        name_or_path, number = split_number(name_or_path)
        return drawn(_loaded(name_or_path, variants_asked(variant)), number)
    return _loaded(name_or_path, variants_asked(variant))


def _loaded(name_or_path: str | Path, asked: tuple[str, ...] | None) -> Process:
    """Return a process as its file has it."""
    if isinstance(name_or_path, str) and not _exists(name_or_path):
        name_or_path, written = split_variants(name_or_path)
        if written is not None and asked is not None:
            expected = f"no variant beside {', '.join(written)[:60]}, which follows the colon"
            remedy = "give variants in one of the two ways"
            raise InputError("variant", ", ".join(asked)[:60], expected, remedy)
        asked = asked if written is None else written
    if isinstance(name_or_path, str) and name_or_path in catalogue_names():
        file = catalogue_file(name_or_path)
        return _process(parse(file.read_bytes(), file.name), None, asked)
    path = Path(name_or_path)
    if isinstance(name_or_path, str) and not _means_a_path(name_or_path):
        names = catalogue_names()
        raise InputError(
            "process",
            name_or_path[:60],
            _expected(),
            suggestion(
                name_or_path,
                [*names, *map(str, Path().glob("*.toml"))],
                "choose a name, or check the path",
            ),
        )
    content = read_input(path, "a process file", inside="the .toml file")
    return _process(parse(content, str(path)), path, asked)


def _means_a_path(text: str) -> bool:
    separators = [os.sep, os.altsep] if os.altsep else [os.sep]
    if text.lower().endswith(".toml") or any(separator in text for separator in separators):
        return True
    return _exists(text)


def _exists(text: str) -> bool:
    if not text:
        return False
    standing = standing_at(Path(text), "process", _expected(), value=text[:60])
    return standing is not Standing.NOTHING


def _expected() -> str:
    return f"a name of the catalogue ({', '.join(catalogue_names())}) or the path of a .toml file"


def _process(document: Document, path: Path | None, asked: tuple[str, ...] | None) -> Process:
    """Build a process from a parsed file; every mistake in it ends here as an `InputError`."""
    if kind_of(document) == "study":
        remedy = "give it to clepsydra study, or name the process that it is about"
        raise InputError(
            document.file, Finding("a study file"), "a process file, with tanks", remedy
        )
    if kind_of(document) == "lesson":
        raise InputError(
            document.file, Finding("a lesson"), "a process file, with tanks",
            "give it to clepsydra lab --lesson",
        )  # fmt: skip
    chosen = choose_variants(document, asked)
    document = chosen.document
    known = (*GENERAL_KEYS, *(kind.table for kind in kinds()))
    own_kinds, vanished = read_own_kinds(TableReader(document, (), None), path, known)
    general = TableReader(document, (), (*known, *(kind.table for kind in own_kinds)))
    name = general.text("name", "a name", 'write as in name = "my-tanks"')
    check_process_name(name, general.place("name"))
    components = read_components(document, general)
    read = _elements(document, general, components, own_kinds)
    elements, components, unused = without_unused(document, read, components)
    _check_complete(general, elements)
    check_wiring(elements, document.place, read)
    check_sensor_ranges(document, elements)
    gravity = Signal(
        "gravity",
        "m/s^2",
        display_unit=general.display_units("gravity").get("gravity", ""),
        low=0.0,
        initial=general.declared(_GRAVITY, {}, _STANDARD_GRAVITY),
        description="acceleration of gravity",
    )
    check_components(components, elements, document.place)
    period = general.declared(_SAMPLING_PERIOD, {}, MISSING)
    elements, rounded = in_whole_samples(document, elements, period)
    manipulated = _manipulated(general, elements)
    with joining_own(own_kinds, general):
        joined = join(elements, gravity, components=components, manipulated=manipulated)
    controlled = _controlled(general, joined.measurements, len(joined.inputs))
    averaging = read_averaging(general, controlled, joined.inputs, elements)
    nominal_outputs = read_nominal_outputs(document, elements, [u.name for u in joined.inputs])
    return Process(
        **vars(joined),
        name=name,
        title=general.text("title", "one line of text", "correct it", default=name),
        source=general.text("source", "one line of text", "correct it", default="not given"),
        controlled=controlled,
        elements=elements,
        nominal_outputs=nominal_outputs,
        sampling_period=period,
        path=path,
        document=None if path is None else document,
        components=components,
        variant=chosen.names,
        variants=chosen.descriptions,
        warnings=() if path is None else (*chosen.warnings, *unused, *vanished, *rounded),
        averaging=averaging,
        alarms=read_alarms(document, general, joined, controlled),
        bands=read_bands(document, elements, averaging, nominal_outputs),
        tags=read_tags(document, elements),
        uncertainty=_uncertainty(document, general, joined),
    )


def _check_complete(general: TableReader, elements: Sequence[Element]) -> None:
    """Refuse a plant without tank, pump or sensor: there is nothing to control."""
    for present, table, expected in (
        (any(element.states() for element in elements), "tanks", "at least one tank"),
        (
            any(element.inputs() for element in elements)
            or (general.has("manipulated") and any(e.disturbances() for e in elements)),
            "pumps",
            "at least one pump, or a flow that is manipulated",
        ),
        (any(element.measurements() for element in elements), "sensors", "at least one sensor"),
    ):
        if not present:
            remedy = f"add a table, as in [{table}.{table[:-1]}_1]"
            flows = [signal.name for element in elements for signal in element.disturbances()]
            if table == "pumps" and flows:
                remedy += f', or list a flow at the top of the file: manipulated = ["{flows[0]}"]'
            raise InputError(general.place(), Finding(f"no {table}"), expected, remedy)


def _elements(
    document: Document,
    general: TableReader,
    components: tuple[Component, ...],
    own_kinds: tuple[type[Element], ...],
) -> tuple[Element, ...]:
    """Read the elements of every kind, in the order of the file within each kind."""
    elements: list[Element] = []
    vessels: dict[str, Vessel] = {}
    for kind in (*kinds(), *own_kinds):
        if not general.has(kind.table):
            continue
        for name in TableReader(document, (kind.table,), None).present:
            path = (kind.table, name)
            checked_name(name, document.place(*path))
            table = TableReader(
                document,
                path,
                kind.keys,
                components=components,
                made=vessels,
                general=GENERAL_KEYS,
                others=kind.other_keys,
            )
            element = kind.read(name, table)
            elements.append(element)
            if isinstance(element, Tank):
                vessels[name] = element.vessel
    return tuple(elements)


def _uncertainty(document: Document, general: TableReader, joined: Equations) -> Uncertainty:
    """Read how uncertain the parameters are; as by default where the file does not say it."""
    if not general.has("uncertainty"):
        return Uncertainty()
    return read_uncertainty(TableReader(document, ("uncertainty",), None), joined)


def _manipulated(general: TableReader, elements: Sequence[Element]) -> tuple[str, ...] | None:
    """Read which signals from outside a controller moves; None for all pumps and valves."""
    if not general.has("manipulated"):
        return None
    known = [s.name for e in elements for s in (*e.inputs(), *e.disturbances())]
    expected, each = "a list of pumps, valves or flows", "the name of a signal from outside"
    return known_names(known, general, "manipulated", expected=expected, each=each)


def _controlled(
    general: TableReader, measurements: Sequence[Signal], inputs: int
) -> tuple[str, ...]:
    """Read the measurements that follow setpoints."""
    known = [signal.name for signal in measurements]
    remedy, each = f'write as in controlled = ["{known[0]}"]', "the name of a sensor"
    names = known_names(
        known, general, "controlled", expected="a list of sensors", remedy=remedy, each=each
    )
    if len(names) > inputs:
        expected = f"at most as many as signals are manipulated, {inputs}"
        remedy = "leave the others uncontrolled, or add a pump"
        raise general.refused("controlled", ", ".join(names), expected, remedy)
    return names
