"""Plants of process files that a test writes."""

from pathlib import Path

import clepsydra as cl


def plant_of(folder: Path, text: str, *edits: tuple[str, str], name: str = "plant") -> cl.Plant:
    """Load the plant of a text, in which each edit replaces something that is there."""
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return cl.load(path)
