"""A step law that is a Python function: any Python, called once a sample."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.base.user_code import line_of, shortened, words_of
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.own_signals import OwnSignals
from clepsydra.program.entries import signal_of
from clepsydra.program.step_law import StepLaw

_Named = dict[str, float]
#: What a user writes: (state, inputs, parameters, time step) → (next state, outputs), by name.
Step = Callable[[_Named, _Named, _Named, float], tuple[Mapping[str, float], Mapping[str, float]]]

#: Way of a difference quotient, as a share of a signal's size; the cube root of rounding.
_SHARE = 1e-5


@dataclass(frozen=True)
class PythonLaw(StepLaw):
    """A step law whose function is Python instead of expressions.

    It runs in a loop, sample by sample, and has a linear model by differences. It has no program:
    it is not compiled, exported or run as a batch.

    Parameters
    ----------
    aside : tuple of str
        States that do nothing to the outputs near rest: where a search begins, how unsure an
        estimate is. The linear model leaves them out.
    """

    aside: tuple[str, ...] = ()

    def depends(self, result: int, argument: int) -> np.ndarray:
        """Return that each result may depend on all of an argument: no one sees into a function."""
        results, arguments = (self.state, self.outputs)[result], (self.state, self.inputs)[argument]
        return np.ones((len(results), len(arguments)), dtype=bool)

    def next_states(
        self, state: np.ndarray, inputs: np.ndarray, parameters: np.ndarray
    ) -> np.ndarray:
        """Return the state after a sample in k cases [k, n]."""
        cases = zip(state, inputs, parameters, strict=True)
        return np.stack([self.function(*case)[0] for case in cases])

    def jacobians(
        self, state: Sequence[float], inputs: Sequence[float], parameters: Sequence[float]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return ∂x⁺/∂x, ∂x⁺/∂u, ∂y/∂x and ∂y/∂u by central differences.

        The way is 1e-5 of the range of a signal, or of its value or 1 where it has none. What is
        no real number, a mode or a switch, is not moved, nor what stands `aside`: its columns are
        zero.
        """
        z, n = np.array([*state, *inputs], float), len(state)

        def results(at: np.ndarray) -> np.ndarray:
            following, outputs, _ = self.function(at[:n], at[n:], parameters)
            return np.concatenate([following, outputs])

        slopes = np.zeros((n + len(self.outputs), len(z)))
        for place, signal in enumerate(map(signal_of, (*self.state, *self.inputs))):
            if signal.kind == "real" and signal.name not in self.aside:
                size = signal.span if np.isfinite(signal.span) else max(1.0, abs(z[place]))
                low, high = z.copy(), z.copy()
                low[place] -= _SHARE * size
                high[place] += _SHARE * size
                slopes[:, place] = (results(high) - results(low)) / (high[place] - low[place])
        return slopes[:n, :n], slopes[:n, n:], slopes[n:, :n], slopes[n:, n:]


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

    `name`: an identifier; `inputs`, `outputs`, `parameters`, `state`: inputs sp and pv of
    measurements, mode, manual and tracking of outputs; outputs: out of what each moves; `file`: in
    which the function stands, for messages.

    Raises InputError: the signals are wrong; and in a run where the function fails, or returns
    something else.

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
        **own.whole,
        intermediates=(),
        function=cast(Any, _PythonFunction(name, step, own, file)),
        description=("A law in Python: see its file.",),
    )


class _PythonFunction:
    """The function of a Python law, called as that of any step law."""

    def __init__(self, name: str, step: Step, own: OwnSignals, file: Path | None) -> None:
        self.name, self._step, self._own, self._file = name, step, own, file

    def __call__(
        self, state: Any, inputs: Any, parameters: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        own, whole, end = self._own, self._own.whole, self._own.end
        states, given, values = (
            {entry.name: float(v) for entry, v in zip(whole[group], np.ravel(found), strict=True)}
            for group, found in (("state", state), ("inputs", inputs), ("parameters", parameters))
        )
        kept, last = ({s.name: states[s.name] for s in group} for group in (own.state, end.state))
        numbers = all(abs(given[name]) <= LARGEST_NUMBER for name in own.plant)
        sensors = all(given[name] != 0.0 for name in own.sensors)
        usable = numbers and sensors and 0.0 < given["time_step"] <= LARGEST_NUMBER
        following, asked = kept, dict.fromkeys((output.name for output in own.outputs), 0.0)
        if usable:
            following, asked = self._stepped(kept, given | last, values)
        told = values | {path(output.owner, "asked"): asked[output.name] for output in own.outputs}
        told |= {"usable": usable, "numbers": numbers, "sensors": sensors}
        ended, outputs, _ = end.function(
            [*last.values()],
            [given[signal.name] for signal in end.inputs],
            [float(told[parameter.name]) for parameter in end.parameters],
        )
        following_state = [*(following[name] for name in kept), *np.array(ended).ravel()]
        return np.array(following_state), np.array(outputs).ravel(), np.zeros(0)

    def _stepped(self, state: _Named, inputs: _Named, parameters: _Named) -> tuple[_Named, _Named]:
        """Call the user's function and check what it returns."""
        try:
            result = self._step(dict(state), inputs, parameters, inputs["time_step"])
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
        outputs = [signal.name for signal in self._own.outputs]
        following = self._checked("next state", result[0], [*state])
        return following, self._checked("outputs", result[1], outputs)

    def _checked(self, what: str, values: Mapping[str, Any], names: list[str]) -> _Named:
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
        code = getattr(inspect.unwrap(self._step), "__code__", None)
        line = f", line {code.co_firstlineno}" if code else ""
        return f"{self._file.name}{line}, step"
