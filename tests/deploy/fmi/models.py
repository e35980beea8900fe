"""Controllers and processes that the tests of FMUs are about."""

from dataclasses import replace

import numpy as np
from plants import designed, plant

from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.process import process_model
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.reader import load_process
from clepsydra.program.program import Program

FRICTIONS = ('backlash = "6 %"', 'stiction = "5 %"\nslip_jump = "3 %"')
#: A process with everything that a model for model exchange can have.
RIG = """
name = "rig"
title = "A rig with every switch"
gravity = "9.81 m/s^2"
sampling_period = "1 s"
controlled = ["level"]
[components.salt]
range = ["0 kg/m^3", "50 kg/m^3"]
[reservoirs.basin]
concentration = {{ salt = "10 kg/m^3" }}
[tanks.upper]
area = "300 cm^2"
height = "50 cm"
weir = "20 cm"
[tanks.lower]
area = "600 cm^2"
height = "60 cm"
weir = "30 cm"
{delay}
[pumps.feed]
source = "basin"
destination = "upper"
gain = "100 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "4 V"
lag = "1.5 s"
trip_above = {{ lower = "55 cm" }}
hysteresis = "4 cm"
[pumps.sump]
source = "lower"
destination = "basin"
gain = "150 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "5 V"
lag = "1 s"
start_above = {{ lower = "40 cm" }}
stop_below = {{ lower = "12 cm" }}
running = false
[flows.taken]
source = "upper"
range = ["0 l/s", "2 l/s"]
nominal = "0 l/s"
[valves.throttle]
source = "upper"
destination = "{destination}"
kv = "9 m^3/h"
characteristic = "linear"
range = ["0 %", "100 %"]
nominal = "60 %"
stroke_time = "60 s"
{friction}
[sensors.level]
tank = "lower"
range = ["0 cm", "60 cm"]
"""
_START = {
    "upper.level": 0.2, "upper.salt": 0.0, "lower.level": 0.35, "lower.salt": 40.0,
    "feed.actual": 4.0, "sump.actual": 0.0, "throttle.position": 0.6,
}  # fmt: skip


def rig(folder, friction: str = "", delay: bool = False) -> OperatingPoint:
    """The rig, away from rest."""
    path = folder / "rig.toml"
    channel = '[delays.channel]\ndestination = "lower"\ntime = "7.5 s"' if delay else ""
    path.write_text(
        RIG.format(friction=friction, delay=channel, destination="channel" if delay else "lower")
    )
    process = load_process(path)
    x = np.array([_START[signal.name] for signal in process.state])
    u = np.array([signal.initial for signal in process.inputs])
    d = np.array([signal.initial for signal in process.disturbances])
    y = np.array(process.measure(x, process.parameter_values)).ravel()
    return OperatingPoint(process, x, u, d, y, residual=np.inf)


def drawn(program: Program, scans: int, seed: int, period: float, broken: bool = True):
    """Random inputs, without tuned parameters."""
    found = random_scans(program, scans, seed, period, broken=broken)
    return {signal.name: found[signal.name] for signal in program.inputs}


def origin(process: str, period: float) -> Origin:
    return Origin("the subject", process, "a design.", period)


def pi_program() -> Program:
    return replace(designed("simc", "quadruple-tank").program(), name="quadruple_tank_pi")


def lqi_program() -> Program:
    return replace(designed("lqi_kalman", "three-tanks").program(), name="three_tanks_lqi")


def pi_model() -> FmuModel:
    return controller_model(pi_program(), origin("quadruple-tank", 1.0))


def process_of(name: str) -> FmuModel:
    tanks = plant(name)
    period = tanks.process.sampling_period
    return process_model(tanks.point, substeps_for(tanks.linear), origin(name, period))


def exchange_of(name: str) -> FmuModel:
    point = plant(name).point
    return exchange_model(point, origin(name, point.process.sampling_period))
