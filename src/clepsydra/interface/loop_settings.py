"""The settings of PID loops as an engineer enters them: in the units of the file and in percent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from clepsydra.base.errors import UnknownKey
from clepsydra.base.section import Section, Table
from clepsydra.base.suggestion import suggestion, symbol_of
from clepsydra.base.units import from_si, unit_text
from clepsydra.designs.gain_units import gain_factor, percent_gain
from clepsydra.interface.shown import Answered
from clepsydra.process.joined_unit import BESIDE
from clepsydra.report.facts import gain_unit
from clepsydra.report.quantities import (
    number_text,
)
from clepsydra.studies.file.law_parameters import GAINS, key_of, loops_of

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.controllers.structure.pid_block import PidBlock
    from clepsydra.designs.loops.pid_settings import Action

T = TypeVar("T")
_DIGITS = 4


@dataclass(frozen=True, repr=False)
class Setting:
    """A setting of a loop; printed, in four digits.

    Parameters
    ----------
    value : float [unit]
        A gain without its sign, which is the action of the loop.
    unit : str
        In the units that the process file has for the signals, "V/cm"; empty for a pure number.
    percent : float or None [percent_unit]
        A gain in percent of the range of the output per percent of that of the measurement; None
        where one has no range, and of all other settings.
    percent_unit : str
        "%/%", that of an integral gain "%/%/s", that of a derivative gain "%/% s".
    """

    value: float
    unit: str = ""
    percent: float | None = None
    percent_unit: str = ""

    @property
    def text(self) -> str:
        """Value and unit in all digits, as `Controller.with_values` and study files take them."""
        return f"{self.value!r} {self.unit}".strip()

    @property
    def shown(self) -> str:
        """What tables show: the percent where there are any."""
        if self.percent is not None:
            return f"{number_text(self.percent, _DIGITS)} {self.percent_unit}"
        return f"{number_text(self.value, _DIGITS)} {self.unit}".strip()

    def __repr__(self) -> str:
        """Return it in four digits, a gain in both units."""
        value = f"{number_text(self.value, _DIGITS)} {self.unit}".strip()
        return value if self.percent is None or value == self.shown else f"{value} = {self.shown}"


class _Named(dict[str, T]):
    """A dictionary that refuses an unknown name with the nearest."""

    def __missing__(self, name: str) -> T:
        known = f"one of {', '.join(self)}" if self else "a controller with PID loops"
        remedy = suggestion(name, self, "choose one of them" if self else "see its values instead")
        raise UnknownKey("settings", str(name)[:60], known, remedy)


class LoopSettings(_Named[Setting]):
    """The settings of a loop by the words of its table, K, Ti, Td, b and the keys of study files.

    Parameters
    ----------
    controller : Controller
    loop : PidBlock
        Of its law.

    Attributes
    ----------
    moves : str
        What its output is.
    action : {"reverse", "direct"}
        Whether the output rises or falls when the measurement falls.
    form : PidForm
        What the settings mean: `form.actions`, "PI", and `form.algorithm`, "isa".
    """

    def __init__(self, controller: Controller, loop: PidBlock) -> None:
        keys = {key_of(parameter): parameter.name for parameter in loop.parameters()}
        law = {parameter.name: parameter for parameter in controller.law.parameters}
        super().__init__()
        for key, name in keys.items():
            value = controller.values[name]
            if key in GAINS:
                self[symbol_of(key)] = _gain(value, loop, BESIDE[GAINS[key]])
            else:
                unit = law[name].shown_unit
                shown = from_si(value, law[name].unit, unit)
                self[symbol_of(key)] = Setting(shown, unit_text(unit))
        negative = any(controller.values[keys[key]] < 0.0 for key in GAINS if key in keys)
        self.moves: str = loop.moved.name
        self.action: Action = "direct" if negative else "reverse"
        self.form: PidForm = loop.form


class Settings(Answered, _Named[LoopSettings]):
    """The settings of a controller by its loops; printed, the table of the controller.

    Parameters
    ----------
    controller : Controller

    Examples
    --------
    >>> import clepsydra as cl
    >>> tanks = cl.load("three-tanks")
    >>> loop = cl.design.simc(tanks).settings["level_3"]
    >>> loop["K"], loop["Ti"].value, loop.moves, loop.action
    (7.143 (cm³/s)/cm = 5.000 %/%, 201.135, 'feed', 'reverse')
    """

    def __init__(self, controller: Controller) -> None:
        loops = loops_of(controller.law)
        super().__init__({name: LoopSettings(controller, loop) for name, loop in loops.items()})

    def answer(self) -> Section:
        """Return a table of them, a loop a row."""
        words = list(dict.fromkeys(word for loop in self.values() for word in loop))
        rows = [
            (name, loop.moves, *(loop[word].shown if word in loop else "" for word in words))
            for name, loop in self.items()
        ]
        table = Table("Settings", ("loop", "moves", *words), tuple(rows))
        return Section("", (table,) if rows else ())


def _gain(value: float, loop: PidBlock, beside: str) -> Setting:
    """Return a gain [SI] in the units of its signals, and in percent where both have a range."""
    signals = loop.measurement, loop.moved
    number, unit = abs(value) * gain_factor(*signals), gain_unit(*signals) + beside
    if not all(signal.has_range for signal in signals):
        return Setting(number, unit.strip())
    return Setting(number, unit.strip(), abs(percent_gain(value, *signals)), f"%/%{beside}")
