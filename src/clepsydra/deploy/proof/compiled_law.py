"""A step law whose function is compiled C, for a loop that is controlled by what was exported."""

from __future__ import annotations

import ctypes
from typing import Any, cast

import numpy as np

from clepsydra.controllers.python_law import PythonLaw
from clepsydra.deploy.proof.compiled_c import CompiledC
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.step_law import StepLaw


def compiled_law(law: StepLaw, compiled: CompiledC) -> StepLaw:
    """Return a law with the same signals whose function calls a compiled program of it.

    Parameters
    ----------
    law : StepLaw
    compiled : CompiledC
        Of the program of this law, in either precision.

    Examples
    --------
    See `clepsydra.deploy.proof.single_loop.score_change`.
    """
    return PythonLaw(
        law.name,
        law.inputs,
        law.parameters,
        law.state,
        law.outputs,
        (),
        cast(Any, _CompiledFunction(compiled)),
        ("Compiled C.",),
    )


class _CompiledFunction:
    """State, inputs and parameters to next state and outputs, by one call of the C."""

    def __init__(self, compiled: CompiledC) -> None:
        self._compiled = compiled
        self.name = compiled.program.name
        self._parameters: list[float] | None = None

    def __call__(
        self, state: Any, inputs: Any, parameters: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        compiled, program = self._compiled, self._compiled.program
        given = np.asarray(parameters, dtype=float).tolist()
        if given != self._parameters:
            for signal, value in zip(program.parameters, given, strict=True):
                setattr(compiled.parameters, signal.identifier, _of_kind(signal.kind, value))
            self._parameters = given
        values = np.asarray(state, dtype=float).tolist()
        for entry, value, (holder, name) in zip(
            program.state, values, compiled.members, strict=True
        ):
            value = _of_kind(signal_of(entry).kind, value)
            if is_ring(entry):
                # The caller keeps the ring: the C reads its oldest value and writes the new one.
                getattr(holder, name)[0] = value
                setattr(holder, f"{name}_position", 0)
            else:
                setattr(holder, name, value)
        names = [signal.name for signal in program.inputs]
        told = np.asarray(inputs, dtype=float).tolist()
        outputs = compiled(dict(zip(names, told, strict=True)))
        following = []
        for entry, (holder, name) in zip(program.state, compiled.members, strict=True):
            found = getattr(holder, name)
            following.append(float(found[0] if is_ring(entry) else found))
        return np.array(following), np.array(outputs), np.zeros(0)


def _of_kind(kind: str, value: float) -> Any:
    if kind == "real":
        return ctypes.c_double(value).value
    return int(value) if kind == "integer" else bool(value)
