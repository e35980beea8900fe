"""Bounds of what asyncua reads from the bytes of a stranger."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asyncua.common.utils import Buffer
from asyncua.ua import ua_binary
from asyncua.ua.uaerrors import UaError

#: Dimensions of an array at most: no tag has any.
_DIMENSIONS = 8
_GUARDED = "_guarded"


def guard() -> None:
    """Let asyncua read no array of more elements than there are bytes left.

    It takes the length of an array on trust; elements that take no bytes could keep it busy for
    minutes before anybody has said who they are.
    """
    for name in ("_create_uatype_array_deserializer", "_create_list_deserializer"):
        made = getattr(ua_binary, name)
        if not hasattr(made, _GUARDED):
            setattr(ua_binary, name, _with_bound(made))
    if not hasattr(ua_binary._reshape, _GUARDED):
        ua_binary._reshape = _with_few_dimensions(ua_binary._reshape)


def _with_bound(make: Callable[[Any], Callable[[Buffer], Any]]) -> Callable[[Any], Any]:
    def made(kind: Any) -> Callable[[Buffer], Any]:
        read = make(kind)

        def bounded(data: Buffer) -> Any:
            ahead = data.copy(4)
            length = int.from_bytes(ahead.read(4), "little", signed=True)
            if length > len(data):
                raise UaError("an array that is longer than its message")
            return read(data)

        return bounded

    setattr(made, _GUARDED, True)
    return made


def _with_few_dimensions(reshape: Callable[..., Any]) -> Callable[..., Any]:
    def bounded(flat: list[Any], dimensions: list[int]) -> Any:
        if len(dimensions or []) > _DIMENSIONS:
            raise UaError("an array of too many dimensions")
        return reshape(flat, dimensions)

    setattr(bounded, _GUARDED, True)
    return bounded
