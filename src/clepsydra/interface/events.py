"""What happens in a simulation: steps and ramps of setpoints, loads and inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from clepsydra.base.arguments import require_signal, require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.units import to_si
from clepsydra.interface.quantities import Quantity, check_within, read_signal, read_time
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.loop.default_scenario import segment_samples
from clepsydra.loop.profile import Change as Change
from clepsydra.loop.profile import read_assignment, read_when

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal
    from clepsydra.interface.plant import Plant

_EXAMPLE = 'write as in [cl.step("level_1", "+1 V")]'


@dataclass(frozen=True)
class Event:
    """That a signal goes to another value, at once, along a ramp, or for a time; see `step`.

    Parameters
    ----------
    kind : str
        "step", "ramp" or "disturbance", as it was asked for.
    signal : str
    by, to : str, float or None
        The change, or the value after it; one of the two.
    at : str, float or None
        When it begins; None for a while after the event before.
    over : str, float or None
        How long it takes; None for a step.
    lasts : str, float or None
        How long it lasts until the signal goes back; None where it stays.
    """

    kind: str
    signal: str
    by: Quantity | None
    to: Quantity | None
    at: Quantity | None
    over: Quantity | None = None
    lasts: Quantity | None = None

    @property
    def place(self) -> str:
        """What messages call it."""
        return f"{self.kind} of {self.signal}"


#: What happens: events, and the changes of a profile.
Events = Sequence[Event | Change]


@keywords_checked()
def step(
    signal: str,
    by: Quantity | None = None,
    *,
    to: Quantity | None = None,
    at: Quantity | None = None,
    lasts: Quantity | None = None,
) -> Event:
    """Return a step: of the setpoint of a controlled measurement, a disturbance, or an input.

    Parameters
    ----------
    signal : str
        Under a controller a controlled measurement, whose setpoint steps, or a disturbance. Without
        one an input or a disturbance.
    by, to : str or float
        The size of the step, "+1 V" or "-10 %" of the range, or the value after it, "7 V". A number
        is in the display unit of the signal, the one that the printed plant shows.
    at : str or float, optional
        When, "2 min"; a number is in s. If left out, as long after the event before as the default
        scenario would wait.
    lasts : str or float, optional
        How long, "1 s", until the signal goes back to what it was before: a pulse, such as water
        that is poured. It stays if left out.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), [step("level_1", "+1 V", at="1 min")])
    >>> round(float(run.values["level_1"][-1] - run.values["level_1"][0]), 3)
    1.0
    """
    return _event("step", signal, by, to, at, lasts=lasts)


@keywords_checked()
def ramp(
    signal: str,
    by: Quantity | None = None,
    *,
    over: Quantity,
    to: Quantity | None = None,
    at: Quantity | None = None,
) -> Event:
    """Return a ramp, a step that takes its time.

    Parameters
    ----------
    signal, by, to, at
        As for `step`; `at` is when it begins.
    over : str or float
        How long it takes, "5 min"; a number is in s.

    Examples
    --------
    >>> ramp("level_2", "+1 V", over="5 min").over
    '5 min'
    """
    return _event("ramp", signal, by, to, at, over)


@keywords_checked()
def disturbance(
    signal: str,
    by: Quantity | None = None,
    *,
    to: Quantity | None = None,
    at: Quantity | None = None,
    lasts: Quantity | None = None,
) -> Event:
    """Return a step of a disturbance.

    Parameters
    ----------
    signal : str
        A disturbance of the plant.
    by, to, at, lasts
        As for `step`.

    Examples
    --------
    >>> disturbance("inflow_1", "+10 %").place
    'disturbance of inflow_1'

    A pulse, a tenth of a litre that is poured within a second:

    >>> disturbance("pour_1", to="100 cm^3/s", at="3 min", lasts="1 s").lasts
    '1 s'
    """
    return _event("disturbance", signal, by, to, at, lasts=lasts)


def _event(
    kind: str,
    signal: str,
    by: Quantity | None,
    to: Quantity | None,
    at: Quantity | None,
    over: Quantity | None = None,
    lasts: Quantity | None = None,
) -> Event:
    require_type(signal, str, kind, "the name of a signal", 'write as in step("level_1", "+1 V")')
    event = Event(kind, signal, by, to, at, over, lasts)
    if (by is None) == (to is None):
        raise InputError(
            event.place, "neither by nor to" if by is None else "both by and to",
            "the size of the change, or the value after it",
            f'write as in {kind}("{signal}", "+10 %") or {kind}("{signal}", to="50 %")',
        )  # fmt: skip
    return event


def profile(path: str | Path, plant: Subject) -> list[Change]:
    """Return the values of signals over time, from a CSV file, as events of `cl.simulate`.

    Parameters
    ----------
    path : str or Path
        Its head names time and signals with their units, "time [min],pump_1 [V]"; each value is
        held until the next row.
    plant : Plant, str or Path

    Raises
    ------
    InputError
        The file cannot be used, or a signal is none that moves a plant without a controller.
    """
    from clepsydra.loop.profile_csv import read_profile_csv

    return read_profile_csv(path, plant_of(plant).process)


def change_in_words(text: str, plant: Plant, place: str) -> Change:
    """Return what the command line says of an input: "pump_1=4V@60s..120s".

    Examples
    --------
    >>> import clepsydra as cl
    >>> change_in_words("pump_1=4V@60s..120s", cl.load("quadruple-tank"), "--input").stop
    120.0
    """
    return read_assignment(text, plant.process, place)


def event_in_words(text: str, place: str) -> Event:
    """Return what the command line says of a setpoint or a load: "level_1=60%@1min..3min".

    Examples
    --------
    >>> event = event_in_words("level_1=60%@1min..3min", "--input")
    >>> event.to, event.at, event.over
    ('60%', '1min', 120.0)
    >>> event_in_words("pour_1=97cm^3/s@3min+1s", "--input").lasts
    '1s'
    """
    signal, equals, words = text.partition("=")
    if not equals:
        raise InputError(
            place, text[:60], "a signal, '=' and its value", "write as in level_1=60%@60s"
        )
    value, _, times = words.partition("@")
    begin, until, lasts = read_when(times, place)
    at = begin or "0 s"
    over = to_si(until, "s", place) - to_si(at, "s", place) if until else None
    if over is not None and over <= 0.0:
        raise InputError(
            place, times.strip(), "a ramp that ends after it begins", "exchange the two times"
        )
    kind = "ramp" if until else "step"
    return Event(kind, signal.strip(), None, value.strip(), at, over, lasts or None)


def changes_of(events: object, plant: Plant, *, controlled: bool) -> list[Change]:
    """Return events as changes to values at times [SI], those without a time after each other.

    Parameters
    ----------
    events : sequence of Event
    plant : Plant
    controlled : bool
        Whether a controller moves the inputs, so that setpoints change and not inputs.

    Raises
    ------
    InputError
        A signal is unknown or not to be moved, a quantity is none of it or leaves its range.
    """
    require_type(events, (list, tuple), "events", "a list of events", _EXAMPLE)
    assert isinstance(events, (list, tuple))
    read = [event for event in events if isinstance(event, Change)]
    others = [event for event in events if not isinstance(event, Change)]
    given = sequence_of(others, Event, "events", "a list of events", _EXAMPLE)
    for change in read:
        _signal("change", change.signal, change.place, plant, controlled)
    waits = rests = 0.0
    if any(event.at is None for event in given):
        period = plant.process.sampling_period
        rests, waits = (samples * period for samples in segment_samples(plant.linear))
    begins, timed = rests, []
    for event in given:
        start = begins if event.at is None else read_time(event.place, "at", event.at)
        over = _takes(event, "over", "make it a step instead")
        lasts = _takes(event, "lasts", "leave it out")
        begins = start + (over or lasts) + waits
        timed.append((start, start + over, start + lasts if lasts else None, event))
    timed.sort(key=lambda entry: entry[0])
    found = read
    now: dict[str, float] = {}
    for start, stop, back, event in timed:
        signal = _signal(event.kind, event.signal, event.place, plant, controlled)
        if event.to is None and signal.name not in now:
            now[signal.name] = plant.point.as_dict()[signal.name]
        value = _value(event, signal, now.get(signal.name))
        if back is None:
            now[signal.name] = value
        found.append(Change(signal.name, value, start, stop, event.place, back))
    return found


def _takes(event: Event, key: Literal["over", "lasts"], remedy: str) -> float:
    """Return how long an event takes, or lasts; 0 where it is not said [s]."""
    given = event.over if key == "over" else event.lasts
    time = 0.0 if given is None else read_time(event.place, key, given)
    if given is not None and time == 0.0:
        raise InputError(f"{event.place}, {key}", given, "a time above 0 s", remedy)
    return time


def _signal(kind: str, name: str, place: str, plant: Plant, controlled: bool) -> Signal:
    process = plant.process
    loads = {signal.name: signal for signal in process.disturbances}
    if kind == "disturbance":
        words = f"a disturbance of {process.name}"
        return require_signal(place, name, process.disturbances, words)
    setpoints = {name: process.signal(name) for name in process.controlled}
    inputs = {signal.name: signal for signal in process.inputs}
    if not controlled and name in setpoints:
        raise InputError(
            place, name,
            f"an input or a disturbance ({', '.join({**inputs, **loads})}), since there is no "
            "controller",
            "give a controller, as in cl.simulate(plant, cl.design.simc(plant), events)",
        )  # fmt: skip
    if controlled and name in inputs:
        raise InputError(
            place, name,
            f"a controlled measurement or a disturbance ({', '.join({**setpoints, **loads})}), "
            "since the controller moves the inputs",
            "move a setpoint, or simulate without a controller",
        )  # fmt: skip
    movable = {**(setpoints if controlled else inputs), **loads}
    words = "a controlled measurement" if controlled else "an input"
    words += f" or a disturbance of {process.name}"
    return require_signal(place, name, movable.values(), words)


def _value(event: Event, signal: Signal, before: float | None) -> float:
    """Return the value after an event [SI]."""
    if event.to is not None:
        value = read_signal(event.place, "to", event.to, signal, "a value")
    else:
        assert before is not None
        value = before + read_signal(event.place, "by", event.by, signal, "a change", change=True)
    key, written = ("by", event.by) if event.to is None else ("to", event.to)
    check_within(event.place, key, signal, value, written, "a value")
    if value == before:
        raise InputError(
            f"{event.place}, {key}", written, f"a change of {signal.name}", "leave it out"
        )
    return value
