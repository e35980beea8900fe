"""A lesson as the page of a laboratory carries it, as values for JSON."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from clepsydra.base.units import unit_text
from clepsydra.controllers.wiring import controller_name
from clepsydra.laboratory.lessons.bands import Band
from clepsydra.laboratory.lessons.figure import Figure
from clepsydra.laboratory.lessons.lesson import Lesson
from clepsydra.laboratory.lessons.reach import Reach
from clepsydra.laboratory.lessons.task import Task
from clepsydra.process.process import Process


def lesson_data(lesson: Lesson, *, answers: bool = False) -> dict[str, Any]:
    """Return what the page needs of a lesson.

    Parameters
    ----------
    answers : bool
        Whether it is the lecturer's page, which shows right numbers and solutions. The reader's
        page has the right numbers too, with which it judges those that are typed.

    Examples
    --------
    >>> from clepsydra.laboratory.lessons.lesson import read_lesson
    >>> data = lesson_data(read_lesson("wind-up"))
    >>> [task["title"] for task in data["tasks"]][0], data["tasks"][0]["solution"]
    ('A small step', [])
    """
    return {
        "name": lesson.name,
        "title": lesson.title,
        "text": list(lesson.text),
        "variant": lesson.variant,
        "answers": answers,
        "hides": [] if answers else list(lesson.hides),
        "tasks": [_task(task, lesson.ways[task.setup][1], answers) for task in lesson.tasks],
    }


def _task(task: Task, process: Process, answers: bool) -> dict[str, Any]:
    return {
        "title": task.title,
        "text": list(task.text),
        "setup": task.setup,
        "start": task.start,
        "controller": task.controller,
        "controllerStart": task.controller_start,
        "settings": {controller_name(name): x for name, x in task.settings.items()},
        "setpoints": task.setpoints,
        "manual": task.manual,
        "noise": task.noise,
        "reach": [_reach(each, process.sampling_period) for each in task.reach],
        "figures": [_figure(each, process) for each in task.figures],
        "hints": list(task.hints),
        "solution": list(task.solution) if answers else [],
    }


def _reach(reach: Reach, period: float) -> dict[str, Any]:
    return {
        "words": reach.words,
        "bands": {name: _band(band) for name, band in reach.bands.items()},
        "controller": reach.controller,
        "samples": max(1, math.ceil(reach.hold / period)),
    }


def _band(band: Band) -> list[float | None]:
    return [end if math.isfinite(end) else None for end in band]


def _figure(figure: Figure, process: Process) -> dict[str, Any]:
    answer = figure.answer
    return {
        "words": figure.words,
        "symbol": figure.symbol,
        "unit": unit_text(figure.unit),
        "factor": figure.of_measured(process),
        "answer": None if answer is None else figure.shown(answer.value, answer.unit),
        "tolerance": figure.tolerance,
        "measure": None if figure.measure is None else asdict(figure.measure),
    }
