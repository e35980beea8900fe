"""The page of a laboratory: one file that moves a process, without a network."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.base.errors import InputError
from clepsydra.laboratory.drawings import drawn
from clepsydra.laboratory.lessons.lesson import Lesson
from clepsydra.laboratory.packed_data import packed_data
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.html import json_text
from clepsydra.report.live.packed import packed
from clepsydra.report.page import lab_assets, rendered


def lab_text(
    rig: Rig,
    lesson: Lesson | None = None,
    *,
    answers: bool = False,
    files: Mapping[str, bytes] | None = None,
) -> str:
    """Return the page of a rig as HTML.

    Parameters
    ----------
    lesson : Lesson, optional
        That the rig is of.
    answers : bool
        Whether the page is the lecturer's.
    files : mapping
        Name to content of regulators that the page brings along.

    Raises
    ------
    InputError
        The script of the page was not built.
    """
    assets = lab_assets()
    if assets is None:
        raise InputError(
            "lab", "no script of its page", "an installation with it",
            "install Clepsydra once more with a network, or from a wheel",
        )  # fmt: skip
    hides = () if lesson is None or answers else lesson.hides
    drawings = [
        process_drawing(rig.point.process, rig.point, controller, alive=f"rig-{place}", hides=hides)
        for place, controller in enumerate(drawn(rig)[0])
    ]
    data = page_data(rig, lesson, answers=answers)
    data["laws"]["files"] = [
        {"name": name, "content": packed(content)} for name, content in (files or {}).items()
    ]
    return rendered(
        "lab.html.jinja",
        title=f"{rig.process.title} – laboratory",
        name=rig.process.title,
        lesson=lesson,
        alarms=rig.process.alarms,
        drawings=drawings,
        attached=False,
        data=json_text(packed_data(data, drawings[1:])),
        assets=assets,
    )
