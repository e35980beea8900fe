"""`cl.simulate`: a plant on its own or under a controller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, overload

from clepsydra.base.arguments import require_signal, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.begin import AnyStart, begin_of, known_start
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.events import Events, changes_of
from clepsydra.interface.quantities import Quantity, with_unit
from clepsydra.interface.run import OpenLoopRun, Run
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shown import lifted
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.begin import ControllerStart, check_point
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_state import LoopState
from clepsydra.loop.open_loop_plan import Start, plan_simulation, read_state
from clepsydra.loop.step_size import Solver, check_solver
from clepsydra.loop.with_noise import with_noise

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant
    from clepsydra.loop.scenario import Scenario


@overload
def simulate(
    plant: Subject,
    controller: None = None,
    events: Events | None = None,
    *,
    duration: Quantity | None = None,
    start: Start | Plant = "rest",
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
    start: AnyStart = "rest",
    state: Mapping[str, Quantity] | None = None,
    controller_start: ControllerStart | None = None,
    noise: bool = False,
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
    start: AnyStart = "rest",
    state: Mapping[str, Quantity] | None = None,
    controller_start: ControllerStart | None = None,
    noise: bool = False,
    seed: int = 1,
    solver: Solver = "kernel",
) -> Run | OpenLoopRun:
    """Simulate a plant, on its nonlinear equations, from rest or from anywhere else.

    Parameters
    ----------
    plant : Plant, str or Path
    controller : Controller, optional
        Without one the inputs stay where they rest, but for the events.
    events : sequence of Event, optional
        Of `cl.step`, `cl.ramp` and `cl.disturbance`: exactly these. Under a controller and without
        events it is the default scenario from rest: a step up and down of each setpoint, the load
        steps of the process, and a stretch of noise; from elsewhere it is the way to the setpoints.
    duration : str or float, optional
        "20 min"; a number is in s. Chosen if left out.
    start : {"rest", "empty"}, Plant or LoopState
        At rest; with empty tanks; at another operating point, `plant.at(outputs=...)`; or, under a
        controller, where another run of it ended, `run.final_state`. Setpoints and loads stand
        where the plant rests until they step.
    state : mapping, optional
        States that start elsewhere, {"tank_1.level": "5 cm"}; a number is in the state's display
        unit. Under a controller inputs too, "pump_1": what stands there when it starts, and states
        of the controller, "controller.level_1.integral".
    controller_start : {"bumpless", "cold"}, optional
        Away from rest: without a bump, its states such that its outputs stand where the inputs do,
        as after a time in manual; or cold, its states as its law declares them, integrals at zero.
        Bumpless if left out, and after a run of the same controller as it was.
    noise : bool
        Under a controller, whether the whole run has the noise that the process file gives of
        sensors, pumps and flows. The default scenario has its own.
    seed : int
        Of the noise.
    solver : {"kernel", "reference"}
        The compiled kernel, its step halved until the error is below 1e-6, or CVODES.

    Returns
    -------
    Run or OpenLoopRun
        With trajectories, scores and a plot.

    Raises
    ------
    InputError
        A signal, a state, a start or the solver is unknown, a quantity is none of it or leaves its
        range, the controller is none of this plant, the simulation has no length, or there is no
        noise where it is asked for.
    NoEquilibrium
        The plant does not rest anywhere.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = simulate(plant, None, [cl.step("pump_1", to="3.2 V", at="1 min")], duration="20 min")
    >>> round(100 * float(run.values["tank_1.level"][-1]), 2)  # [cm]
    13.32
    >>> filled = simulate(plant, cl.design.simc(plant), start="empty", controller_start="cold")
    >>> float(filled.values["level_1"][0]), round(float(filled.values["level_1"][-1]), 2)  # [V]
    (0.0, 6.13)
    """
    plant = plant_of(plant)
    check_solver(solver)
    if controller is not None:
        own = of_plant(controller, plant)
        loop = Loop(own, plant.measured)
        changes = () if events is None else changes_of(events, plant, controlled=True)
        begin = begin_of(plant, own, start, state or {}, controller_start)
        scenario = scenario_of(plant, events, duration, seed, begin)
        if noise:
            scenario = _noisy(scenario, plant)
        if solver == "reference" or not own.setpoints:
            run = loop.run(scenario, solver=solver)
        else:
            run = loop.run_checked(scenario)
        return lifted(Run, run, changes=tuple(changes))
    needed = (
        ("controller_start", controller_start, "a controller that starts"),
        ("noise", noise or None, "a controller that meets it"),
    )
    for what, given, expected in needed:
        if given is not None:
            raise InputError(what, given, expected, "give one, or leave it out")
    begins = known_start(start)
    if isinstance(begins, LoopState):
        raise InputError(
            "start", "the final_state of a run", "a controller that goes on from there",
            'give one, or write as in state={"tank_1.level": "5 cm"}',
        )  # fmt: skip
    point = plant.asked_for
    if isinstance(begins, OperatingPoint):
        check_point(plant.process, begins)
        point, begins = begins, "rest"
    plan = plan_simulation(
        plant.process,
        () if events is None else changes_of(events, plant, controlled=False),
        duration=None if duration is None else str(with_unit(duration, "s")),
        start=begins,
        state=_states(state or {}, plant),
        rest=point,
    )
    return lifted(OpenLoopRun, plan.run(solver), plan=plan)


def _noisy(scenario: Scenario, plant: Plant) -> Scenario:
    """Return a scenario with the noise of the process file, and no other."""
    if scenario.noises:
        raise InputError(
            "noise", True, "no noise beside the default scenario, which has its own",
            "give events or a start, or leave it out",
        )  # fmt: skip
    if not plant.process.noise:
        raise InputError(
            "noise", True, f"a process whose file gives a noise; that of {plant.name} gives none",
            'give one to a sensor or a pump, as in noise = "0.5 %"',
        )  # fmt: skip
    return with_noise(scenario, plant.process, usual=False)


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
