"""Makes the pictures of docs/robustness.md, from 1000 draws of the quadruple tank under PI, SIMC.

What the program says of them goes into each file as its description, where a test compares it
with what the program says today.
"""

import io
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image, PngImagePlugin

import clepsydra as cl
from clepsydra.report.causes_picture import causes_figure
from clepsydra.report.plant_axes import settle
from clepsydra.report.replay_picture import replay_figure

DOCS = Path(__file__).parents[1] / "docs"


def main() -> None:
    """Draw, and describe the pictures."""
    plant = cl.load("quadruple-tank")
    found = cl.robustness(cl.design.simc(plant), plant)
    said = found.answer().parts[0].text
    draw = found.worst().draw
    written(found.plot(), "robustness-fan.png", said)
    written(
        replay_figure(found.run(draw), found.run(0), f"draw {draw}"), "robustness-worst.png", said
    )
    written(causes_figure(found.sensitivity), "robustness-causes.png", said)
    print(said)


def written(figure: Figure, name: str, words: str) -> None:
    """Write a figure in few colours."""
    described = PngImagePlugin.PngInfo()
    described.add_text("Description", words)
    stream = io.BytesIO()
    settle(figure).savefig(stream, dpi=110)
    with Image.open(stream) as picture:
        few = picture.convert("RGB").convert("P", palette=Image.Palette.ADAPTIVE, colors=64)
    few.save(DOCS / name, pnginfo=described, optimize=True)


if __name__ == "__main__":
    main()
