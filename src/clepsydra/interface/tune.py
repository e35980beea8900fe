"""`cl.tune`: the settings of a controller found by simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_known, require_type
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController, Controller, of_plant
from clepsydra.interface.quantities import Quantity, arguments, with_unit
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.settings import setting_of, unit_of
from clepsydra.interface.shown import lifted
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.interface.tuned import Tuned, TunedController
from clepsydra.process.declared import keys_of
from clepsydra.studies.file.law_parameters import loops_of
from clepsydra.studies.file.tuning_reader import Tuning, read_tuning
from clepsydra.studies.tuning.tune import Progress, Search

if TYPE_CHECKING:
    from clepsydra.interface.events import Events
    from clepsydra.interface.plant import Plant

#: The limits of a tuning, and the keys that study files have for them.
_LIMITS = {
    "max|S|": "maximum_sensitivity",
    "overshoot": "overshoot",
    "noise": "noise_movement",
    "damping": "damping",
    "total_variation": "total_variation",
}


@keywords_checked()
def tune(
    controller: AnyController,
    plant: Subject,
    goal: str | Sequence[str] | Mapping[str, float] = "iae",
    limits: Mapping[str, Any] | None = None,
    *,
    parameters: Mapping[str, Any] | None = None,
    events: Events | None = None,
    duration: Quantity | None = None,
    draws: int | None = None,
    quantile: Quantity | None = None,
    seed: int = 1,
    state_file: str | Path | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> TunedController:
    """Change the settings of a controller until its simulated loop scores best.

    Parameters
    ----------
    controller : Controller
        Where the search starts.
    plant : Plant, str or Path
    goal : str, sequence of str or mapping
        A score of all its signals, "iae", or of one, "iae[level_1]"; of several the largest counts,
        each relative to the start. Scores with weights, {"iae": 1.0, "total_variation": 0.1}, are
        added up.
    limits : mapping, optional
        "overshoot", "10 %" of the step, and that if left out; "max|S|", 1.6, and 2 if left out;
        "noise", how far noise may throw an input about, "3 %" of its range, and 4.5 % if left out;
        "damping" of what oscillates, 0.7 if left out where a level averages, and 0 for none;
        "total_variation", {"pump_1": "300 %"} of the range or a number in the display unit.
    parameters : mapping, optional
        What may move and between which bounds, {"level_1": {"K": (1.0, 9.0)}}, in the words and
        units of `Controller.with_values`; if left out all settings of the loops, gains and times
        within a factor of ten.
    events, duration : optional
        The scenario, as for `cl.simulate`; the default scenario if left out.
    draws : int, optional
        Plants drawn from the uncertainty of the process, 64 say. The goal is then what most of
        them keep, a quantile, and no longer the score of the plant itself; every candidate meets
        the same plants. Limits stay those of the plant itself. Where a tank spills or runs dry,
        the plant is harmed or the loop does not settle, a drawn plant is worse than any score,
        unless the plant itself does so at the start: such plants may be as many as the quantile
        leaves out. A drawn plant without an admissible steady state counts for no candidate. It
        takes five to fifteen times as long.
    quantile : Quantity, optional
        The share of drawn plants that are to be at least as good, 0.95 if left out: of 64 plants
        the 61st best counts, and three may fail.
    seed : int
        Of the search, of the noise of the default scenario and of the draws.
    state_file : str or Path, optional
        Where everything computed is kept, so that the same call goes on after control-C.
    progress : callable, optional
        Takes how far the search is, after each batch.

    Returns
    -------
    TunedController

    Raises
    ------
    InputError
        A score, a limit or a bound cannot be used.
    NotApplicable
        The controller has nothing to tune, or no candidate keeps the limits.

    Examples
    --------
    For one step, in a loop that stays as robust as is customary:

    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> step = [cl.step("level_3", "1 cm", at="10 s")]
    >>> best = tune(cl.design.simc(plant), plant, events=step, duration="5 min")
    >>> round(best.tuning.objective, 2), best.tuning.maximum_sensitivity < 2.0
    (0.53, True)

    For what 95 % of 64 plants keep, each of them up to 10 % different in every parameter:

    >>> best = tune(cl.design.simc(plant), plant, events=step, duration="5 min", draws=64)
    >>> reached = best.tuning.over_draws
    >>> reached.tuned.objective <= reached.of_plant_alone.objective < reached.start.objective
    True
    """
    plant = plant_of(plant)
    start = of_plant(controller, plant)
    written: dict[str, Any] = {"objective": goal if isinstance(goal, str) else _plain(goal)}
    written |= _limits(limits or {}, plant)
    if parameters is not None:
        written["parameters"] = _bounds(parameters, start)
    written |= {} if draws is None else {"draws": draws}
    written |= {} if quantile is None else {"quantile": quantile}
    table = arguments("tuning", written, keys_of(Tuning))
    request = read_tuning(table, plant.process)
    found = request.run(
        start,
        plant.measured,
        scenario_of(plant, events, duration, seed),
        Search(seed=seed, progress=progress, state_file=state_file),
    )
    tuned = lifted(Controller, found.controller, plant=plant)
    named = replace(tuned, name=f"{start.name}, tuned")
    return lifted(TunedController, named, tuning=lifted(Tuned, found))


def _plain(goal: object) -> Any:
    require_type(
        goal, (Mapping, list, tuple), "tuning, goal", "a score, several, or scores with weights",
        'write as in "iae", ["iae[level_1]", "ise[level_2]"] or {"iae": 1.0}',
    )  # fmt: skip
    return dict(goal) if isinstance(goal, Mapping) else list(goal)  # type: ignore[call-overload]


def _limits(limits: Mapping[str, Any], plant: Plant) -> dict[str, Any]:
    require_type(
        limits, Mapping, "tuning, limits", "limits with their values",
        'write as in {"overshoot": "10 %", "max|S|": 1.6}',
    )  # fmt: skip
    found: dict[str, Any] = {}
    for name, value in limits.items():
        require_known("tuning, limits", name, _LIMITS)
        if name == "total_variation" and isinstance(value, Mapping):
            units = {signal.name: signal.shown_unit for signal in plant.process.inputs}
            value = {key: with_unit(each, units.get(key, "1")) for key, each in value.items()}
        found[_LIMITS[name]] = value
    return found


def _bounds(parameters: Mapping[str, Any], start: Controller) -> dict[str, Any]:
    """Return bounds as a study file has them: by its keys, in lists, with units."""
    place = "tuning, parameters"
    require_type(
        parameters, Mapping, place, "loops with their settings and bounds",
        'write as in {"level_1": {"K": ("1 %/%", "9 %/%")}}',
    )  # fmt: skip
    loops = loops_of(start.law)
    found: dict[str, Any] = {}
    for name, value in parameters.items():
        if name in loops and isinstance(value, Mapping):
            words = {word: setting_of(loops[name], word, f"{place}, {name}") for word in value}
            found[name] = {
                key: _pair(value[word], unit_of(start, loops[name], key))
                for word, key in words.items()
            }
        else:
            found[name] = _pair(value, "1")
    return found


def _pair(value: Any, unit: str) -> Any:
    return [with_unit(each, unit) for each in value] if isinstance(value, (tuple, list)) else value
