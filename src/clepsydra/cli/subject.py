"""One controller of what a verb works on, a process or a study file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clepsydra.interface.controller import AnyController, Controller
    from clepsydra.interface.plant import Plant
    from clepsydra.interface.study import Study
    from clepsydra.interface.subject import StudyRequest


def name_of(controller: str | None) -> str | None:
    """Return the name that a controller is chosen by, of that name or the title of a table."""
    from clepsydra.interface.controller import plain_name

    return None if controller is None else plain_name(controller)


def is_regulator(name: str, request: Plant | StudyRequest | None = None) -> bool:
    """Tell whether a name is that of a MAT file, and of no controller of a study file."""
    named = {each.name for each in getattr(request, "controllers", ())}
    return name.lower().endswith(".mat") and name not in named


def regulator_of(plant: Plant, file: str, *, cold: bool) -> Controller:
    """Return the controller of a MAT file, whose numbers are in the units that people see.

    Parameters
    ----------
    cold : bool
        As a simulation program runs it, u = C x + D e from zero state: without the outputs at
        rest, and with nothing that tells its states of a limit.
    """
    from clepsydra.interface import design

    name = Path(file).stem
    if not cold:
        return design.regulator(plant, file, name=name)
    found = design.regulator(plant, file, anti_windup="none", name=name)
    return found.with_values({f"{each}.bias": 0.0 for each in found.manipulated}, name=name)


def controller_of(
    request: Plant | StudyRequest, name: str, folder: Path | None, *, quiet: bool
) -> AnyController:
    """Return the controller of a name: by its design alone where that does, else of a study."""
    from clepsydra.interface.every_design import designed

    return designed(request, name) or study_of(request, name, None, folder, quiet=quiet)[name]


def study_of(
    request: Plant | StudyRequest,
    name: str | None,
    seed: int | None,
    folder: Path | None,
    *,
    quiet: bool,
) -> Study:
    """Make the controllers of a study, or one; refuse one that does not apply, with its reason."""
    from clepsydra.base.errors import InputError
    from clepsydra.cli.output import named_options
    from clepsydra.cli.progress import shown_progress
    from clepsydra.interface.study import so_far, study

    if name is not None and is_regulator(name, request):
        raise InputError(
            "--controller", name, "the name of a controller of the study",
            f'write a study file with [controllers.mine] and regulator = "{name}", give it in the '
            "place of the process, and --controller mine",
        )  # fmt: skip
    with named_options("controller"), shown_progress(so_far, quiet=quiet) as tell:
        found = study(request, seed=seed, progress=tell, folder=folder, only=name)
    reasons = {} if name is None else dict(found.not_applicable)
    if name in reasons:
        raise InputError(
            "--controller", name, f"a controller that applies; this one does not: {reasons[name]}",
            "choose another; clepsydra study ranks those that apply",
        )  # fmt: skip
    return found
