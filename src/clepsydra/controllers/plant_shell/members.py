"""The members of a plant shell, made for a controller from the settings."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.controllers.plant_shell.fail_safe import SafeOutput
from clepsydra.controllers.plant_shell.sensor_diagnosis import SENSOR_DELAY, MonitoredSensor
from clepsydra.controllers.plant_shell.setpoint_ramp import RampedSetpoint
from clepsydra.controllers.plant_shell.settings import PlantShell, check_names
from clepsydra.controllers.plant_shell.take_up import take_up_scans
from clepsydra.controllers.signals import LARGEST_PARAMETER, owners
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.wiring import wired_setpoints
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class Members:
    """What a shell is made of.

    Parameters
    ----------
    sensors : tuple of MonitoredSensor
    setpoints : tuple of RampedSetpoint
    outputs : tuple of SafeOutput
    rates : dict
        An output whose rate the shell limits, to the rate [unit/s].
    own_rates : dict
        Parameter rate_limit that the law has itself to its value.
    take_up_scans : int
        Scans for which the law follows its output before it is in force again.
    sources : dict
        Parameter of the shell to where its number comes from.
    notes : tuple of str
        What the shell cannot do here.

    Examples
    --------
    >>> Members((), (), (), {}, {}, 1, {}, ()).rates
    {}
    """

    sensors: tuple[MonitoredSensor, ...]
    setpoints: tuple[RampedSetpoint, ...]
    outputs: tuple[SafeOutput, ...]
    rates: dict[str, float]
    own_rates: dict[str, float]
    take_up_scans: int
    sources: dict[str, str]
    notes: tuple[str, ...]


def members_of(controller: Controller, settings: PlantShell, sampling_period: float) -> Members:
    """Return the members of the shell of a controller.

    Parameters
    ----------
    controller : Controller
    settings : PlantShell
    sampling_period : float
        [s]

    Raises
    ------
    InputError
        A setting is for a signal that the controller does not have, a fail-safe value lies
        outside the limits, or the rate of an output cannot be limited.

    Examples
    --------
    >>> import clepsydra as cl
    >>> members = members_of(cl.design.simc(cl.load("quadruple-tank")), PlantShell(), 1.0)
    >>> members.sensors[0].range, members.sources["level_1.range_low"]
    ((0.0, 10.0), 'range of level_1 in the process file')
    """
    return _Maker(controller, settings).made(sampling_period)


class _Maker:
    def __init__(self, controller: Controller, settings: PlantShell) -> None:
        self.controller, self.settings = controller, settings
        self.inputs = {signal.name: signal for signal in controller.law.inputs}
        self.results = {signal.name: signal for signal in controller.law.outputs}
        self.sources: dict[str, str] = {}
        self.notes: list[str] = []

    def made(self, sampling_period: float) -> Members:
        self._check_names()
        controller, law = self.controller, self.controller.law
        measured = zip(owners(law.inputs, "pv"), controller.measurements, strict=True)
        sensors = tuple(self._sensor(*each) for each in measured)
        free = wired_setpoints(law, controller.free_inputs)
        followed = zip(free, controller.setpoints, strict=True)
        setpoints = tuple(self._setpoint(*each) for each in followed)
        rates, own_rates = self._rates()
        moved = zip(owners(law.outputs, "out"), controller.manipulated, strict=True)
        outputs = tuple(self._output(*each) for each in moved)
        self.sources |= {
            "sampling_period": "sampling period that the controller runs with",
            "take_up_scans": "settling of what the law remembers, found by running it",
            "scan_tolerance": "setting of the plant shell"
            if self.settings.scan_tolerance != PlantShell().scan_tolerance
            else "default: a tenth",
        }
        safe = [output.value for output in outputs]
        scans = take_up_scans(self.controller, sampling_period, safe)
        return Members(
            sensors, setpoints, outputs, rates, own_rates, scans, self.sources, tuple(self.notes)
        )

    def _check_names(self) -> None:
        controller, settings, place = self.controller, self.settings, self.controller.name
        for what, known, kind in (
            ("ranges", controller.measurements, "measurement"),
            ("sensor_delay", controller.measurements, "measurement"),
            ("setpoint_rate", controller.setpoints, "controlled measurement"),
            ("rate_limit", controller.manipulated, "manipulated variable"),
            ("fail_safe", controller.manipulated, "manipulated variable"),
        ):
            check_names(what, getattr(settings, what), known, place, kind)

    def _source(self, parameter: str, given: bool, otherwise: str) -> None:
        self.sources[parameter] = "setting of the plant shell" if given else otherwise

    def _sensor(self, owner: str, name: str) -> MonitoredSensor:
        signal = replace(self.inputs[path(owner, "pv")], name=owner)
        given = self.settings.ranges.get(name)
        known = given or (signal.low, signal.high)
        between: tuple[float, float] | None = None
        if all(math.isfinite(end) for end in known) and known[0] < known[1]:
            between = (float(known[0]), float(known[1]))
            for end in ("low", "high"):
                self._source(
                    path(owner, f"range_{end}"),
                    given is not None,
                    f"range of {name} in the process file",
                )
        else:
            self.notes.append(
                f"The range of {name} is not known, so the shell cannot tell its current: only "
                "what is not a number and the fault bit of the card count as faults of it."
            )
        delay = self.settings.sensor_delay.get(name)
        self._source(path(owner, "sensor_delay"), delay is not None, f"default: {SENSOR_DELAY:g} s")
        return MonitoredSensor(signal, between, SENSOR_DELAY if delay is None else float(delay))

    def _setpoint(self, owner: str, name: str) -> RampedSetpoint:
        rate = self.settings.setpoint_rate.get(name)
        measured = dict(
            zip(self.controller.measurements, owners(self.inputs.values(), "pv"), strict=True)
        )
        self._source(path(owner, "setpoint_rate"), rate is not None, "default: no ramp")
        return RampedSetpoint(
            replace(self.inputs[path(owner, "sp")], name=owner),
            measured.get(name),
            name in measured and path(measured[name], "range_low") in self.sources,
            LARGEST_PARAMETER if rate is None else float(rate),
        )

    def _output(self, owner: str, name: str) -> SafeOutput:
        values = self.controller.values
        signal = replace(self.results[path(owner, "out")], name=owner)
        low = values.get(path(owner, "low_limit"), signal.low)
        high = values.get(path(owner, "high_limit"), signal.high)
        given = self.settings.fail_safe.get(name)
        if given is not None and not low <= given <= high:
            port = at_port(replace(signal, low=low, high=high, initial=given))
            raise InputError(
                f"{self.controller.name}, plant shell, fail_safe, {name}", port.initial,
                f"a value from {port.low:g} to {port.high:g} {port.unit}, the limits of {name}",
                "choose one within the limits",
            )  # fmt: skip
        if given is None and not math.isfinite(low):
            raise InputError(
                f"{self.controller.name}, plant shell, fail_safe, {name}", "none",
                f"a fail-safe value: {name} has no low limit that could stand for it",
                f'write as in fail_safe={{"{name}": 0.0}}',
            )  # fmt: skip
        self._source(path(owner, "fail_safe"), given is not None, f"default: low limit of {name}")
        return SafeOutput(signal, float(low if given is None else given))

    def _rates(self) -> tuple[dict[str, float], dict[str, float]]:
        """Return the rates that the shell limits, and those that the law limits itself."""
        law = self.controller.law
        rates: dict[str, float] = {}
        own: dict[str, float] = {}
        known = {parameter.name for parameter in law.parameters}
        outputs = owners(law.outputs, "out")
        for owner, name in zip(outputs, self.controller.manipulated, strict=True):
            rate = self.settings.rate_limit.get(name)
            parameter = path(owner, "rate_limit")
            if parameter in known:
                if rate is not None:
                    own[parameter] = float(rate)
                    self.sources[parameter] = "setting of the plant shell"
                continue
            reason = _unhurried(law, owner, known, name)
            if reason is None:
                rates[owner] = LARGEST_PARAMETER if rate is None else float(rate)
                self._source(parameter, rate is not None, "default: no rate limit")
                continue
            self.notes.append(f"The shell does not limit the rate of {name}: {reason}.")
            if rate is not None:
                raise InputError(
                    f"{self.controller.name}, plant shell, rate_limit, {name}", rate,
                    f"none, since {reason}", "leave it out",
                )  # fmt: skip
        return rates, own


def _unhurried(law: StepLaw, owner: str, known: Iterable[str], name: str) -> str | None:
    """Return why the rate of an output cannot be limited, if it cannot."""
    if path(owner, "running_value") in known:
        return f"{name} runs or stands"
    if not {path(owner, f"{end}_limit") for end in ("low", "high")} <= set(known):
        return f"the law has no limits of {name} that could be moved with it"
    for block in law.blocks:
        if isinstance(block, PidBlock) and block.form.winding == "clamping":
            return (
                "clamping would keep the integral within the reach of the rate limit; the law "
                "with another anti-windup, or with a rate limit of its own, can have one"
            )
    return None
