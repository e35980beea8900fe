"""The data of a page as it holds them: what is much alike deflated, so that a page stays small."""

from __future__ import annotations

import json
import zlib
from base64 import b64decode
from collections.abc import Mapping, Sequence
from typing import Any

from clepsydra.report.live.packed import packed

#: Each controller has nearly the same of these.
_ALIKE = ("controllers", "laws")


def packed_data(data: Mapping[str, Any], drawings: Sequence[str]) -> dict[str, Any]:
    """Return the data of a page with controllers, laws and drawings in one text.

    Parameters
    ----------
    drawings : sequence of str
        Those that are not seen at first, as SVG.

    Examples
    --------
    >>> held = packed_data({"form": 2, "controllers": [{"name": "PI"}] * 99, "laws": {}}, [])
    >>> sorted(held), len(held["packed"]) < 200
    (['form', 'packed'], True)
    >>> unpacked_data(held)["controllers"][98]
    {'name': 'PI'}
    """
    alike = {name: data[name] for name in _ALIKE} | {"drawings": list(drawings)}
    rest = {name: value for name, value in data.items() if name not in _ALIKE}
    return rest | {"packed": packed(json.dumps(alike, ensure_ascii=False).encode())}


def unpacked_data(held: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a page from what it holds.

    Raises
    ------
    ValueError
        They are damaged.
    """
    try:
        alike = json.loads(zlib.decompress(b64decode(held["packed"])))
    except zlib.error as error:
        raise ValueError(str(error)) from None
    return {**held, **alike}
