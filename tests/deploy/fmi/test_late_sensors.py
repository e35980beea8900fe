"""FMUs of a process whose analyser takes its time and reports at times."""

import numpy as np
import pytest
from fmus import VERSIONS, Imported, written
from late_sensors import SENSORS, with_analyser
from models import origin
from test_processes import proven

from clepsydra import InputError
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.deploy.fmi.process import process_model


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("sensor", SENSORS)
def test_every_bit_is_that_of_the_engine(sensor, version, tmp_path):
    """In three integration steps a sample the sensors look three times as often."""
    proven(with_analyser(tmp_path, sensor).point, 3, tmp_path, version, samples=60)


@pytest.mark.thorough
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("sensor", SENSORS)
def test_what_is_told_does_not_depend_on_how_steps_are_cut(sensor, version, tmp_path):
    point = with_analyser(tmp_path, sensor).point
    path = written(process_model(point, 2, origin("analyser", 5.0)), tmp_path, version)
    whole, cut = (Imported(path, tmp_path, name).initialise() for name in ("whole", "cut"))
    time, told = 0.0, []
    for sample in range(60):
        for fmu in (whole, cut):
            fmu.set({"brine": 0.6 if sample % 20 < 10 else 0.2})
        whole.step(5.0 * sample, 5.0)
        for length in (1.317, 2.0, 1.683):
            cut.step(time, length)
            time += length
        time = 5.0 * (sample + 1)
        told.append(whole.get("strength"))
        # A part of a step has the error of a shorter step.
        assert cut.get("strength") == pytest.approx(told[-1], abs=1e-6)
    assert np.ptp(told) > 1.0
    for fmu in (whole, cut):
        fmu.close()


def test_a_late_sensor_is_refused_for_model_exchange_and_co_simulation_named(tmp_path):
    with pytest.raises(InputError, match=r"strength.*told late.*co-simulation"):
        exchange_model(with_analyser(tmp_path, SENSORS[0]).point, origin("analyser", 5.0))
