"""A vendor's PID block: its equation, its parameters with their units, and what it lacks."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import Any, Literal

from clepsydra.controllers.pid_form import DerivativeOn

Form = Literal["isa", "series", "parallel"]
Kind = Literal[
    "gain",
    "proportional band",
    "integral time",
    "repeats",
    "integral gain",
    "derivative time",
    "derivative gain",
    "filter time",
    "filter ratio",
    "setpoint weight",
    "reduced setpoint weight",
    "derivative weight",
    "low limit",
    "high limit",
]
#: Files of `vendors/`, in the order in which their blocks are shown.
_FILES = ("siemens", "rockwell", "languages", "schneider", "emerson", "others")
#: What only a loop with integral, or with derivative action is given.
INTEGRAL_KINDS = ("integral time", "repeats", "integral gain")
DERIVATIVE_KINDS = (
    "derivative time", "derivative gain", "filter time", "filter ratio", "derivative weight",
)  # fmt: skip
#: What says nothing of the PID's numbers: where its output ends.
LIMIT_KINDS = ("low limit", "high limit")


@dataclass(frozen=True)
class Parameter:
    """One parameter of a block, by the vendor's name and in the vendor's unit.

    With the gain g in the block's unit, and the others in seconds, a parameter is: gain g,
    proportional band 100/g; integral time Ti, repeats 1/Ti, integral gain g/Ti; derivative time
    Td, derivative gain g Td; filter time Tf, filter ratio Tf/Td; setpoint weight b, reduced
    setpoint weight 1 − b; derivative weight 1 where the error is differentiated and 0 where the
    measurement is; low and high limit of what is moved, in the unit that the process shows.

    Parameters
    ----------
    name : str
    kind : str
    unit : {"", "%", "s", "min", "1/s", "1/min"}
        Empty of pure numbers, of gains, whose unit is that of the block, and of limits.
    resolution : float
        The step in which it is entered [unit]; 0 where it is a floating point number.
    low, high : float or None
        Documented range [unit].

    Examples
    --------
    >>> Parameter("Ti", "integral time", "min").seconds
    60.0
    """

    name: str
    kind: Kind
    unit: str = ""
    resolution: float = 0.0
    low: float | None = None
    high: float | None = None

    @property
    def seconds(self) -> float:
        """Length of its unit of time [s]; 1 where it has none."""
        return 60.0 if "min" in self.unit else 1.0


@dataclass(frozen=True)
class VendorBlock:
    """A vendor's PID block, as its documents describe it.

    Parameters
    ----------
    key : str
        For programs: "siemens-pid-compact".
    vendor, name : str
    equation : str
        In the vendor's symbols.
    form : {"isa", "series", "parallel"}
    gain_in : {"percent", "engineering"}
        Whether the gain is in percent of range per percent of range, or in the units of the
        signals that the user connects.
    parameters : tuple of Parameter
    sign : {"gain", "opposite gain", "switch"}
        Whether the gain is above zero for reverse action, below zero for it, or always above
        zero beside an `action` switch.
    action : tuple of str
        Name of the switch, and what it says for reverse and for direct action.
    weights : tuple of float
        Setpoint weights that can be had; empty where any can.
    weight_choice : tuple of str
        Name of the switch, and what it says for weight 1 and for weight 0.
    derivative_on : tuple
        What it can differentiate; empty where the documents at hand leave the derivative open.
    derivative_choice : tuple of str
        Name of the switch, and what it says for the measurement and for the error.
    derivative_filter : {"settable", "none", "unpublished"} or float
        Or the fixed ratio of derivative to filter time.
    scaling : str
        What the user has to scale, so that the gain means what it should.
    anti_windup : str
    sources : tuple of str
        Documents, with page or section.
    not_confirmed, not_confirmed_of_derivative : tuple of str
        What no document at hand says, in general and of the derivative.

    Examples
    --------
    >>> EVERY_BLOCK[0].key, EVERY_BLOCK[0].title
    ('siemens-pid-compact', 'Siemens PID_Compact')
    """

    key: str
    vendor: str
    name: str
    equation: str
    form: Form
    gain_in: Literal["percent", "engineering"]
    parameters: tuple[Parameter, ...]
    sources: tuple[str, ...]
    anti_windup: str
    scaling: str
    sign: Literal["gain", "opposite gain", "switch"] = "gain"
    action: tuple[str, str, str] | None = None
    weights: tuple[float, ...] = (1.0,)
    weight_choice: tuple[str, str, str] | None = None
    derivative_on: tuple[DerivativeOn, ...] = ("error",)
    derivative_choice: tuple[str, str, str] | None = None
    derivative_filter: Literal["settable", "none", "unpublished"] | float = "none"
    not_confirmed: tuple[str, ...] = ()
    not_confirmed_of_derivative: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Vendor and name."""
        return f"{self.vendor} {self.name}"


def _blocks(vendor: str) -> Iterator[VendorBlock]:
    """Read the blocks of a file; its keys above the first one hold for all of them."""
    file = resources.files("clepsydra.deploy.vendor_tuning") / "vendors" / f"{vendor}.toml"
    shared = tomllib.loads(file.read_text(encoding="utf-8"))
    for table in shared.pop("block"):
        given: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value
            for key, value in (shared | table).items()
        }
        given["parameters"] = tuple(Parameter(**each) for each in table["parameters"])
        yield VendorBlock(**given)


#: Every block that a tuning is translated for.
EVERY_BLOCK = tuple(block for vendor in _FILES for block in _blocks(vendor))
