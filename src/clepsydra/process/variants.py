"""Variants of a process file: tables that differ from the rest of it, chosen by name."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from copy import deepcopy
from typing import Any, NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.remark import Remark
from clepsydra.base.suggestion import suggestion
from clepsydra.base.words import listed
from clepsydra.process import cross_section, told
from clepsydra.process.document import Document
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.process.toml_lines import line_of

#: Keys of a process file that say which variants it has, and so cannot vary themselves.
VARIANT_KEYS = {
    "variants": told.by_name("parts of the file that differ, by name", {"type": "object"}),
    "default_variant": {
        "description": "the variants in force where none is asked for",
        "type": ["string", "array"],
        "items": {"type": "string"},
    },
}

#: Keys that a warning names at most.
_SHOWN = 4
#: Tables around a key of an element: its kind and its name.
_OF_ELEMENT = 2
_NAME = re.compile(r"[A-Za-z](?:[-_]?[A-Za-z0-9]){0,39}")


class ChosenVariants(NamedTuple):
    """A process file with variants laid over it.

    Parameters
    ----------
    document : Document
        Without its tables of variants; places of what a variant brought name the variant.
    names : tuple of str
        The variants in force, in the order in which they were laid over the file.
    descriptions : dict
        Every variant of the file to its description.
    warnings : tuple of str
        What has no effect where the file stands, since variants that nobody asked for give it.
    """

    document: Document
    names: tuple[str, ...]
    descriptions: dict[str, str]
    warnings: tuple[Remark, ...]


def split_variants(text: str) -> tuple[str, tuple[str, ...] | None]:
    """Split "process:variant,variant" into the process and its variants; None for no colon.

    A colon after a single letter is a drive's, and one before a separator of folders belongs
    to a folder.

    Examples
    --------
    >>> split_variants("laboratory-four-tanks:fitted,volts")
    ('laboratory-four-tanks', ('fitted', 'volts'))
    >>> split_variants("C:plant.toml")
    ('C:plant.toml', None)
    """
    process, colon, variants = text.rpartition(":")
    folder = any(separator in variants for separator in (os.sep, os.altsep) if separator)
    if not colon or len(process) < 2 or folder:
        return text, None
    names = tuple(name.strip() for name in variants.split(","))
    if not all(names):
        expected = "a variant after the colon and after each comma"
        remedy = f'write as in "{process[:40]}:variant", or leave the colon out'
        raise InputError("process", text[:60], expected, remedy)
    return process, names


def variants_asked(variant: object) -> tuple[str, ...] | None:
    """Return the names of variants as a caller gave them: none, one, or several in order.

    Examples
    --------
    >>> variants_asked("fitted"), variants_asked(["fitted", "volts"]), variants_asked(None)
    (('fitted',), ('fitted', 'volts'), None)
    """
    if variant is None:
        return None
    names = (variant,) if isinstance(variant, str) else variant
    if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        expected = "the name of a variant, or several names"
        remedy = 'write as in variant="fitted" or variant=["fitted", "volts"]'
        raise InputError("variant", shown_value(variant), expected, remedy)
    return tuple(names)


def choose_variants(document: Document, asked: tuple[str, ...] | None) -> ChosenVariants:
    """Lay variants over a process file, one after the other.

    A table of a variant is merged into the table of the file, key by key; anything else takes
    the place of what the file says, as an area does of a diameter.

    Parameters
    ----------
    document : Document
        As parsed.
    asked : tuple of str or None
        Names of variants; None for those that the file names in `default_variant`.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> text = b"name = 'a'\\n[variants.slow]\\nsampling_period = '5 s'"
    >>> chosen = choose_variants(parse(text, "plant.toml"), ("slow",))
    >>> chosen.document.place("sampling_period")
    'plant.toml, line 3, variants.slow.sampling_period'
    """
    contents = _contents(document)
    descriptions = {
        name: TableReader(document, ("variants", name), None).text(
            "description", "one line of text", "correct it", default=""
        )
        for name in contents
    }
    place = "variant" if asked is not None else document.place("default_variant")
    names = _defaults(document) if asked is None else asked
    for name in names:
        if name not in contents:
            raise _unknown(name, contents, place, document.file)
    for name in names:
        if names.count(name) > 1:
            raise InputError(place, name, "every variant once", "remove one of the two")
    merged = deepcopy({k: v for k, v in document.tables.items() if k not in VARIANT_KEYS})
    origins: dict[tuple[str, ...], tuple[str, ...]] = {}
    warnings = []
    for name in names:
        content = {k: v for k, v in contents[name].items() if k != "description"}
        replaced = _merge(merged, content, (), ("variants", name), origins)
        if asked is None and replaced:
            warnings.append(_without_effect(document, name, replaced))
    laid_over = Document(document.file, merged, document.lines, origins)
    return ChosenVariants(laid_over, names, descriptions, tuple(warnings))


def _without_effect(document: Document, name: str, replaced: list[tuple[str, ...]]) -> Remark:
    """Return the sentence that says which keys of a file a default variant replaces."""
    shown = [f"{'.'.join(path)} (line {line_of(document.lines, path)})" for path in replaced]
    if len(shown) > _SHOWN:
        shown = [*shown[: _SHOWN - 1], f"{len(shown) - _SHOWN + 1} more keys"]
    has, it = ("has", "it") if len(replaced) == 1 else ("have", "them")
    return Remark(
        f"{listed(shown)} of {document.file} {has} no effect",
        f"the variant {name}, which default_variant puts in force, gives {it}",
        f"edit [variants.{name}], or remove default_variant",
    )


def _contents(document: Document) -> dict[str, dict[str, Any]]:
    """Return the table of each variant, each with a fitting name and only keys that may vary."""
    if "variants" not in document.tables:
        return {}
    for name in TableReader(document, ("variants",), None).present:
        if not _NAME.fullmatch(name):
            expected = "letters, digits and single hyphens after a first letter"
            remedy = "write as in [variants.outflow-constant]"
            raise InputError(document.place("variants", name), shown_value(name), expected, remedy)
        table = TableReader(document, ("variants", name), None)
        for key in (*VARIANT_KEYS, "name"):
            expected = f"no {key} within a variant"
            table.refuse((key,), expected, "remove it, or move it to the top of the file")
    contents: dict[str, dict[str, Any]] = document.tables["variants"]
    return contents


def _defaults(document: Document) -> tuple[str, ...]:
    """Return the variants that are in force where none is asked for."""
    general = TableReader(document, (), None)
    if not general.has("default_variant"):
        return ()
    expected, remedy = "the name of a variant", 'write as in default_variant = "nominal"'
    if isinstance(general.raw("default_variant"), str):
        return (general.text("default_variant", expected, remedy),)
    return general.names("default_variant", expected, remedy)


def _unknown(name: str, contents: Iterable[str], place: str, file: str) -> InputError:
    known = ", ".join(contents)
    return InputError(
        place,
        shown_value(name),
        f"a variant of {file} ({known})" if known else f"no variant, since {file} has none",
        suggestion(name, contents, "choose one of them, or none" if known else "leave it out"),
    )


def _merge(
    table: dict[str, Any],
    over: dict[str, Any],
    path: tuple[str, ...],
    origin: tuple[str, ...],
    origins: dict[tuple[str, ...], tuple[str, ...]],
) -> list[tuple[str, ...]]:
    """Merge a table into another in place; return which values of the file it replaced.

    Where each new value stands is noted in `origins`.
    """
    replaced = []
    for key, value in over.items():
        here, there = (*path, key), (*origin, key)
        if isinstance(value, dict) and isinstance(table.get(key), dict):
            replaced += _merge(table[key], value, here, there, origins)
            continue
        gone = [key]
        if len(path) == _OF_ELEMENT and key in cross_section.KEYS:
            gone += [other for other in cross_section.KEYS if other not in over]
        for each in gone:
            if each in table and (*path, each) not in origins:
                replaced.append((*path, each))
            # What an earlier variant brought below this key is gone, and with it its place.
            for old in [known for known in origins if known[: len(here)] == (*path, each)]:
                del origins[old]
        for other in gone[1:]:
            table.pop(other, None)
        table[key] = deepcopy(value)
        origins[here] = there
    return replaced
