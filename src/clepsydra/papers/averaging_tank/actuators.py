"""Section 5's other advice: the document's controllers behind actuators and a transport delay."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

from clepsydra.controllers.controller import Controller
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.fuzzy import FILTERED, Reading, fuzzy_controller
from clepsydra.papers.averaging_tank.fuzzy_range import rest_of
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_of
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL, pi_controller
from clepsydra.papers.averaging_tank.step_run import STEPS, step_run
from clepsydra.papers.averaging_tank.symbols import VARIANTS
from clepsydra.papers.document import Found
from clepsydra.process.reader import load_process

#: The process as a file that a user could have written.
TANK = Path(__file__).with_name("actuated_tank.toml")
#: Variants of that file, and the time of each lag and of the delay, ours.
SIZES = {"hundredth": "10 ms", "tenth": "0.1 s"}
#: Of a run [s], and how near C and V are to their setpoints at its end [% of the step].
_HORIZON, _BAND = 20.0, 2.0
#: The signal of the pump asks for a share of 1 m³/s.
PUMPED = FILTERED._replace(outflow_unit="1")


def run() -> Found:
    """Return the remark on actuators and transport delays."""
    at_rest: dict[str, list[str]] = {}
    for size, words in SIZES.items():
        for name, controller, model in loops(size):
            at_rest.setdefault(name, [])
            if comes_to_rest(controller, model):
                at_rest[name].append(words)
    told = (f"{name}: {' and '.join(sizes) or 'neither'}" for name, sizes in at_rest.items())
    return (PRINTED["section 5", "actuators and transport delays"].remark("; ".join(told)),)


@cache
def actuated_model(inputs: str, size: str) -> LinearModel:
    """Return the linear model of a variant, with lags and delay of one of `SIZES`."""
    return linearise(find_equilibrium(load_process(TANK, [inputs, size])))


def loops(size: str, reading: Reading = PUMPED) -> Iterator[tuple[str, Controller, LinearModel]]:
    """Return each of the document's controllers by name, with the model of its tank."""
    for variant in VARIANTS:
        model = actuated_model(f"{variant}-constant", size)
        model = model.select(outputs=["concentration", "volume"])
        for constants in (BY_HAND[variant], OPTIMAL[variant]):
            yield f"PI, {constants.title}", pi_controller(constants, model, free=True), model
        for weights in (each for each in COLUMNS if each.constant == variant):
            yield f"LQI, {weights.title}", lqi_of(weights, model), model
    model = actuated_model("all-inputs", size)
    yield "fuzzy", fuzzy_controller(reading, operating_point_of(model)), model


def comes_to_rest(controller: Controller, model: LinearModel) -> bool:
    """Whether C and V stay near their setpoints at the end of the document's step."""
    found = step_run(controller, model, (STEPS["C"], STEPS["V"]), _HORIZON)
    return max(rest_of(found)[:2]) < _BAND
