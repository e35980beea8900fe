"""From a record to the settings of a loop."""

import numpy as np
import pytest

import clepsydra as cl

TIME = np.arange(600.0)


def record(folder, level):
    """Write a record of a pump that steps at 60 s, and a level [V]."""
    table = np.column_stack([TIME, np.where(TIME < 60.0, 3.0, 3.5), level])
    path = folder / "record.csv"
    np.savetxt(path, table, delimiter=",", header="time [s],pump_1 [V],level_1 [V]", comments="")
    return path


def test_a_slow_tank_gets_the_settings_of_simc(tmp_path):
    """First order, 2 V/V and 40 s, seen after 60 s: SIMC takes Ti = min(τ, 4 (τc + θ))."""
    rise = np.where(TIME < 60.0, 0.0, 1.0 - np.exp(-(TIME - 60.0) / 40.0))
    model = cl.identify(record(tmp_path, 5.0 + 2.0 * 0.5 * rise), "pump_1", "level_1")
    plant = cl.load("quadruple-tank")
    pi = cl.design.simc(plant).with_values({"level_1": model.settings})
    found = model.for_control.settings
    assert pi.values["level_1.integral_time"] == pytest.approx(40.0, rel=0.01)
    closed_loop = found.closed_loop_time_constant + found.delay
    gain = 40.0 / (2.0 * closed_loop)  # K = τ / (k (τc + θ))  [V/V]
    assert pi.values["level_1.proportional_gain"] == pytest.approx(gain, rel=0.01)
    assert repr(model.best).startswith("FOPDT: static gain 2")
    assert len(repr(model.best)) < 100


def test_a_record_that_tells_nothing_gives_no_settings(tmp_path):
    level = 5.0 + 0.01 * np.random.default_rng(1).standard_normal(TIME.size)
    model = cl.identify(record(tmp_path, level), "pump_1", "level_1")
    with pytest.raises(cl.NotApplicable, match="Use none of these models"):
        model.settings  # noqa: B018
