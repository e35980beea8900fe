"""`cl.simulate`: a plant on its own or under a controller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import overload

from clepsydra.base.arguments import require_signal, require_type
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.events import Events, changes_of
from clepsydra.interface.plant import Plant
from clepsydra.interface.quantities import Quantity, with_unit
from clepsydra.interface.run import OpenLoopRun, Run
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shown import lifted
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.loop.loop import Loop
from clepsydra.loop.open_loop_plan import Start, plan_simulation, read_state
from clepsydra.loop.step_size import Solver, check_solver


@overload
def simulate(
    plant: Subject,
    controller: None = None,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    start: Start = "rest",
    state: Mapping[str, Quantity] | None = None,
    solver: Solver = "kernel",
) -> OpenLoopRun: ...
@overload
def simulate(
    plant: Subject,
    controller: AnyController,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    seed: int = 1,
    solver: Solver = "kernel",
) -> Run: ...
@keywords_checked()
def simulate(
    plant: Subject,
    controller: AnyController | None = None,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    start: Start = "rest",
    state: Mapping[str, Quantity] | None = None,
    seed: int = 1,
    solver: Solver = "kernel",
) -> Run | OpenLoopRun:
    """Simulate a plant, on its nonlinear equations, from rest at its operating point.

    Parameters
    ----------
    plant : Plant, str or Path
    controller : Controller, optional
        Without one the inputs stay where they rest, but for the events.
    events : sequence of Event, optional
        Of `cl.step`, `cl.ramp` and `cl.disturbance`: exactly these, without noise. Under a
        controller and without events it is the default scenario: a step up and down of each
        setpoint, the load steps of the process, and a stretch of noise.
    duration : str or float, optional
        "20 min"; a number is in s. Chosen if left out.
    start : {"rest", "empty"}
        Without a controller: at rest, or with empty tanks.
    state : mapping, optional
        Without a controller: states that start elsewhere, {"tank_1.level": "5 cm"}; a number is in
        the state's display unit.
    seed : int
        Of the noise of the default scenario.
    solver : {"kernel", "reference"}
        The compiled kernel, its step halved until the error is below 1e-6, or CVODES.

    Returns
    -------
    Run or OpenLoopRun
        With trajectories, scores and a plot.

    Raises
    ------
    InputError
        A signal or the solver is unknown, a quantity is none of it or leaves its range, the
        controller is none of this plant, or the simulation has no length.
    NoEquilibrium
        The plant does not rest anywhere.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = simulate(plant, None, [cl.step("pump_1", to="3.2 V", at="1 min")], duration="20 min")
    >>> round(100 * float(run.values["tank_1.level"][-1]), 2)  # [cm]
    13.32
    """
    plant = plant_of(plant)
    check_solver(solver)
    if controller is not None:
        own = of_plant(controller, plant)
        loop = Loop(own, plant.measured)
        changes = () if events is None else changes_of(events, plant, controlled=True)
        scenario = scenario_of(plant, events, duration, seed)
        if solver == "reference" or not own.setpoints:
            run = loop.run(scenario, solver=solver)
        else:
            run = loop.run_checked(scenario)
        return lifted(Run, run, changes=tuple(changes))
    plan = plan_simulation(
        plant.process,
        () if events is None else changes_of(events, plant, controlled=False),
        duration=None if duration is None else str(with_unit(duration, "s")),
        start=start,
        state=_states(state or {}, plant),
        rest=plant.asked_for,
    )
    return lifted(OpenLoopRun, plan.run(solver), plan=plan)


def _states(given: Mapping[str, Quantity], plant: Plant) -> dict[str, float]:
    remedy = 'write as in {"tank_1.level": "5 cm"}'
    require_type(given, Mapping, "state", "states with their values", remedy)
    own, words = plant.process.state, f"a state of {plant.process.name}"
    return {
        name: read_state(
            name,
            with_unit(value, require_signal("state", name, own, words).shown_unit),
            plant.process,
            "state",
        )
        for name, value in given.items()
    }
