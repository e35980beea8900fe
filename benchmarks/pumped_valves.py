"""Batches of a tank that a pump fills: moved by its speed, or at constant speed before a valve."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import clepsydra as cl
from clepsydra.deploy.process_program import process_program
from clepsydra.engine.kernel import Kernel

PLANTS, SAMPLES, SUBSTEPS = 4096, 2_000, 4
_TANK = """
name = "filled"
sampling_period = "5 s"
controlled = ["level"]
[reservoirs.sump]
[tanks.tank]
area = "2 m^2"
height = "3 m"
[orifices.drain]
source = "tank"
destination = "sump"
area = "10 cm^2"
[sensors.level]
tank = "tank"
range = ["0 m", "3 m"]
"""
_CURVE = """
curve = [["0 m^3/h", "32 m"], ["10 m^3/h", "30 m"], ["20 m^3/h", "24 m"], ["30 m^3/h", "13 m"]]
static_head = "8.2 m"
"""
_ENDS = 'source = "sump"\ndestination = "tank"\nrange = ["0 %", "100 %"]\nnominal = "70 %"\n'
_VALVE = f"""
[valves.inlet]
{_ENDS}
kv = "25 m^3/h"
characteristic = "equal percentage"
[valves.inlet.pump]
{_CURVE}
"""
#: A pump alone, which takes a loss of its pipe.
ALONE = f'[pumps.inlet]\n{_ENDS}\npipe_loss = "1e5 s^2/m^5"\n{_CURVE}'
#: What stands before the valve, in words, and in a file.
BEFORE_A_VALVE = {
    "a pump before a valve": _VALVE,
    "a pump before a valve, with automatic recirculation": (
        f'{_VALVE}recirculation = "automatic"\nminimum_flow = "5 m^3/h"\n'
    ),
    "a pump before a valve, with an open line back": (
        f'{_VALVE}recirculation = "open line"\nrecirculation_kv = "2.5 m^3/h"\n'
    ),
}


def batch(inlet: str) -> Callable[[], object]:
    """Return what runs a batch of the tank with an inlet, ready to run again and again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "filled.toml")
        path.write_text(_TANK + inlet, encoding="utf-8")
        point = cl.load(path).point
    kernel = Kernel(process_program(point, SUBSTEPS), record=False)
    drains = np.random.default_rng(0).uniform(9e-4, 11e-4, PLANTS)
    return kernel.prepare(SAMPLES, parameters={"drain.area": drains}).run
