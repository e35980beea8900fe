"""What a call of `cl.study` asks for, as a study file asks for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from clepsydra.base.arguments import require_known, require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.controllers import controller as inner
from clepsydra.interface.controller import Controller, of_plant
from clepsydra.interface.plant import Plant
from clepsydra.interface.quantities import Quantity
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.subject import Subject, plant_of, read_subject
from clepsydra.loop.same_steps import same_steps
from clepsydra.loop.step_size import substeps_for
from clepsydra.studies import result as results
from clepsydra.studies.file.case_checks import (
    check_case_name,
    check_held,
    check_same_loops,
    errors_in_case,
)
from clepsydra.studies.file.request import (
    CaseRequest,
    ControllerRequest,
    Maker,
    Settings,
    StudyRequest,
)


class AskedStudy(NamedTuple):
    """What is asked of a study, and of which plant."""

    request: StudyRequest
    plant: Plant


def asked_of(
    plant: Subject,
    controllers: object,
    events: object,
    duration: Quantity | None,
    seed: int | None,
    cases: object,
    designed_anew: Sequence[str],
) -> AskedStudy:
    """Return what is asked for; all as for `clepsydra.interface.study.study`."""
    if isinstance(plant, (str, Path)):
        plant = read_subject(plant, seed)
    if isinstance(plant, StudyRequest):
        given = {
            "controllers": controllers,
            "events": events,
            "duration": duration,
            "cases": cases,
            "designed_anew": designed_anew or None,
        }
        _check_alone(given)
        return AskedStudy(plant, Plant(plant.process))
    plant = plant_of(plant)
    substeps_for(plant.linear)  # a process that cannot be simulated is refused before all else
    seed = 1 if seed is None else seed
    request = StudyRequest(
        path=None,
        title=plant.process.title,
        process=plant.process,
        analysis=plant.analysis,
        scenario=scenario_of(plant, events, duration, seed),
        controllers=() if controllers is None else _given(controllers, plant),
        scores=(),
        seed=seed,
    )
    if cases is not None:
        found = _cases(request, plant, events, duration, cases, designed_anew)
        request = replace(request, cases=found)
    return AskedStudy(request, plant)


def _check_alone(given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value is not None:
            raise InputError(
                f"study, {name}", "given beside a study file", f"no {name}: the file names them",
                "leave them out, or give the plant instead of the file",
            )  # fmt: skip


def _given(controllers: object, plant: Plant) -> tuple[ControllerRequest, ...]:
    """Return controllers as a study file asks for them, each by a name of its own."""
    chosen = sequence_of(
        controllers, (inner.Controller, results.TriedController), "study, controllers",
        "a list of controllers", "write as in [cl.design.simc(plant)]",
    )  # fmt: skip
    if not chosen:
        raise InputError(
            "study, controllers", "none", "at least one controller",
            "leave the list out for every design that applies",
        )  # fmt: skip
    own: list[Controller] = []
    for each in chosen:
        made, number = of_plant(each, plant), 1
        name = made.name
        while name in [other.name for other in own]:
            number += 1
            name = f"{made.name}, {number}"
        own.append(made.named(name))
    return tuple(ControllerRequest(each.name, _made(each), None) for each in own)


def _made(controller: inner.Controller) -> Maker:
    """Return what makes a controller that is there already."""
    return lambda analysis, model: controller


def _cases(
    study: StudyRequest,
    plant: Plant,
    events: object,
    duration: Quantity | None,
    cases: object,
    designed_anew: Sequence[str],
) -> tuple[CaseRequest, ...]:
    """Return other operating points and variants with the steps of a study."""
    remedy = 'write as in {"low": plant.at(outputs={"level": "20 %"})}'
    require_type(cases, Mapping, "study, cases", "names with their plants", remedy)
    assert isinstance(cases, Mapping)
    for name in designed_anew:
        require_known("study, designed_anew", name, cases, "a case of this study")
    if designed_anew and study.controllers:
        raise InputError(
            "study, designed_anew", ", ".join(designed_anew)[:60],
            "no such case where controllers are given: they are designed already",
            "leave controllers out for every design that applies, or write a study file",
        )  # fmt: skip
    found = []
    for name, case in cases.items():
        place = f"study, cases, {name}"
        require_type(name, str, "study, cases", "names as text", remedy)
        require_type(case, Plant, place, "a plant", remedy)
        check_case_name(name, place)
        settings: Settings = "designed_anew" if name in designed_anew else "frozen"
        with errors_in_case(name):
            check_same_loops(study.process, case.process, settings, place)
            scenario = (
                same_steps(study.scenario, plant.point, case.point)
                if events is None and duration is None
                else scenario_of(case, events, duration, study.seed)
            )
            check_held(case.analysis, scenario, place)
        own = replace(study, process=case.process, analysis=case.analysis, scenario=scenario)
        found.append(CaseRequest(name, settings, own, case.asked))
    return tuple(found)
