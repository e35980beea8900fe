"""`cl.relay_experiment`: a loop under a relay, which tells how its controller may be set."""

from __future__ import annotations

from clepsydra.base.arguments import require_signal
from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.quantities import Quantity, read_signal, read_time
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.loop import relay_experiment as inner

_PLACE = "relay experiment"


@keywords_checked()
def relay_experiment(
    plant: Subject,
    measured: str,
    manipulated: str,
    *,
    amplitude: Quantity | None = None,
    hysteresis: Quantity = 0.0,
    duration: Quantity | None = None,
) -> inner.RelayRecord:
    """Let a relay move an input of a plant at rest, and record what a measurement does.

    `ultimate_point_of_relay` reads the ultimate gain and period off the record, or off one of the
    plant itself, and the rules of Ziegler and Nichols or of Tyreus and Luyben make settings of it.

    Parameters
    ----------
    plant : Plant, str or Path
    measured, manipulated : str
        The loop.
    amplitude : str or float, optional
        Of the relay; a fifth of the way to the nearer limit of the input if left out.
    hysteresis : str or float
        From the setpoint to where the relay switches.
    duration : str or float, optional
        Twenty ultimate periods of the linear model if left out.

    Returns
    -------
    RelayRecord
        Time [s], input and measurement [SI].

    Raises
    ------
    InputError
        A name is unknown, or a number is out of range.
    NotApplicable
        The input does not move the measurement, a signal has no range, or the loop never swings.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> record = cl.relay_experiment(plant, "level_1", "pump_2", amplitude="0.3 V")
    >>> round(cl.ultimate_point_of_relay(record).period)  # [s]
    20
    """
    plant = plant_of(plant)
    process = plant.process
    outputs = [process.signal(name) for name in process.controlled]
    y = require_signal(_PLACE, measured, outputs, "a controlled measurement")
    u = require_signal(_PLACE, manipulated, process.inputs, "an input")

    def change(key: str, value: Quantity, of: inner.Signal) -> float:
        return read_signal(_PLACE, key, value, of, "a change", change=True)

    return inner.relay_experiment(
        plant.linear,
        y.name,
        u.name,
        amplitude=None if amplitude is None else change("amplitude", amplitude, u),
        hysteresis=change("hysteresis", hysteresis, y),
        duration=None if duration is None else read_time(_PLACE, "duration", duration),
    )
