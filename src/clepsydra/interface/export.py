"""`cl.export`: code for the plant, printed from what was simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from clepsydra.base.errors import InputError
from clepsydra.base.files import write_together
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers import controller as inner
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.deploy import export as exports
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.fmi.write import FmiVersion
from clepsydra.deploy.printing.identifiers import identifier_of as identifier_of
from clepsydra.deploy.printing.precision import Precision
from clepsydra.interface.controller import of_plant
from clepsydra.interface.plant import Plant
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shell import Settings, plant_shell
from clepsydra.interface.shown import Shown
from clepsydra.loop.scenario import Scenario

if TYPE_CHECKING:
    from rich.console import RenderableType

Target = Literal["st", "c", "fmu", "tuning"]
Dialect = Literal["codesys", "matiec", "scl"]


@dataclass(frozen=True, repr=False)
class Exported(Shown):
    """The files of an export.

    Parameters
    ----------
    files : tuple of Path
    facts : mapping
        Name and digest of the program, and what else belongs to the target.
    next_step : str
        What the engineer does with them.
    screen : tuple of renderable
        Tables for a terminal.
    """

    files: tuple[Path, ...]
    facts: Mapping[str, Any]
    next_step: str
    screen: tuple[RenderableType, ...] = ()

    def __rich__(self) -> RenderableType:
        """Return its tables."""
        from rich.console import Group

        return Group(*self.screen)

    def __repr__(self) -> str:
        """Return its tables, what was written, in lines that are not broken, and what to do."""
        tables = [super().__repr__()] if self.screen else []
        return "\n".join([*tables, *self.lines])

    @property
    def lines(self) -> tuple[str, ...]:
        """What was written, a file a line, and what to do with it."""
        following = (f"Next: {self.next_step}",) if self.next_step else ()
        return (*(f"Written: {path}" for path in self.files), *following)


def export(
    controller: inner.Controller | None,
    plant: Plant,
    folder: str | Path = ".",
    to: Target = "st",
    *,
    dialect: Dialect = "codesys",
    precision: Precision = "double",
    fmi: FmiVersion = "3.0",
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
        None for the process itself, which is exported as FMUs only.
    plant : Plant
    folder : str or Path
        It is made where it is missing.
    to : {"st", "c", "fmu", "tuning"}
        IEC 61131-3 Structured Text with a test project and PLCopen XML, C99, a functional mock-up
        unit, or PID settings in the vendors' forms and units.
    dialect : {"codesys", "matiec", "scl"}
        Of Structured Text.
    precision : {"double", "single"}
        Of Structured Text and C.
    fmi : {"3.0", "2.0"}
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
        The controller cannot be exported, the target is unknown, or the folder cannot be written.

    Examples
    --------
    >>> import clepsydra as cl, tempfile
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = export(cl.design.simc(plant), plant, folder, to="c")
    >>> [path.name for path in written.files]
    ['quadruple_tank_pi_simc.h', 'quadruple_tank_pi_simc.c']
    """
    if to not in get_args(Target):
        raise InputError(
            "export, to", to, f"one of {', '.join(get_args(Target))}",
            suggestion(to, get_args(Target), "choose one of them"),
        )  # fmt: skip
    shell = plant_shell(
        plant,
        fail_safe=fail_safe,
        sensor_delay=sensor_delay,
        setpoint_rate=setpoint_rate,
        rate_limit=rate_limit,
    )
    found = _files(controller, plant, to, dialect, precision, fmi, shell, scenario)
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    return Exported(
        tuple(write_together(place, found.files)), found.facts, found.next_step, found.screen
    )


def _files(
    controller: inner.Controller | None,
    plant: Plant,
    to: Target,
    dialect: Dialect,
    precision: Precision,
    fmi: FmiVersion,
    shell: PlantShell,
    scenario: Scenario | None,
) -> exports.ExportedFiles:
    if controller is None:
        if to != "fmu":
            raise InputError(
                "export, controller", "none", 'a controller, or to="fmu"', "give a controller"
            )
        return exports.export_process_fmu(plant.point, version=fmi)
    own = of_plant(controller, plant)
    if to == "tuning":
        return exports.export_tuning(own, plant.point, scenario or scenario_of(plant))
    ready = exportable(own, plant.point, shell)
    if to == "st":
        return exports.export_structured_text(ready, dialect=dialect, precision=precision)
    if to == "c":
        return exports.export_c(ready, precision=precision)
    return exports.export_controller_fmu(ready, version=fmi)
