"""Makes docs/report.png, the first screen of the README's study, with a headless Chromium.

The verdict goes into the file as its description, where a test compares it with the program's.
"""

import subprocess
import tempfile
from pathlib import Path

from PIL import Image, PngImagePlugin

import clepsydra as cl

PICTURE = Path(__file__).parents[1] / "docs" / "report.png"
WIDTH, HEIGHT = 1400, 880


def main() -> None:
    """Run the study, photograph its report, and describe the picture."""
    result = cl.study("quadruple-tank")
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "report.html"
        result.report(page)
        subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--hide-scrollbars", "--disable-gpu",
             f"--window-size={WIDTH},{HEIGHT}", f"--screenshot={PICTURE}", page.as_uri()],
            check=True, capture_output=True, cwd=folder,
        )  # fmt: skip
    described = PngImagePlugin.PngInfo()
    described.add_text("Description", result.verdict)
    with Image.open(PICTURE) as picture:
        picture.load()
    picture.convert("P", palette=Image.Palette.ADAPTIVE).save(
        PICTURE, pnginfo=described, optimize=True
    )
    print(result.verdict)


if __name__ == "__main__":
    main()
