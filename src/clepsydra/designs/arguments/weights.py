"""The weights of a quadratic criterion as a design's argument."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.designs.arguments.argument import argument
from clepsydra.designs.arguments.of_model import OfModel
from clepsydra.designs.states.measured_states import without_idle_states
from clepsydra.designs.states.quadratic_weights import QuadraticWeights, diagonal_weights
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.errors_at import errors_at

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

_WEIGHED = ("states", "inputs", "integrals")


def _weights(table: TableReader, key: str, process: Process) -> OfModel[QuadraticWeights]:
    """Read the weights of squares of states, inputs and integrals [1 / SI unit squared]."""
    remedy = (
        f'write as in weights = {{ states = {{ "{process.state[0].name}" = 4.0 }}, '
        f"inputs = {{ {process.inputs[0].name} = 0.2 }} }}"
    )
    expected = "weights of states and inputs, for LQI of integrals as well"
    rows = table.table(key, expected, remedy, _WEIGHED)
    read = {
        what: _weight_numbers(
            rows.table(what, f"{what} with their weights", remedy), what != "states"
        )
        for what in _WEIGHED
        if what != "integrals" or rows.has(what)
    }

    def weights(model: LinearModel) -> QuadraticWeights:
        wanted = read["states"].keys() <= set(without_idle_states(model).states)
        fitting = without_idle_states(model) if wanted else model
        with errors_at(rows):
            return diagonal_weights(fitting, read["states"], read["inputs"], read.get("integrals"))

    return OfModel(weights)


def _weight_numbers(table: TableReader, positive: bool) -> dict[str, float]:
    bound = {"above" if positive else "at_least": 0.0}
    return {
        name: table.quantity(name, "1", "a weight", "correct the number", **bound)
        for name in table.present
    }


_NUMBERS = {"type": "object", "additionalProperties": {"type": ["number", "string"]}}
WEIGHTS = argument(
    "weights",
    _weights,
    "tables `states`, `inputs` and, for LQI, `integrals`, each with numbers per SI unit squared",
    {
        "type": "object",
        "properties": dict.fromkeys(_WEIGHED, _NUMBERS),
        "required": ["states", "inputs"],
        "additionalProperties": False,
    },
    "table",
)
