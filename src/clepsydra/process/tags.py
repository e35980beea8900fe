"""Tags of sensors and actuators in a process file."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.language_words import C_WORDS, STRUCTURED_TEXT_WORDS
from clepsydra.process.declared import TAG
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.table_reader import IDENTIFIER, shown_value

_WORDS = frozenset(word.lower() for word in C_WORDS | STRUCTURED_TEXT_WORDS)


def read_tags(document: Document, elements: Sequence[Element]) -> dict[str, str]:
    """Return signals to their tags: the names that they have in the plant's control system.

    The tag of an element is that of the one signal that it measures or is moved by; else it
    takes the place of the element's own name.
    """
    taken = {"gravity": "the acceleration of gravity"}
    for element in elements:
        names = (element.name, *(signal.identifier for signal in element.signals()))
        taken |= {name.lower(): element.name for name in names}
    tags: dict[str, str] = {}
    for element in (each for each in elements if TAG in each.keys):
        table = document.tables[element.table][element.name]
        if TAG not in table:
            continue
        tag, place = table[TAG], document.place(element.table, element.name, TAG)
        if not isinstance(tag, str) or not IDENTIFIER.fullmatch(tag):
            expected = "at most 40 letters, digits and single underscores, a letter first"
            remedy = 'write as in tag = "LIC101", and LIC_101 for LIC-101'
            raise InputError(place, shown_value(tag), expected, remedy)
        if tag.lower() in _WORDS:
            remedy = f"write as in {tag}_1"
            raise InputError(place, tag, "a tag that is no word of C or Structured Text", remedy)
        other = taken.setdefault(tag.lower(), element.name)
        if other != element.name:
            expected = "a tag that nothing else has, in large or small letters"
            raise InputError(place, tag, expected, f"change it, since {other} has that name or tag")
        own = [signal.name for signal in (*element.measurements(), *element.inputs())]
        tags[own[0] if len(own) == 1 else element.name] = tag
    return tags
