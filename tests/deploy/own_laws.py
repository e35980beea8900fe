"""Laws as a user's file holds them."""

import tempfile
from pathlib import Path

import clepsydra as cl


def law_of(text: str) -> cl.StepLaw:
    """Load a law from the text of its file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "own.py"
        path.write_text(text, encoding="utf-8")
        return cl.load_law(path)
