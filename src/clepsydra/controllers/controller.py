"""A controller: a step law with values for its parameters, wired to a process."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.controllers.parameters import check_initial_state, check_parameters
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class Controller:
    """A step law, the values of its parameters, and the process signals it is wired to.

    Output i of the law is ``manipulated_i`` with ``mode_i``, ``manual_i``, ``tracking_i`` and
    ``status_i``; its measurements are ``measurement_1`` … with ``sensor_1`` …, its setpoints
    ``setpoint_1`` …, and ``time_step`` is common.

    Parameters
    ----------
    name : str
        What the reader sees: "PI, SIMC".
    family : str
        The kind of law: "multiloop PI".
    design : str
        How the parameters were found, in one sentence.
    law : StepLaw
    values : dict
        Parameter name to its value, in the law's units.
    initial_state : dict
        State name to its value at the operating point, so that the loop starts at rest.
    measurements : tuple of str
        Process measurement wired to measurement_1, measurement_2, …
    setpoints : tuple of str
        Controlled measurement whose setpoint is wired to setpoint_1, setpoint_2, …
    manipulated : tuple of str
        Process input wired to manipulated_1, manipulated_2, …
    notes : tuple of str
        What the designer must tell the reader.

    Raises
    ------
    InputError
        A parameter or initial state is missing, unknown, not finite or outside its range.
    """

    name: str
    family: str
    design: str
    law: StepLaw
    values: dict[str, float]
    initial_state: dict[str, float]
    measurements: tuple[str, ...]
    setpoints: tuple[str, ...]
    manipulated: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_parameters(self.law, self.values, self.name)
        check_initial_state(self.law, self.initial_state, self.name)

    @property
    def input_wires(self) -> dict[str, str]:
        """Law input to the loop's signal, "mode_1" → "pump_1.mode"; time_step is not wired."""
        wires: dict[str, str] = {}
        for number, name in enumerate(self.measurements, 1):
            wires |= {f"measurement_{number}": name, f"sensor_{number}": f"{name}.sensor"}
        for number, name in enumerate(self.setpoints, 1):
            wires[f"setpoint_{number}"] = f"{name}.setpoint"
        for number, name in enumerate(self.manipulated, 1):
            for what in ("mode", "manual", "tracking"):
                wires[f"{what}_{number}"] = f"{name}.{what}"
        return wires

    @property
    def output_wires(self) -> dict[str, str]:
        """Law output to the loop's signal, "status_1" → "pump_1.status"."""
        wires: dict[str, str] = {}
        for number, name in enumerate(self.manipulated, 1):
            wires |= {f"manipulated_{number}": name, f"status_{number}": f"{name}.status"}
        return wires
