"""``python tools/run_page_pictures.py``: draw the pictures of docs/papers/runs.md from its runs.

Before a picture a comment, `<!-- drawn: NAME: level_1, level_2 / pump_1 -->`, names the run that
the Python of the page makes and its signals, panels one below the other.

A test holds that the pictures are those of the code.
"""

from __future__ import annotations

import contextlib
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from pages import ROOT, blocks
from run_picture import run_picture

PAGE = "docs/papers/runs.md"
FOLDER = ROOT / "docs" / "papers"
#: So many points a curve has at most: a pour lasts for a second of forty minutes.
POINTS = 800
_DRAWN = re.compile(r"^<!-- drawn: (\w+): (.+?) -->\n!\[.+?\]\((\S+?)\)$", re.MULTILINE)


def made_runs(folder: Path) -> dict[str, Any]:
    """Make in a folder what the page's Python and the files that it begins with make."""
    names: dict[str, Any] = {}
    with contextlib.chdir(folder):
        for block in blocks(PAGE, "sh", "python"):
            if block.language == "python" or block.text.startswith("clepsydra new"):
                block.run(folder, names)
    return {**names["runs"], **names["filled"]}


def pictures(runs: dict[str, Any]) -> dict[str, str]:
    """Return every picture of the page by the name of its file."""
    text = (ROOT / PAGE).read_text(encoding="utf-8")
    return {
        file: run_picture(runs[name], drawn, points=POINTS)
        for name, drawn, file in _DRAWN.findall(text)
    }


def main() -> None:
    """Write the pictures anew."""
    with tempfile.TemporaryDirectory() as folder:
        found = pictures(made_runs(Path(folder)))
    for old in FOLDER.glob("runs-*.svg"):
        old.unlink()
    for name, svg in found.items():
        (FOLDER / name).write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
