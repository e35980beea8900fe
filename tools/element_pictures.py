"""``python tools/element_pictures.py``: draw the pictures of docs/elements from what its pages say.

A picture NAME.svg is the process of NAME.toml on the page, as `clepsydra draw` has it. With a
comment before it, `<!-- drawn: level_1, level_1.high / pump_1 -->`, it is these signals and alarms
of the run that the examples of the page make, panels one below the other. A symbol that
docs/process-files.md shows is cut out of the drawing of the first process on its page.

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

from pages import ROOT, blocks, examples
from run_picture import run_picture

import clepsydra as cl
from clepsydra.report.drawing.bodies import NAME, PITCH
from clepsydra.report.drawing.parts import draw_fitting, draw_instrument
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import width
from clepsydra.report.drawing.vessels import draw_vessel

GALLERY = ROOT / "docs" / "process-files.md"
FOLDER = ROOT / "docs" / "elements"
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in FOLDER.glob("*.md"))
_PICTURE = re.compile(r"^(?:<!-- drawn: (.+?) -->\n)?!\[.+?\]\((\S+?)\.svg\)$", re.MULTILINE)
#: Room around a symbol and its words, and the least size of its picture [px].
_MARGIN, _LEAST = 10.0, (150.0, 80.0)
_WORDS = re.compile(r'<text x="(\S+)" y="(\S+)" text-anchor="(\w+)"[^>]*>(.*?)</text>')


def run_examples(page: str, folder: Path) -> dict[str, Any]:
    """Run the examples of a page in a folder; return the names that they leave."""
    names: dict[str, Any] = {}
    with contextlib.chdir(folder):
        for block in blocks(page, "toml", "pycon"):
            if block.file:
                Path(block.file).write_text(block.text, encoding="utf-8")
            elif block.language == "pycon":
                examples(block, names)
    return names


def pictures(page: str) -> dict[str, str]:
    """Return every picture of a page by the path of its file in docs/elements."""
    text = (ROOT / page).read_text(encoding="utf-8")
    files = [block for block in blocks(page, "toml") if block.file]
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        names = run_examples(page, Path(folder))
        plants = {block.file: cl.load(Path(folder, block.file)) for block in files}
        for drawn, name in _PICTURE.findall(text):
            if drawn:
                found[f"{name}.svg"] = run_picture(names["run"], drawn)
            elif f"{name}.toml" in plants:
                plant = plants[f"{name}.toml"]
                found[f"{name}.svg"] = _sized(process_drawing(plant.process, plant.point))
    symbol = f"symbols/{Path(page).stem}.svg"
    if symbol in GALLERY.read_text(encoding="utf-8"):
        table = re.search(r"^`\[(\w+)\.NAME", text, re.MULTILINE)[1]
        shown = next(iter(files[0].table["tanks" if table == "components" else table]))
        found[symbol] = _symbol(plants[files[0].file], shown)
    return found


def _sized(svg: str) -> str:
    """Return a drawing as a file, with a size of its own."""
    ((width, height),) = re.findall(r'viewBox="0 0 (\S+) (\S+)"', svg)
    return svg.replace("<svg ", f'<svg width="{width}" height="{height}" ', 1) + "\n"


def _symbol(plant: cl.Plant, name: str) -> str:
    """Return an element with its words, cut out of the drawing of its process."""
    scene = Scene(plant.process, plant.point, None)
    svg = process_drawing(plant.process, plant.point)
    own, rectangles = _part(scene, svg, name)
    parts = svg.removesuffix("</svg>").split("\n")
    others = [re.sub("<text.*?</text>", "", part) for part in parts]
    kept = "\n".join(p if p in own else other for p, other in zip(parts, others, strict=True))
    rectangles += [_room(*words) for line in own for words in _WORDS.findall(line)]
    lefts, tops, rights, bottoms = zip(*rectangles, strict=True)
    middles, sizes = zip(
        *(
            ((min(lows) + max(highs)) / 2, max(max(highs) - min(lows) + 2 * _MARGIN, least))
            for lows, highs, least in ((lefts, rights, _LEAST[0]), (tops, bottoms, _LEAST[1]))
        ),
        strict=True,
    )
    corner = [middle - size / 2 for middle, size in zip(middles, sizes, strict=True)]
    cut = 'width="{2:.0f}" height="{3:.0f}" viewBox="{0:.0f} {1:.0f} {2:.0f} {3:.0f}"'
    return re.sub(r'viewBox="0 0 \S+ \S+"', cut.format(*corner, *sizes), f"{kept}</svg>\n", count=1)


def _part(scene: Scene, svg: str, name: str) -> tuple[list[str], list[tuple[float, ...]]]:
    """Return the lines of an element in a drawing, and the rectangles that it fills [px]."""
    body = scene.routes.placement.bodies.get(name)
    if body is None:  # a reservoir, which stands under what uses it
        line = next(line for line in svg.split("\n") if f">reservoir {name}</title>" in line)
        ends = re.search('x="(.+?)" y="(.+?)" width="(.+?)" height="(.+?)"', line)
        x, y, wide, high = map(float, ends.groups())
        return [line], [(x, y - PITCH, x + wide, y + high)]
    (half, tall), x, y = body.half, PITCH * body.x, PITCH * body.y
    rectangles = [(x - half, y - tall, x + half, y + tall)]
    instrument = next((each for each in scene.graph.instruments if each.name == name), None)
    if instrument is not None:
        return draw_instrument(scene, instrument), rectangles
    if name in scene.outlines:
        return draw_vessel(scene, name), [tuple(PITCH * end for end in body.areas[0])]
    return draw_fitting(scene, body), rectangles


def _room(x: str, y: str, anchor: str, words: str) -> tuple[float, ...]:
    """Return left, top, right and bottom of words in a drawing [px]."""
    wide = width(words, NAME, bold=True)
    left = float(x) - wide * {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
    return left, float(y) - NAME, left + wide, float(y)


def main() -> None:
    """Write the pictures anew."""
    found = {name: svg for page in PAGES for name, svg in pictures(page).items()}
    for old in FOLDER.rglob("*.svg"):
        old.unlink()
    for name, svg in found.items():
        (FOLDER / name).write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
