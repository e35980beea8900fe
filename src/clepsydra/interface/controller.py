"""A controller of a plant, with the settings of its loops in the words of its own table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.section import Line, Mark, Section, marked
from clepsydra.controllers import controller as inner
from clepsydra.controllers.controller import plain_name as plain_name
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.interface.loop_settings import Settings
from clepsydra.interface.settings import values_of
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.studies.result import TriedController

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant


@dataclass(frozen=True, eq=False, repr=False)
class Controller(Answered, inner.Controller):
    """A step law with its numbers, for a plant; `cl.design` makes them.

    Printed, it shows the settings of its loops. `settings` has them, in the units of the process
    file and in percent. `design` says how the numbers were found, `notes` what to watch, `values`
    are the numbers of the law [SI].

    Parameters
    ----------
    plant : Plant
        Where it starts at rest.
    """

    plant: Plant = field(kw_only=True)

    @property
    def settings(self) -> Settings:
        """Its loops with their settings, `settings["level_1"]["K"].value`; empty without loops."""
        return Settings(self)

    @keywords_checked('write as in with_values({"level_1": {"K": 6.0}})')
    def with_values(self, values: Mapping[str, Any], *, name: str | None = None) -> Controller:
        """Return a controller with other settings, at rest at the same operating point.

        Parameters
        ----------
        values : mapping
            Loop to its settings, {"level_1": {"K": 6.0, "Ti": "40 s"}}, in the words of the
            controller's own table: K, Ti, Td, b, and the keys of study files. Text with a unit, or
            a number in the unit of the table: a time in s, K in %/% where that is the same as in
            the units of the signals, as with V/V of equal ranges, and refused where it is not; or
            those of the `settings` of another controller. The gain has no sign: the action of the
            loop gives it. What follows a setting does so still: a tracking time that
            equals Ti. Of other laws, parameter to its value, a number in SI as in `values` or text
            with a unit.
        name : str, optional
            What the reader sees; the same name with ", changed" if left out.

        Raises
        ------
        InputError
            A loop or a setting is unknown, or a value is wrong; the message says what there is.

        Examples
        --------
        >>> import clepsydra as cl
        >>> pi = cl.design.simc(cl.load("quadruple-tank"))
        >>> bold = pi.with_values({"level_1": {"K": 6.0}})
        >>> bold.values["level_1.proportional_gain"], pi.values["level_1.proportional_gain"]
        (6.0, 3.0)
        """
        found = values_of(self, values)
        changed = lifted(
            Controller,
            self,
            name=name or f"{self.name}, changed",
            design=f"{self.design.rstrip('.')}; then changed by hand.",
            values={**self.values, **found},
        )
        return changed._rested_as(self)

    def named(self, name: str) -> Controller:
        """Return it under another name, by which a study tells it apart."""
        return replace(self, name=name)

    def _rested_as(self, before: Controller) -> Controller:
        """Return it at rest at its plant, as the one that it was made from is at its own."""
        if isinstance(self.law, PythonLaw):
            return self
        from clepsydra.loop.loop import Loop
        from clepsydra.studies.tuning.resting_states import rested_elsewhere

        loops = (Loop(each, each.plant.measured) for each in (before, self))
        return replace(self, initial_state=rested_elsewhere(*loops))

    def _remedy(self, name: str) -> str:
        """Lead from a setting to where it stands."""
        loops = (loop for loop, settings in self.settings.items() if name in settings)
        return next((f'write settings["{loop}"]["{name}"]' for loop in loops), "")

    def answer(self) -> Section:
        """Return name, design and settings."""
        from clepsydra.report.law_tables import law_grids

        tables = self.settings.answer().parts or law_grids(self, self.plant.process)
        notes = marked(Mark.POINT, self.notes)
        title = f"{self.title} for {self.plant.name}"
        return Section(title, (Line(self.design), *tables, *notes))


#: What every call takes for a controller: one, or a candidate of a study.
AnyController = inner.Controller | TriedController


def required(controller: AnyController) -> inner.Controller:
    """Return the controller that was given, that of a candidate of a study too.

    Raises
    ------
    InputError
        It is none.
    """
    found = controller.controller if isinstance(controller, TriedController) else controller
    remedy = "give one, as from cl.design.simc(plant)"
    require_type(found, inner.Controller, "controller", "a controller", remedy)
    return found


def of_plant(controller: AnyController, plant: Subject) -> Controller:
    """Return a controller as one of a plant, where it starts at rest.

    One that was made for another plant, or for another operating point, is taken as it is where
    the plant has its signals in their units, and only starts elsewhere.

    Raises
    ------
    InputError
        It is no controller, or it is wired to signals that the plant does not have.
    """
    plant, controller = plant_of(plant), required(controller)
    if not isinstance(controller, Controller):
        return lifted(Controller, controller, plant=plant)
    if controller.plant is plant:
        return controller
    _check_signals(controller, plant)
    return replace(controller, plant=plant)._rested_as(controller)


def _check_signals(controller: Controller, plant: Plant) -> None:
    """Refuse a controller of a plant with other signals."""
    own = controller.plant.process
    for name in (*controller.measurements, *controller.setpoints, *controller.manipulated):
        signals = {
            signal.name: signal for signal in (*plant.process.measurements, *plant.process.inputs)
        }
        if name not in signals or signals[name].unit != own.signal(name).unit:
            raise InputError(
                "controller",
                f"{controller.name} of {own.name}",
                f"a controller of {plant.name}; it has no {name} in {own.signal(name).shown_unit}",
                "design one for this plant, as in cl.design.simc(plant)",
            )
