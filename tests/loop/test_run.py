"""A run as trajectories, as a table and as a dataset."""

import numpy as np
import pytest

from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.process.reader import load_process

SAMPLES = 30


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    random = np.random.default_rng(1)
    return Scenario(
        sampling_period=1.0,
        setpoints=np.array([6.0, 6.3]) + 0.1 * (np.arange(SAMPLES) > 9)[:, None],
        disturbances=np.column_stack([np.linspace(0, 1e-6, SAMPLES), np.zeros(SAMPLES)]),
        noise=0.01 * random.normal(size=(SAMPLES, 4)),
        segments=(),
        seed=1,
    )


@pytest.fixture(scope="module")
def run(scenario) -> Run:
    analysis = analyse(load_process("quadruple-tank"))
    controller = design_simc(analysis.model, analysis.pairing)
    return Loop(controller, analysis.model).run(scenario)


EXPECTED_UNITS = {
    **{f"tank_{i}.level": "m" for i in (1, 2, 3, 4)},
    **{f"level_{i}": "V" for i in (1, 2, 3, 4)},
    **{f"level_{i}.setpoint": "V" for i in (1, 2)},
    **{f"pump_{i}": "V" for i in (1, 2)},
    **{f"pump_{i}.status": "1" for i in (1, 2)},
    **{f"inflow_{i}": "m^3/s" for i in (1, 2)},
}


def test_every_signal_has_its_trajectory_and_its_unit(run):
    assert {signal.name: signal.unit for signal in run.signals} == EXPECTED_UNITS
    assert set(run.values) == set(EXPECTED_UNITS)
    assert all(values.shape == (SAMPLES,) for values in run.values.values())
    assert np.array_equal(run.time, np.arange(SAMPLES))
    assert run.error_estimate is None and run.substeps >= 1


def test_what_the_scenario_gives_is_what_the_run_shows(run, scenario):
    for i, name in enumerate(["level_1", "level_2"]):
        assert np.array_equal(run.values[f"{name}.setpoint"], scenario.setpoints[:, i])
    for i, name in enumerate(["inflow_1", "inflow_2"]):
        assert np.array_equal(run.values[name], scenario.disturbances[:, i])


def test_a_measurement_is_its_level_in_volts_plus_its_noise(run, scenario):
    for i in range(4):
        name = f"level_{i + 1}"
        volts = 50.0 * run.values[f"tank_{i + 1}.level"]  # 0.5 V/cm
        noisy = run.values[name]
        assert np.max(np.abs(noisy - volts - scenario.noise[:, i])) < 1e-14
        assert np.max(np.abs(run.true_measurement(name) - volts)) < 1e-14
        assert np.max(np.abs(noisy - volts)) > 0.005


def test_manipulated_variables_stay_in_their_range(run):
    for name in ("pump_1", "pump_2"):
        assert np.all((run.values[name] >= 0.0) & (run.values[name] <= 10.0))
        assert np.ptp(run.values[name]) > 0.1


def test_the_table_has_a_row_a_sample_and_a_column_a_signal(run):
    table = run.to_pandas()
    assert table.index.name == "time"
    assert np.array_equal(table.index, run.time)
    assert list(table.columns) == [signal.name for signal in run.signals]
    for name in table.columns:
        assert np.array_equal(table[name], run.values[name])


def test_the_dataset_carries_units_and_descriptions(run):
    dataset = run.to_xarray()
    assert dataset.sizes == {"time": SAMPLES}
    assert dataset.time.attrs["units"] == "s"
    assert set(dataset.data_vars) == set(EXPECTED_UNITS)
    for signal in run.signals:
        assert dataset[signal.name].attrs["units"] == EXPECTED_UNITS[signal.name]
        assert dataset[signal.name].attrs["long_name"] == (signal.description or signal.name)
        assert np.array_equal(dataset[signal.name], run.values[signal.name])
    assert dataset["level_1"].sel(time=12.0).item() == run.values["level_1"][12]
