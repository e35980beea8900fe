"""Plants written as process files in a test, started away from rest."""

import sys
from pathlib import Path

import numpy as np
import pytest
from written_plants import plant_of

from clepsydra.linear.operating_point import OperatingPoint

sys.path.insert(0, str(Path(__file__).parent))  # for random_plants

HEAD = 'name = "rig"\ntitle = "A rig"\ngravity = "9.81 m/s^2"\n'


@pytest.fixture
def start(tmp_path):
    """Return a function (text, sampling period [s], state) → point, nothing of it at rest."""

    def make(text, period, **state):
        process = plant_of(tmp_path, f'{HEAD}sampling_period = "{period} s"\n{text}').process
        values = {signal.name: signal.initial for signal in process.state}
        values |= {name.replace("__", "."): value for name, value in state.items()}
        assert len(values) == len(process.state), list(values)
        x = np.array(list(values.values()))
        u = np.array([signal.initial for signal in process.inputs])
        d = np.array([signal.initial for signal in process.disturbances])
        y = np.array(process.measure(x, process.parameter_values)).ravel()
        return OperatingPoint(process, x, u, d, y, residual=np.inf)

    return make
