"""The controllers whose exported code is measured: one of each law that a study can hold."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import WiredFuzzy, load_fuzzy
from clepsydra.deploy.exportable import Exportable, exportable
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.papers.averaging_tank.fuzzy import RULES
from clepsydra.process.document import parse
from clepsydra.process.reader import load_process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.designs import DESIGNS
from clepsydra.studies.file.controller_reader import read_controllers

#: Schemes of a study file, by the name of their controller.
_SCHEMES = """
[controllers."Cascade with feedforward".loops.level]
measurement = "level"
output = "flow.setpoint"
actions = "PI"
action = "direct"
gain = "3 %/%"
integral_time = "10 min"
[controllers."Cascade with feedforward".loops.flow]
measurement = "duty_flow"
output = "duty"
actions = "PI"
action = "reverse"
gain = "0.3 %/%"
integral_time = "6 s"
[controllers."Cascade with feedforward".feedforward.inflow]
measurement = "inflow_meter"
to = "level"
gain = 1.0
lead = "2 s"
lag = "10 s"
""", """
[controllers."Override by selector".loops.level]
measurement = "level"
output = "highest"
actions = "PI"
action = "direct"
gain = "0.5 %/%"
integral_time = "10 h"
[controllers."Override by selector".loops.flood]
measurement = "level"
setpoint = "85 %"
output = "highest"
actions = "PI"
action = "direct"
gain = "10 %/%"
integral_time = "30 min"
[controllers."Override by selector".selectors.highest]
select = "high"
output = "outflow"
[controllers."Override by selector".outputs.outflow]
rate_limit = "5 %/min"
""", """
[controllers."Split range".loops.level]
measurement = "level"
output = "ways"
actions = "PI"
action = "direct"
gain = "4 %/%"
integral_time = "2 h"
[controllers."Split range".split_ranges.ways]
parts = [
  { output = "outflow", from = "0 %", to = "60 %", at_from = "0 %", at_to = "100 %" },
  { output = "relief", from = "60 %", to = "100 %", at_from = "0 %", at_to = "100 %" },
]
""", """
[controllers."Ratio and level".ratios.acid_ratio]
measurement = "inflow_meter"
output = "acid_flow.setpoint"
ratio = 0.01
[controllers."Ratio and level".loops.acid_flow]
measurement = "acid_meter"
output = "acid"
actions = "PI"
action = "reverse"
gain = "0.2 %/%"
integral_time = "30 s"
[controllers."Ratio and level".loops.level]
measurement = "level"
output = "outflow"
actions = "PI"
action = "direct"
gain = "2 %/%"
integral_time = "6 h"
"""  # fmt: skip
_WRITTEN_OUT = dict(
    zip(
        ("Cascade with feedforward", "Override by selector", "Split range", "Ratio and level"),
        _SCHEMES,
        strict=True,
    )
)
_OF_A_FUZZY_FILE = "Fuzzy, 27 rules to three outputs"

#: Each controller, and the process that it is measured on.
FAMILIES: dict[str, str] = {
    "PI, arrest time": "equalisation-tank",
    "PI, SIMC": "quadruple-tank",
    "PI, SIMC, static decoupling": "quadruple-tank",
    "PI, SIMC, dynamic decoupling": "quadruple-tank",
    "PI, variable structure": "quadruple-tank",
    "PI, gain scheduling": "three-tanks",
    "PID, phase margin": "quadruple-tank",
    "Cascade with feedforward": "wet-well:flow-meters",
    "Override by selector": "equalisation-tank",
    "Split range": "equalisation-tank:relief",
    "Ratio and level": "equalisation-tank:dosing",
    "Start/stop levels": "wet-well:start-stop",
    "LQR with precompensator": "quadruple-tank",
    "LQI, Bryson": "quadruple-tank",
    "LQI with Kalman filter": "quadruple-tank",
    "LQI with extended Kalman filter": "quadruple-tank",
    "LQI, gain scheduling": "quadruple-tank",
    "LQI, recomputed": "quadruple-tank",
    "2DOF polynomial, LQ": "quadruple-tank",
    "Smith predictor, LQ": "eight-tanks",
    "Smith predictor, PI": "eight-tanks",
    "Feedback linearisation": "quadruple-tank",
    "One-step inverse": "quadruple-tank",
    "MPC": "quadruple-tank",
    "Glover-McFarlane on PI, SIMC": "quadruple-tank",
    "Fuzzy PI": "quadruple-tank",
    _OF_A_FUZZY_FILE: "averaging-tank:all-inputs",
}

#: Lines of Structured Text of those of `FAMILIES` that were there before November 2026, as one
#: list of operations.
LINES_BEFORE: dict[str, int] = {
    "PI, arrest time": 900,
    "PI, SIMC": 1668,
    "PI, SIMC, static decoupling": 1760,
    "PI, SIMC, dynamic decoupling": 1804,
    "PI, variable structure": 1710,
    "PI, gain scheduling": 1030,
    "PID, phase margin": 1812,
    "Cascade with feedforward": 1390,
    "Override by selector": 1071,
    "Split range": 1544,
    "Ratio and level": 1727,
    "Start/stop levels": 1292,
    "LQR with precompensator": 1802,
    "LQI, Bryson": 1770,
    "LQI with Kalman filter": 1686,
    "LQI with extended Kalman filter": 3063,
    "LQI, gain scheduling": 2556,
    "LQI, recomputed": 3828,
    "2DOF polynomial, LQ": 1472,
    "Smith predictor, LQ": 924,
    "Smith predictor, PI": 901,
    "Feedback linearisation": 2063,
    "Glover-McFarlane on PI, SIMC": 1833,
    "Fuzzy PI": 2952,
    "Fuzzy, 27 rules to three outputs": 3416,
}


@dataclass(frozen=True)
class AtWork:
    """A controller ready for export, and what its inputs are at work.

    Parameters
    ----------
    name, process : str
        As in `FAMILIES`.
    ready : Exportable
    inputs : dict
        Input of the program to its values [scans].
    """

    name: str
    process: str
    ready: Exportable
    inputs: dict[str, np.ndarray]


@cache
def _analysed(process: str) -> Analysis:
    return analyse(load_process(process))


def ready_for_export(name: str) -> Exportable:
    """Return a controller of `FAMILIES` in its plant shell."""
    analysis = _analysed(FAMILIES[name])
    return exportable(_controller(name, analysis), analysis.operating_point)


def _controller(name: str, analysis: Analysis) -> Controller:
    point = analysis.operating_point
    if name == _OF_A_FUZZY_FILE:
        return WiredFuzzy(load_fuzzy(RULES), point.process).controller(point, name)
    if name in _WRITTEN_OUT:
        table = TableReader(parse(_WRITTEN_OUT[name].encode(), f"{name}.toml"), (), None)
        (request,) = read_controllers(table, point.process, Path())
        return request.make(analysis, analysis.model)
    return DESIGNS[name](analysis)


def at_work(name: str, scans: int) -> AtWork:
    """Return a controller and the inputs that it gets from its process.

    They are those of the last so many samples of the scenario that a study runs by itself: steps
    of setpoints and loads, then noise. A shorter scenario is repeated.
    """
    ready, model = ready_for_export(name), _analysed(FAMILIES[name]).model
    loop, controller = Loop(ready.controller, model), ready.controller
    found = loop.run(default_scenario(model)).values
    at_rest, wires = loop.at_rest(), controller.input_wires
    inputs = {}
    for signal in ready.program.inputs:
        if signal.name == "time_step":
            value = np.full(1, loop.process.sampling_period)
        else:
            wire = wires[signal.name]
            value = found[wire] if wire in found else np.full(1, at_rest[wire])
        inputs[signal.name] = np.resize(value[-scans:], scans)
    return AtWork(name, FAMILIES[name], ready, inputs)
