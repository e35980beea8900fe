"""`cl.export`: code for the plant, printed from what was simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.files import make_folder, write_together
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.section import Line, Mark, Section, marked
from clepsydra.deploy.printing.identifiers import identifier_of as identifier_of
from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Target, targets_of
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shell import Settings, plant_shell
from clepsydra.interface.shown import Answered
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant
    from clepsydra.loop.scenario import Scenario


@dataclass(frozen=True, repr=False)
class Exported(Answered):
    """The files of an export.

    Parameters
    ----------
    files : tuple of Path
    facts : mapping
        Name and digest of the program, and what else belongs to the target.
    next_step : str
        What the engineer does with them.
    then : tuple of str
        And after that, a step each.
    said : Section
        What they are.
    """

    files: tuple[Path, ...]
    facts: Mapping[str, Any]
    next_step: str
    then: tuple[str, ...] = ()
    said: Section = field(default_factory=Section)

    def answer(self) -> Section:
        """Return what they are, what was written, a file a line, and what to do with it."""
        written = marked(Mark.FILE, (f"Written: {path}" for path in self.files))
        following = (Line(f"Next: {self.next_step}"),) if self.next_step else ()
        steps = marked(Mark.POINT, self.then)
        return replace(self.said, parts=(*self.said.parts, *written, *following, *steps))


@keywords_checked()
def export(
    controller: AnyController | None,
    plant: Subject,
    folder: str | Path = ".",
    to: str | Sequence[str] = "st",
    *,
    dialect: str | None = None,
    precision: str | None = None,
    fmi: str | None = None,
    fail_safe: Settings = None,
    sensor_delay: Settings = None,
    setpoint_rate: Settings = None,
    rate_limit: Settings = None,
    scenario: Scenario | None = None,
) -> Exported:
    """Write a controller for the plant, printed from the program that was simulated.

    Parameters
    ----------
    controller : Controller or None
        None for the process itself, which is exported as FMUs or WebAssembly.
    plant : Plant, str or Path
    folder : str or Path
        It is made where it is missing.
    to : {"st", "c", "fmu", "wasm", "tuning", "signals"}, or a list of them
        IEC 61131-3 Structured Text with a test project and PLCopen XML, C99, a functional mock-up
        unit, WebAssembly with a script that runs it, PID settings in the vendors' forms and units,
        or the list of signals. An option holds for those that have it.
    dialect : {"codesys", "matiec", "scl"}, optional
        Of Structured Text; of these options the first is taken if left out.
    precision : {"double", "single"}, optional
        Of Structured Text and C.
    fmi : {"3.0", "2.0"}, optional
        Version of the FMU.
    fail_safe : mapping, optional
        Input to its value while a sensor has failed, {"pump_1": "1 V"}; its low limit if left out.
    sensor_delay : mapping, optional
        Measurement to how long a fault of it is ridden through, {"level_1": "10 s"}; 4 s.
    setpoint_rate : mapping, optional
        Measurement to the fastest change of its setpoint, {"level_1": "0.1 V/s"}; none.
    rate_limit : mapping, optional
        Input to its fastest change, {"pump_1": "1 V/s"}; none. Of each, a number is in the display
        unit of the signal, in s, or in the display unit per s.
    scenario : Scenario, optional
        In which the vendors' forms of "tuning" are simulated; the default scenario if left out.

    Returns
    -------
    Exported

    Raises
    ------
    InputError
        The controller cannot be exported, the target is unknown or has no such option, or the
        folder cannot be written.

    Examples
    --------
    >>> import clepsydra as cl, tempfile
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = export(cl.design.simc(plant), plant, folder, to="c")
    >>> [path.name for path in written.files]
    ['quadruple_tank_pi_simc.h', 'quadruple_tank_pi_simc.c']
    """
    plant = plant_of(plant)
    settings = {
        "fail_safe": fail_safe,
        "sensor_delay": sensor_delay,
        "setpoint_rate": setpoint_rate,
        "rate_limit": rate_limit,
    }
    given = {"precision": precision, "dialect": dialect, "fmi": fmi}
    names = [to] if isinstance(to, str) else list(
        sequence_of(to, str, "export, to", "a target or a list of them", 'write as in ["st", "c"]')
    )  # fmt: skip
    if not names:
        raise InputError("export, to", "none", "at least one target", 'write as in ["st", "c"]')
    shelled, alone = any(settings.values()), controller is None
    targets = targets_of(names, given, shell=shelled, process=alone)
    shell = plant_shell(plant, **settings)
    if controller is not None:
        own = of_plant(controller, plant)
        delivery = Delivery(own, plant.point, partial(_scenario, scenario, plant), shell)
        what = f"{own.title} on {plant.process.title}"
        found = [target.controller(delivery, options) for target, options in targets]
        if plant.process.alarms:
            from clepsydra.deploy.exported_alarms import with_alarms

            found = with_alarms(found, targets, delivery)
    else:
        what = plant.process.title
        found = [_of_process(target, options, plant) for target, options in targets]
    place = Path(folder)
    make_folder(place, "export, folder")
    files = tuple(write_together(place, {n: c for each in found for n, c in each.files.items()}))
    facts: dict[str, Any] = {}
    for each in found:
        facts |= each.facts
    said = [
        each.answer or Section("", (Line(f"{what}: {target.words}.", Mark.ANSWER),))
        for each, (target, _) in zip(found, targets, strict=True)
    ]
    first, *others = found
    steps = (step for each in others for step in (_sentence(each.next_step), *each.then) if step)
    whole = said[0] if not others else Section("", tuple(part for s in said for part in s.parts))
    return Exported(files, facts, first.next_step, (*first.then, *steps), whole)


def _of_process(target: Target, options: dict[str, str], plant: Plant) -> ExportedFiles:
    if target.process is None:
        ways = (f'to="{name}"' for name, each in TARGETS.items() if each.process)
        expected = f"a controller, or {' or '.join(ways)}"
        raise InputError("export, controller", "none", expected, "give a controller")
    return target.process(plant.point, options)


def _sentence(step: str) -> str:
    return f"{step[:1].upper()}{step[1:]}"


def _scenario(given: Scenario | None, plant: Plant) -> Scenario:
    return given or scenario_of(plant)
