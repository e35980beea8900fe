"""A step law that is a Python function: any Python, called once a sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.base.user_code import line_of, shortened, words_of
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.own_signals import OwnSignals
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.program.step_law import StepLaw

#: What a user writes: (state, inputs, parameters, time step) → (next state, outputs), by name.
Step = Callable[
    [dict[str, float], dict[str, float], dict[str, float], float],
    tuple[Mapping[str, float], Mapping[str, float]],
]

#: Way of a difference quotient, as a share of a signal's size; the cube root of rounding.
_SHARE = 1e-5


@dataclass(frozen=True)
class PythonLaw(StepLaw):
    """A step law whose function is Python instead of expressions.

    It runs in a loop, sample by sample, and has a linear model by differences. It has no program:
    it is not compiled, exported or run as a batch.

    Examples
    --------
    >>> law = python_law("half", lambda state, inputs, parameters, time_step:
    ...                  ({}, {"pump.out": inputs["level.pv"] / 2}),
    ...                  inputs=[Signal("level.pv")], outputs=[Signal("pump.out")])
    >>> isinstance(law, PythonLaw), [signal.name for signal in law.state]
    (True, ['pump.last_output'])
    """

    def jacobians(
        self, state: Sequence[float], inputs: Sequence[float], parameters: Sequence[float]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return ∂x⁺/∂x, ∂x⁺/∂u, ∂y/∂x and ∂y/∂u by central differences.

        The way is 1e-5 of the range of a signal, or of its value or 1 where it has none. What is
        no real number, a mode or a switch, is not moved: its columns are zero.
        """
        x, u = np.array(state, float), np.array(inputs, float)
        entries = [x if isinstance(x, Signal) else x.signal for x in self.state]
        columns = []
        for signals, vector in ((entries, x), (self.inputs, u)):
            for place, signal in enumerate(signals):
                columns.append(self._slope(signal, vector, place, x, u, parameters))
        following, outputs = (np.column_stack(part) for part in zip(*columns, strict=True))
        count = len(x)
        return following[:, :count], following[:, count:], outputs[:, :count], outputs[:, count:]

    def _slope(
        self,
        signal: Signal,
        vector: np.ndarray,
        place: int,
        x: np.ndarray,
        u: np.ndarray,
        parameters: Sequence[float],
    ) -> tuple[np.ndarray, np.ndarray]:
        if signal.kind != "real":
            return np.zeros(len(self.state)), np.zeros(len(self.outputs))
        middle = vector[place]
        size = signal.span if np.isfinite(signal.span) else max(1.0, abs(middle))
        ends = []
        for vector[place] in (middle - _SHARE * size, middle + _SHARE * size):
            following, outputs, _ = self.function(x, u, parameters)
            ends.append((vector[place], np.array(following), np.array(outputs)))
        vector[place] = middle
        (first, *low), (last, *high) = ends
        slopes = [(b - a) / (last - first) for a, b in zip(low, high, strict=True)]
        return slopes[0], slopes[1]


def python_law(
    name: str,
    step: Step,
    *,
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    parameters: Sequence[Signal] = (),
    state: Sequence[Signal] = (),
    file: Path | None = None,
) -> PythonLaw:
    """Make a step law of a Python function that says what is asked for in automatic.

    The function is called once a sample with four things, the first three by name: the state, the
    inputs, the parameters, and the time step [s]. It returns the next state and the outputs. All
    that it remembers is in the state, so that a run can be copied and replayed. The inputs
    contain pump.last_output, what was applied in the last sample, whoever moved it.

    Modes, limits, a failed sensor and the status word are added (`OwnSignals`). While a
    measurement or setpoint is no number, or a sensor is bad, the function is not called: its state
    and the outputs stay.

    Parameters
    ----------
    name : str
        An identifier.
    step : callable
    inputs, outputs, parameters, state : sequence of Signal
        Inputs sp and pv of measurements, mode, manual and tracking of outputs; outputs: out of
        what each moves.
    file : Path, optional
        In which the function stands, for messages.

    Raises
    ------
    InputError
        The signals are wrong; and in a run where the function fails, or returns something else.

    Examples
    --------
    >>> def step(state, inputs, parameters, time_step):
    ...     error = inputs["level.sp"] - inputs["level.pv"]
    ...     integral = state["integral"] + parameters["gain"] / 40.0 * error * time_step
    ...     return {"integral": integral}, {"pump.out": parameters["gain"] * error + integral}
    >>> law = python_law("my_pi", step, inputs=[Signal("level.sp"), Signal("level.pv")],
    ...                  outputs=[Signal("pump.out")], parameters=[Signal("gain")],
    ...                  state=[Signal("integral")])
    >>> given = dict(sp=5, pv=4, good=1, mode=1, time_step=1)
    >>> _, outputs, _ = law.function([3, 3], [given.get(s.part, 0) for s in law.inputs], [2, 0, 10])
    >>> float(outputs[0])
    5.05
    """
    place = name if file is None else file.name
    own = OwnSignals(place, tuple(inputs), tuple(parameters), tuple(outputs), tuple(state))
    return PythonLaw(
        name,
        tuple(own.whole_inputs),
        tuple(own.whole_parameters),
        tuple(own.whole_state),
        tuple(own.whole_outputs),
        (),
        cast(Any, _PythonFunction(name, step, own, file)),
        ("A law in Python: see its file.",),
    )


class _PythonFunction:
    """The function of a Python law, called as that of any step law."""

    def __init__(self, name: str, step: Step, own: OwnSignals, file: Path | None) -> None:
        self.name, self._step, self._own, self._file = name, step, own, file
        self._inputs = [signal.name for signal in own.whole_inputs]
        self._parameters = [parameter.name for parameter in own.whole_parameters]
        self._state = [entry.name for entry in own.state]
        self._outputs = [signal.name for signal in own.outputs]
        self._end = own.end()

    def __call__(
        self, state: Any, inputs: Any, parameters: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        own = self._own
        x, u, p = (np.asarray(ca.DM(v) if isinstance(v, ca.DM) else v, float).ravel().tolist()
                   for v in (state, inputs, parameters))  # fmt: skip
        count = len(self._state)
        given = dict(zip(self._inputs, u, strict=True))
        values = dict(zip(self._parameters, p, strict=True))
        kept = dict(zip(self._state, x[:count], strict=True))
        last = {s.name: value for s, value in zip(self._end.state, x[count:], strict=True)}
        numbers = all(abs(given[name]) <= LARGEST_NUMBER for name in own.plant)
        sensors = all(given[name] != 0.0 for name in own.sensors)
        time_step = given["time_step"]
        usable = numbers and sensors and 0.0 < time_step <= LARGEST_NUMBER
        following, asked = kept, dict.fromkeys(self._outputs, 0.0)
        if usable:
            following, asked = self._stepped(kept, given | last, values, time_step)
        conditions = {"usable": usable, "numbers": numbers, "sensors": sensors}
        told = {path(output.owner, "asked"): asked[output.name] for output in own.outputs}
        told |= {name: float(value) for name, value in conditions.items()} | given
        ended, outputs, _ = self._end.function(
            x[count:],
            [told[signal.name] for signal in self._end.inputs],
            [values[parameter.name] for parameter in self._end.parameters],
        )
        moved = np.array(ended).ravel()
        return (
            np.concatenate([[following[name] for name in self._state], moved]),
            np.array(outputs).ravel(),
            np.zeros(0),
        )

    def _stepped(
        self,
        state: dict[str, float],
        inputs: dict[str, float],
        parameters: dict[str, float],
        time_step: float,
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Call the user's function and check what it returns."""
        try:
            result = self._step(dict(state), inputs, parameters, time_step)
        except Exception as error:
            where = self.name if self._file is None else line_of(error, self._file)
            raise InputError(
                f"{where}, step", words_of(error), "a step that works for every input", "correct it"
            ) from None
        pair = isinstance(result, tuple) and len(result) == 2
        if not pair or not all(isinstance(part, Mapping) for part in result):
            raise InputError(
                self._place, shortened(repr(result)),
                "the next state and the outputs, two dictionaries",
                'write as in return {"integral": integral}, {"pump.out": output}',
            )  # fmt: skip
        return (
            self._checked("next state", result[0], self._state),
            self._checked("outputs", result[1], self._outputs),
        )

    def _checked(self, what: str, values: Mapping[str, Any], names: list[str]) -> dict[str, float]:
        if set(values) != set(names):
            raise InputError(
                f"{self._place}, {what}", shortened(", ".join(map(str, values))) or "nothing",
                f"values for {', '.join(names) or 'nothing'}", "return each of them, and no other",
            )  # fmt: skip
        found = {}
        for name in names:
            value = values[name]
            value = float(value) if isinstance(value, (bool, np.bool_)) else value
            if not is_finite_number(value):
                raise InputError(
                    f"{self._place}, {name}", shortened(repr(value)), "a finite number",
                    "return one for every input",
                )  # fmt: skip
            found[name] = float(value)
        return found

    @property
    def _place(self) -> str:
        if self._file is None:
            return f"{self.name}, step"
        code = getattr(self._step, "__code__", None)
        line = f", line {code.co_firstlineno}" if code else ""
        return f"{self._file.name}{line}, step"
