"""A step law driven by names instead of vectors; helpers are imported by name."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "program"))


class Driven:
    """A law with its parameters and state, scanned sample by sample."""

    def __init__(self, law, values, state):
        self.law, self.values, self.state = law, dict(values), dict(state)

    def scan(self, **inputs):
        law = self.law
        next_state, outputs, _ = law.function(
            [self.state[signal.name] for signal in law.state],
            [inputs[signal.name] for signal in law.inputs],
            [self.values[signal.name] for signal in law.parameters],
        )
        numbers = np.array(next_state).ravel().tolist(), np.array(outputs).ravel().tolist()
        self.state = dict(zip([signal.name for signal in law.state], numbers[0], strict=True))
        return dict(zip([signal.name for signal in law.outputs], numbers[1], strict=True))


@pytest.fixture
def driven():
    return Driven
