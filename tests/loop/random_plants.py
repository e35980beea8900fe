"""Plants drawn at random, with the corners that real ones have."""

import numpy as np


class _Draw:
    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def between(self, low: float, high: float) -> float:
        """Return a number whose logarithm is uniform."""
        return float(np.exp(self.random.uniform(np.log(low), np.log(high))))

    def even(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def chance(self, share: float) -> bool:
        return bool(self.random.random() < share)


def random_plant(seed: int) -> str:
    """Return the file of a plant of one to five tanks, filled by pumps and emptied by holes.

    Weirs, outlets above the floor, evaporation, rate limits, curves with points, trips and tanks
    of any shape give its equations corners. Time constants are 10 to 300 sampling periods.
    """
    draw = _Draw(seed)
    count, period = int(draw.random.integers(1, 6)), draw.between(0.2, 10.0)
    coupled = draw.chance(0.35)
    common = draw.between(0.2, 1.0)
    heights = [common if coupled else draw.between(0.1, 2.0) for _ in range(count)]
    lines = [
        f'name = "plant-{seed}"', f'sampling_period = "{period:.4g} s"',
        'controlled = ["level"]', "[reservoirs.basin]", "[sensors.level]", 'tank = "tank_1"',
        f'range = ["0 m", "{heights[0]:.4g} m"]',
    ]  # fmt: skip
    for number, height in enumerate(heights, 1):
        area, last = draw.between(1e-3, 0.3), number == count
        lines += _tank(draw, number, height, area)
        # Torricelli's outflow at the rim empties the tank in so many sampling periods.
        rim = np.sqrt(2.0 * 9.81 * height)
        hole = area * height / (rim * draw.between(10.0, 300.0) * period)
        lines += _holes(draw, number, height, hole, last, coupled)
        if number == 1 or draw.chance(0.3):
            lines += _pump(draw, number, height, hole * rim, period)
    return "\n".join(lines) + "\n"


def _tank(draw: _Draw, number: int, height: float, area: float) -> list[str]:
    across = np.sqrt(4.0 * area / np.pi)
    shapes = [
        [f'area = "{area:.4g} m^2"', f'height = "{height:.4g} m"'],
        ['shape = "cone"', f'floor_diameter = "{0.4 * across:.4g} m"',
         f'rim_diameter = "{1.3 * across:.4g} m"', f'height = "{height:.4g} m"'],
        ['shape = "horizontal cylinder"', f'diameter = "{height:.4g} m"',
         f'length = "{area / height:.4g} m"'],
        ['shape = "table"',
         f'table = [["0 m", "{area:.4g} m^2"], ["{0.4 * height:.4g} m", "{1.5 * area:.4g} m^2"], '
         f'["{height:.4g} m", "{0.8 * area:.4g} m^2"]]'],
    ]  # fmt: skip
    kind = int(draw.random.choice(4, p=[0.7, 0.1, 0.1, 0.1]))
    lines = [f"[tanks.tank_{number}]", *shapes[kind]]
    if kind or draw.chance(0.4):
        lines.append(f'weir = "{draw.between(0.05, 0.5):.3g} m"')
    if draw.chance(0.15):
        lines.append(f'evaporation = "{draw.between(0.2, 5.0):.3g} mm/h"')
    return lines


def _holes(
    draw: _Draw, number: int, height: float, hole: float, last: bool, coupled: bool
) -> list[str]:
    lines = [
        f"[orifices.outlet_{number}]", f'source = "tank_{number}"',
        f'destination = "{"basin" if last else f"tank_{number + 1}"}"',
        f'area = "{1e4 * hole:.5g} cm^2"',
    ]  # fmt: skip
    if coupled and not last:
        lines.append("submerged = true")
    elif draw.chance(0.3):
        lines.append(f'elevation = "{draw.even(0.05, 0.5) * height:.3g} m"')
    if draw.chance(0.25):
        lines += [
            f"[orifices.drain_{number}]", f'source = "tank_{number}"', 'destination = "basin"',
            f'area = "{1e4 * hole * draw.even(0.1, 0.6):.5g} cm^2"',
            f'elevation = "{draw.even(0.1, 0.8) * height:.3g} m"',
        ]  # fmt: skip
    return lines


def _pump(draw: _Draw, number: int, height: float, rim_flow: float, period: float) -> list[str]:
    flow = rim_flow * draw.even(0.7, 1.6)
    lines = [
        f"[pumps.pump_{number}]", 'source = "basin"', f'destination = "tank_{number}"',
        'range = ["0 %", "100 %"]', 'nominal = "50 %"',
    ]  # fmt: skip
    if draw.chance(0.3):
        head = draw.even(2.0, 5.0) * height
        lines += [
            f'curve = [["0 l/s", "{head:.4g} m"], ["{5e2 * flow:.5g} l/s", "{0.8 * head:.4g} m"], '
            f'["{1e3 * flow:.5g} l/s", "{0.4 * head:.4g} m"]]',
            f'static_head = "{0.15 * head:.4g} m"',
        ]
    else:
        lines.append(f'gain = "{10.0 * flow:.5g} l/(s %)"')
    rate = draw.chance(0.4)
    if rate:
        lines.append(f'rate = "{100.0 / (period * draw.between(2.0, 40.0)):.4g} %/s"')
    if rate or draw.chance(0.5):
        lines.append(f'lag = "{period * draw.between(2.0, 20.0):.4g} s"')
    if draw.chance(0.3):
        lines += [
            f'trip_above = {{ tank_{number} = "{0.9 * height:.4g} m" }}',
            f'hysteresis = "{0.1 * height:.3g} m"',
        ]
    return lines
