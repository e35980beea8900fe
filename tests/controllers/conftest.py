"""A step law driven by names instead of vectors; helpers are imported by name."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "program"))

from law_function import by_path, function_of


class Driven:
    """A law with its parameters and state, scanned sample by sample."""

    def __init__(self, law, values, state):
        self.law, self.state = law, by_path(law.state, state)
        self.values = by_path(law.parameters, values)

    def scan(self, **inputs):
        law = self.law
        inputs = by_path(law.inputs, inputs)
        next_state, outputs, _ = function_of(law)(
            [self.state[signal.name] for signal in law.state],
            [inputs[signal.name] for signal in law.inputs],
            [self.values[signal.name] for signal in law.parameters],
        )
        self.state = dict(zip([signal.name for signal in law.state], next_state, strict=True))
        return dict(zip([signal.name for signal in law.outputs], outputs, strict=True))


@pytest.fixture
def driven():
    return Driven
