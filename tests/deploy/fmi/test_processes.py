"""FMUs of processes for co-simulation: every bit is the engine's, at any whole number of steps."""

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmus import VERSIONS, Imported, all_bits, cases, written
from models import FRICTIONS, drawn, origin, process_of, rig
from plants import STRUCTURES, plant

from clepsydra import Kernel
from clepsydra.deploy.fmi.process import process_model
from clepsydra.deploy.process_program import process_program
from clepsydra.loop.step_size import substeps_for

SAMPLES = 300

pytestmark = pytest.mark.thorough


def proven(point, substeps: int, folder, version: str, samples: int = SAMPLES) -> None:
    """Run a process over sampling periods by the engine and as an FMU, and compare all outputs."""
    process = point.process
    program, period = process_program(point, substeps), process.sampling_period
    inputs = drawn(program, samples, 11, period, broken=False)
    run = Kernel(program).run(samples, inputs=inputs)
    expected = np.column_stack([run.output(s.name)[0] for s in program.outputs])
    model = process_model(point, substeps, origin(process.name, period))
    path = written(model, folder, version)
    assert validate_fmu(str(path)) == []
    fmu, names = Imported(path, folder).initialise(), [s.name for s in program.outputs]
    assert fmu.get_all(names) == pytest.approx([s.initial for s in program.outputs], rel=1e-12)
    found = np.empty_like(expected)
    for sample in range(samples):
        fmu.set({name: values[sample] for name, values in inputs.items()})
        fmu.step(sample * period, period)
        found[sample] = fmu.get_all(names)
    fmu.close()
    assert np.ptp(expected, axis=0).max() > 0
    assert np.array_equal(all_bits(found), all_bits(expected))


@pytest.mark.parametrize(("name", "version"), cases(STRUCTURES))
def test_every_bit_is_that_of_the_engine(name, version, tmp_path):
    """Square roots, concentrations, pumps that run dry and start."""
    proven(plant(name).point, substeps_for(plant(name).linear), tmp_path, version)


@pytest.mark.parametrize(("friction", "version"), cases(FRICTIONS))
def test_a_rig_with_a_delay_and_every_switch(friction, version, tmp_path):
    proven(rig(tmp_path, friction, delay=True), 24, tmp_path, version)


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    """The quadruple tank in two steps a period."""
    folder = tmp_path_factory.mktemp("tank")
    point = plant("quadruple-tank").point
    model = process_model(point, 2, origin("quadruple-tank", 1.0))
    return {version: (written(model, folder, version), folder) for version in VERSIONS}


@pytest.fixture(params=VERSIONS)
def importing(request, paths):
    """Return a function that makes an instance."""
    path, folder = paths[request.param]
    made = []

    def make(name: str = "one") -> Imported:
        made.append(Imported(path, folder, name))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


def test_steps_that_are_multiples_of_the_integration_step_are_the_same_steps(importing):
    one, other = importing("one").initialise(10.0), importing("other").initialise(10.0)
    for fmu in (one, other):
        fmu.set({"pump_1": 3.4})
    for sample in range(12):
        one.step(10.0 + sample, 1.0)
    time = 10.0
    for length in (0.5, 2.5, 1.0, 7.0, 0.5, 0.5):
        other.step(time, length)
        time += length
    names = ["tank_1.level", "tank_4.level", "level_1"]
    assert one.get_all(names) == other.get_all(names)


def test_the_outputs_at_the_start_follow_the_state_that_is_set(importing):
    fmu = importing()
    fmu.set({"tank_1.level": 0.06, "level_1.gain": 100.0})
    fmu.initialise()
    assert fmu.get("tank_1.level") == 0.06
    assert fmu.get("level_1") == pytest.approx(6.0, rel=1e-15)


def test_a_long_time_does_not_add_up_rounding(tmp_path):
    """A tenth of a second is no double: the importer's sum of times drifts, the steps do not."""
    point = plant("quadruple-tank").point
    path = written(process_model(point, 10, origin("quadruple-tank", 1.0)), tmp_path, "3.0")
    fmu, time = Imported(path, tmp_path).initialise(), 0.0
    for _ in range(100_000):
        fmu.step(time, 0.1)
        time += 0.1
    assert abs(time - 10_000.0) > 1e-9
    fmu.close()


def test_disturbances_are_inputs_and_measurements_outputs():
    model = process_of("quadruple-tank")
    groups = {v.name: v.causality for v in model.variables}
    assert groups["inflow_1"] == groups["pump_1"] == "input"
    assert groups["level_1"] == groups["tank_1.level"] == "output"
    assert not any(name.startswith("held.") for name in groups)
    assert groups["tank_1.area"] == "parameter"
