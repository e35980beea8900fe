"""The plants of the rig: the quadruple tank, and a farm of tanks with a thousand tags."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

#: Each tank brings four tags: its level, its volume, and whether each can be believed.
TANKS = 250


@dataclass(frozen=True)
class RigPlant:
    """A plant that is measured, and how fast it goes.

    Parameters
    ----------
    words : str
        Of it, in the table.
    plant : str or Path
    speed : float
        Times real time.
    period : float
        What a sample takes on the clock [s].
    """

    words: str
    plant: str | Path
    speed: float
    period: float


def plants(folder: Path) -> list[RigPlant]:
    """Return the plants that are measured: samples of 1 s in less, on the clock."""
    return [
        RigPlant("quadruple tank, 20 ms", "quadruple-tank", 50.0, 0.02),
        RigPlant(f"{TANKS} tanks, 500 ms", farm_file(folder), 2.0, 0.5),
    ]


def farm_file(folder: Path, tanks: int = TANKS) -> Path:
    """Write the process file of two chains of tanks, each tank with a level and a volume sensor.

    A pump fills the first tank of a chain, each drains into the next, the last into the basin.
    """
    length = tanks // 2
    heads = [1, length + 1]
    lines = [
        'name = "tank-farm"', f'title = "Farm of {tanks} tanks"', 'sampling_period = "1 s"',
        f'controlled = ["level_{heads[0]}", "level_{heads[1]}"]', "[reservoirs.basin]",
    ]  # fmt: skip
    for pump, head in enumerate(heads, 1):
        lines += [
            f"[pumps.pump_{pump}]", 'source = "basin"', f'destination = "tank_{head}"',
            'gain = "3.33 cm^3/(s V)"', 'range = ["0 V", "10 V"]', 'nominal = "3 V"',
        ]  # fmt: skip
    for tank in range(1, tanks + 1):
        below = f"tank_{tank + 1}" if tank % length else "basin"
        lines += [
            f"[tanks.tank_{tank}]", f'area = "{25 + tank % 10} cm^2"', 'height = "20 cm"',
            f"[orifices.outlet_{tank}]", f'source = "tank_{tank}"', f'destination = "{below}"',
            'area = "0.071 cm^2"',
            f"[sensors.level_{tank}]", f'tank = "tank_{tank}"',
            'gain = "0.5 V/cm"', 'range = ["0 V", "10 V"]',
            f"[sensors.volume_{tank}]", f'tank = "tank_{tank}"', 'quantity = "volume"',
            'range = ["0 l", "1 l"]',
        ]  # fmt: skip
    path = folder / "tank-farm.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
