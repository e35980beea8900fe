"""What a program is made of as bytes: the same for the same content, and for no other."""

from __future__ import annotations

import marshal
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from operator import attrgetter, index
from typing import Any

from clepsydra.program.operation import Operation

#: What stands for itself.
_ITSELF = frozenset((int, float, bool, str, type(None)))
#: Of what `marshal` writes: floats by their bits, and equal parts alike, be they one object or two.
_FORMAT = 2


def canonical_bytes(item: object) -> bytes:
    """Return bytes that are the same for equal items, in every process, and for no others.

    Two numbers are equal if all of their bits are: 0 is not −0.

    Parameters
    ----------
    item : object
        Numbers, truth values, texts, and tuples, sets, mappings and data classes of such.

    Raises
    ------
    TypeError
        There is something else in it.

    Examples
    --------
    >>> canonical_bytes((0.0,)) == canonical_bytes((-0.0,))
    False
    >>> canonical_bytes({"b", "a"}) == canonical_bytes({"a", "b"})
    True
    """
    return marshal.dumps(_plain(item), _FORMAT)


def _plain(item: Any) -> Any:
    """Return an item as numbers, texts, tuples, lists and dicts, which stay apart as bytes.

    A list is a set, a dict a mapping or an object by its class.
    """
    kind: Any = type(item)
    if kind in _ITSELF:
        return item
    if kind is Operation:  # most of a program
        return item.target, item.code, item.arguments, float(item.constant), item.fused
    if kind is tuple:
        return tuple([_plain(each) for each in item])
    if is_dataclass(item):
        return {kind.__qualname__: [_plain(each) for each in _content_of(kind)(item)]}
    if isinstance(item, (set, frozenset)):
        return sorted(_plain(each) for each in item)
    if isinstance(item, Mapping):
        return {"": sorted((_plain(key), _plain(each)) for key, each in item.items())}
    if isinstance(item, float):
        return float(item)
    if hasattr(kind, "__index__"):
        return index(item)
    raise TypeError(f"{kind.__qualname__} has no canonical bytes")


@cache
def _content_of(kind: type) -> Callable[[Any], tuple[Any, ...]]:
    """Return what reads the fields of a data class."""
    names = [each.name for each in fields(kind)]
    if len(names) > 1:
        return attrgetter(*names)
    return lambda item: tuple(getattr(item, name) for name in names)
