"""Makes docs/hil.png: the nine cases of `clepsydra hil`, from the history of its rig.

The quadruple tank under PI controllers in C, by Modbus TCP in counts of a card, 20 times real time.
"""

import io
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image, PngImagePlugin

import clepsydra as cl
from clepsydra.base.history_reading import read_rows, read_runs

PICTURE = Path(__file__).parents[1] / "docs" / "hil.png"
WORDS = "The nine cases of hardware in the loop: level, pump and whether the rig hears its PLC"
SIGNALS = ["level_1", "level_1.setpoint", "pump_1.command", "pump_1.applied", "controller.heard"]


def main() -> None:
    """Go through the cases, and draw what the rig kept of them."""
    with TemporaryDirectory() as name:
        found = cl.run_hil(
            "quadruple-tank", plcs=["c"], wires=["modbus"], speed=20.0, folder=name, progress=print
        )
        trial = found.as_dict()["tried"][0]
        history = Path(name, "1-modbus", "history.sqlite")
        rows = read_rows(history, read_runs(history)[-1].number, SIGNALS, most=10_000)
    print(found.answer().parts[0].text)
    figure = Figure(figsize=(12.5, 6.4), layout="constrained")
    drawn(figure, rows.samples, dict(zip(SIGNALS, rows.values.T, strict=True)), trial["cases"])
    written(figure)


def drawn(figure: Figure, samples: Any, values: dict[str, Any], cases: list[Any]) -> None:
    """Draw level and pump above each other, with the cases behind them."""
    level, pump = figure.subplots(2, 1, sharex=True, height_ratios=[1, 1])
    level.step(samples, values["level_1"], "C0", where="post", label="level_1")
    level.step(samples, values["level_1.setpoint"], "0.2", where="post", linewidth=0.9,
               label="its setpoint")  # fmt: skip
    level.set_ylabel("level_1 [V]")
    pump.step(samples, values["pump_1.command"], "C1", where="post", linewidth=0.9,
              label="what the PLC asks for")  # fmt: skip
    pump.step(samples, values["pump_1.applied"], "C0", where="post", label="pump_1")
    silent = values["controller.heard"] == 0.0
    pump.fill_between(samples, 0.0, 10.0, where=silent, color="C3", alpha=0.25, step="post",
                      label="the rig does not hear its PLC")  # fmt: skip
    pump.set_ylabel("pump_1 [V]")
    pump.set_xlabel("sample [s of the plant]")
    titled(level, cases)
    for axes in (level, pump):
        for place, case in enumerate(cases):
            first, last = case["samples"]
            axes.axvspan(first, last, color="0.93" if place % 2 else "1.0", zorder=0)
        axes.legend(loc="upper left" if axes is pump else "upper right", fontsize="small")
        axes.spines[["top", "right"]].set_visible(False)
    level.set_xlim(cases[0]["samples"][0] - 10, cases[-1]["samples"][1])


def titled(axes: Axes, cases: list[Any]) -> None:
    """Write the case above its samples."""
    for case in cases:
        first, _ = case["samples"]
        words = case["case"].replace("-", " ").replace("stop and run", "STOP and RUN")
        axes.text(first, 1.02, words, transform=axes.get_xaxis_transform(),
                  rotation=30, fontsize="small", va="bottom")  # fmt: skip


def written(figure: Figure) -> None:
    """Write it in few colours."""
    described = PngImagePlugin.PngInfo()
    described.add_text("Description", WORDS)
    stream = io.BytesIO()
    figure.savefig(stream, dpi=110)
    with Image.open(stream) as picture:
        few = picture.convert("RGB").convert("P", palette=Image.Palette.ADAPTIVE, colors=64)
    few.save(PICTURE, pnginfo=described, optimize=True)


if __name__ == "__main__":
    main()
