"""The PID loops of a controller, each with its numbers in ISA form."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.deploy.tagged import process_tagging
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid, from_series
from clepsydra.designs.loops.pid_settings import ParallelSettings, from_parallel
from clepsydra.process.process import Process


@dataclass(frozen=True)
class StandardTuning:
    """The tuning of one loop in ISA form, as every block of a vendor is computed from.

    Parameters
    ----------
    loop : str
        What its parameters belong to.
    measurement, moved : Signal
        As the process shows them; what is moved is an output, another loop's setpoint, or a
        signal of the scheme.
    form : PidForm
        The controller's own.
    settings : FilteredPid
        In ISA form.
    direct : bool
        Whether nothing stands between it and an output.
    limits : tuple of float
        Where the controller ends what is moved, or its range ends [unit of moved]; infinite
        where nothing does.
    """

    loop: str
    measurement: Signal
    moved: Signal
    form: PidForm
    settings: FilteredPid
    direct: bool
    limits: tuple[float, float] = (-math.inf, math.inf)

    @property
    def title(self) -> str:
        """What the reader calls the loop."""
        return f"{self.measurement.name} by {self.moved.name}"

    @property
    def action(self) -> str:
        """Reverse where the output rises when the measurement falls, else direct."""
        return "reverse" if self.settings.gain > 0.0 else "direct"

    @property
    def has_derivative(self) -> bool:
        """Whether there is derivative action that does something."""
        return self.settings.derivative_time > 0.0

    @property
    def has_integral(self) -> bool:
        """Whether there is integral action that does something."""
        return math.isfinite(self.settings.integral_time)


def standard_tunings(
    controller: Controller, process: Process
) -> tuple[list[StandardTuning], list[tuple[str, str]]]:
    """Return the tuning of every PID loop of a controller, and the loops that have none.

    Parameters
    ----------
    controller : Controller
    process : Process
        Lends ranges and display units.

    Returns
    -------
    tuple
        The tunings, and (loop, reason) of each loop that a vendor's block cannot be given.

    Raises
    ------
    InputError
        The controller has no PID loop, or none that can be translated.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> tunings, refused = standard_tunings(controller, plant.process)
    >>> tunings[0].title, round(tunings[0].settings.integral_time, 3), refused
    ('level_1 by pump_1', 32.032, [])
    """
    found, refused = [], []
    loops = [block for block in controller.law.blocks if isinstance(block, PidBlock)]
    # What an outer loop moves is the setpoint of an inner one, which has limits of its own.
    inner = {block.measurement.name: block.owner for block in loops if block.inner}
    for block in loops:
        measurement, moved = (known_signal(process, s) for s in (block.measurement, block.moved))
        try:
            settings = _settings(block, controller)
        except InputError as error:
            refused.append((f"{measurement.name} by {moved.name}", str(error)))
            continue
        owner, beginning = inner.get(block.moved.name), "setpoint_"
        if owner is None:
            owner, beginning = block.moved.name, ""
        low, high = (
            controller.values.get(path(owner, f"{beginning}{end}_limit"), getattr(moved, end))
            for end in ("low", "high")
        )
        found.append(
            StandardTuning(
                block.owner, measurement, moved, block.form, settings, block.direct, (low, high)
            )
        )
    if not found:
        why = "; ".join(reason for _, reason in refused)
        raise InputError(
            f"{controller.name}, tuning for a vendor's PID block",
            why or f"{controller.family} without a PID block of fixed gains",
            "a controller with at least one PID loop whose gains are constant",
            "choose another controller of the study, or export this one as code",
        )
    return found, refused


def known_signal(process: Process, signal: Signal) -> Signal:
    """Return the signal as the process shows it, by its tag; one of the scheme alone stays."""
    try:
        return replace(process.signal(signal.name), name=process_tagging(process)(signal.name))
    except KeyError:
        return signal


def _settings(block: PidBlock, controller: Controller) -> FilteredPid:
    form, values, place = block.form, controller.values, f"{controller.name}, {block.name}"

    def value(what: str, otherwise: float = 0.0) -> float:
        return values.get(path(block.owner, what), otherwise)

    gain = value("proportional_gain")
    if form.error != "linear":
        raise InputError(
            place, f"{form.error} action on the error", "linear action on the error",
            "set this loop by hand: vendors' blocks shape the error each in their own way",
        )  # fmt: skip
    if gain == 0.0:
        raise InputError(
            place, "a gain of 0", "proportional action", "give the loop a proportional gain"
        )
    weight = value("setpoint_weight", 1.0)
    if form.algorithm == "parallel":
        given = ParallelSettings(gain, value("integral_gain"), value("derivative_gain"))
        _, integral_time, derivative_time = from_parallel(given, place)
        filter_time = value("filter_time") if derivative_time else 0.0
        return FilteredPid(gain, integral_time, derivative_time, filter_time, weight)
    integral_time = value("integral_time") if form.has_integral else math.inf
    derivative_time = value("derivative_time")
    filter_time = derivative_time / value("derivative_filter", 1.0)
    own = FilteredPid(
        gain, integral_time if integral_time > 0.0 else math.inf, derivative_time, filter_time,
        weight,
    )  # fmt: skip
    return from_series(own, form.derivative_on) if form.algorithm == "series" else own
