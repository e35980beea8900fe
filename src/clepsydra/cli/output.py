"""What goes to the terminal: one JSON document, or something for a person."""

from __future__ import annotations

import json
import math
from typing import Any


def print_json(document: dict[str, Any]) -> None:
    """Print one JSON document; numbers that JSON has no form for become null."""
    print(json.dumps(_plain(document), indent=2, allow_nan=False))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
