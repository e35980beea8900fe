"""Schemes of PID loops as a study file has them, one of each kind of block."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from clepsydra.controllers.controller import Controller
from clepsydra.deploy.exportable import Exportable, exportable
from clepsydra.linear.linearise import linearise
from clepsydra.studies.file.reader import read_study

LOOP = """
[controllers.{name}.loops.{loop}]
measurement = "{measurement}"
output = "{output}"
actions = "{actions}"
action = "{action}"
gain = "{gain}"
integral_time = "{time}"
"""


def loop(name, loop, measurement, output, action, gain, time, actions="PI"):
    return LOOP.format(
        name=name, loop=loop, measurement=measurement, output=output, action=action, gain=gain,
        time=time, actions=actions,
    )  # fmt: skip


#: Name of a controller to the study that has it.
SCHEMES = {
    "cascade": 'process = "wet-well:flow-meters"'
    + loop("cascade", "level", "level", "flow.setpoint", "direct", "3 %/%", "10 min")
    + loop("cascade", "flow", "duty_flow", "duty", "reverse", "0.3 %/%", "6 s"),
    "selector": 'process = "equalisation-tank"'
    + loop("selector", "level", "level", "highest", "direct", "0.5 %/%", "10 h")
    + loop("selector", "flood", "level", "highest", "direct", "10 %/%", "30 min")
    + 'setpoint = "85 %"\n[controllers.selector.selectors.highest]\nselect = "high"\n'
    'output = "outflow"\n[controllers.selector.outputs.outflow]\nlow = "20 %"\n'
    'rate_limit = "5 %/min"',
    "split range": 'process = "equalisation-tank:relief"'
    + loop('"split range"', "level", "level", "ways", "direct", "4 %/%", "2 h")
    + '[controllers."split range".split_ranges.ways]\nparts = [\n'
    '{ output = "outflow", from = "0 %", to = "60 %", at_from = "0 %", at_to = "100 %" },\n'
    '{ output = "relief", from = "60 %", to = "100 %", at_from = "0 %", at_to = "100 %" }]',
    "ratio": 'process = "equalisation-tank:dosing"\n[controllers.ratio.ratios.share]\n'
    'measurement = "inflow_meter"\noutput = "acid_flow.setpoint"\nratio = 0.01\n'
    + loop("ratio", "acid_flow", "acid_meter", "acid", "reverse", "0.2 %/%", "30 s")
    + loop("ratio", "level", "level", "outflow", "direct", "2 %/%", "6 h"),
    "feedforward": 'process = "wet-well:flow-meters"'
    + loop("feedforward", "level", "level", "duty", "direct", "3 %/%", "10 min")
    + '[controllers.feedforward.feedforward.inflow]\nmeasurement = "inflow_meter"\n'
    'to = "level"\ngain = "1.5 %/(l/s)"\nlead = "2 s"\nlag = "10 s"',
}  # fmt: skip


@cache
def scheme(name: str) -> tuple[Controller, Exportable]:
    """Return a scheme, and what is exported of it."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "study.toml"
        path.write_text(SCHEMES[name])
        request = read_study(path)
    point = request.analysis.operating_point
    (asked,) = request.controllers
    controller = asked.make(request.analysis, linearise(point))
    return controller, exportable(controller, point)
