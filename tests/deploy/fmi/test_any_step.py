"""FMUs of processes whose communication steps begin and end between two integration steps."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmus import VERSIONS, Imported, cases, written
from models import FRICTIONS, origin, rig
from plants import plant
from scipy.integrate import solve_ivp

from clepsydra.deploy.fmi.process import process_model
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process

#: A pump that feeds a closed tank through a pipe of 3 s.
PIPE = """
name = "pipe"
title = "A pipe"
gravity = "9.81 m/s^2"
sampling_period = "1 s"
controlled = ["level"]
[reservoirs.basin]
[tanks.store]
area = "1 m^2"
height = "4 m"
[delays.pipe]
destination = "store"
time = "3 s"
[pumps.feed]
source = "basin"
destination = "pipe"
gain = "0.01 m^3/(s V)"
range = ["0 V", "10 V"]
nominal = "4 V"
[flows.taken]
source = "store"
range = ["0 m^3/s", "1 m^3/s"]
nominal = "0.04 m^3/s"
[sensors.level]
tank = "store"
range = ["0 m", "4 m"]
"""

pytestmark = pytest.mark.thorough


def by_dop853(point, changes, stop) -> np.ndarray:
    """The states at the end, by SciPy from one change of the first input to the next [n].

    Parameters
    ----------
    changes : list of (time [s], value)
    """
    motion, parameters = point.process.motion, point.process.parameter_values
    contents, delayed, memories, u, d, _ = motion.at_rest(
        point.state, point.inputs, point.disturbances, parameters
    )
    ends = [*(time for time, _ in changes[1:]), stop]
    for (start, value), end in zip(changes, ends, strict=True):
        u = np.array([value, *u[1:]])
        held = (delayed, memories, u, d, parameters)

        def rates(_, c, held=held):
            return np.array(motion.rates(c, *held)[0]).ravel()

        contents = solve_ivp(rates, (start, end), contents, "DOP853", rtol=1e-12, atol=1e-14).y[
            :, -1
        ]
    return np.array(motion.to_state(contents, parameters)).ravel()


@pytest.mark.parametrize("version", VERSIONS)
def test_an_input_that_changes_and_a_stop_between_two_steps(version, tmp_path):
    """FMPy cuts a step where an input jumps, and the last one where the run ends."""
    point = plant("quadruple-tank").point
    path = written(process_model(point, 2, origin("quadruple-tank", 1.0)), tmp_path, version)
    changes = [(0.0, 3.0), (2.31, 4.0), (6.8, 2.5)]
    rows = [(0.0, 3.0), (2.31, 3.0), (2.31, 4.0), (6.8, 4.0), (6.8, 2.5), (10.0, 2.5)]
    names = [signal.name for signal in point.process.state]
    run = simulate_fmu(
        str(path),
        stop_time=9.37,
        output_interval=1.0,
        input=np.array(rows, dtype=[("time", float), ("pump_1", float)]),
        output=names,
    )
    assert run["time"][-1] == pytest.approx(9.37, abs=1e-12)
    expected = by_dop853(point, changes, 9.37)
    found = np.array([run[name][-1] for name in names])
    assert found == pytest.approx(expected, rel=1e-8)
    moved = by_dop853(point, [(0.0, 3.0), (2.5, 4.0), (6.8, 2.5)], 9.37)
    assert np.abs(moved - expected).max() > 1e4 * np.abs(found - expected).max()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("length", [0.3, 0.75, 1.2, 0.0137])
def test_steps_of_any_length_end_where_one_long_step_ends(length, version, tmp_path):
    """A part of a step has the error of a shorter step; the measurements follow the states."""
    point = plant("quadruple-tank").point
    path = written(process_model(point, 2, origin("quadruple-tank", 1.0)), tmp_path, version)
    fmu, count = Imported(path, tmp_path).initialise(5.0), 40
    fmu.set({"pump_1": 4.0})
    for step in range(count):
        fmu.step(5.0 + step * length, length)
    expected = by_dop853(point, [(0.0, 4.0)], count * length)
    names = [signal.name for signal in point.process.state]
    assert fmu.get_all(names) == pytest.approx(expected, rel=1e-8)
    shown = point.process.measure(np.array(fmu.get_all(names)), point.process.parameter_values)
    measured = [signal.name for signal in point.process.measurements]
    assert fmu.get_all(measured) == pytest.approx(np.array(shown).ravel(), rel=1e-14)
    fmu.close()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("delay", ["3 s", "1 s", "0.5 s"])
def test_a_delay_loses_no_liquid_where_a_pump_changes_within_a_step(delay, version, tmp_path):
    """Of what the pump has given up to 3 s ago all has arrived: 1 m² rises by its integral."""
    file = tmp_path / "pipe.toml"
    file.write_text(PIPE.replace('time = "3 s"', f'time = "{delay}"'), encoding="utf-8")
    point = find_equilibrium(load_process(file))
    path = written(process_model(point, 2, origin("pipe", 1.0)), tmp_path, version)
    fmu, time, volts = Imported(path, tmp_path).initialise(), 0.0, 4.0
    late, entered, taken = float(delay.split()[0]), [(0.0, 4.0)], 0.04
    for length, volts in ((0.3, 6.0), (0.85, 1.0), (2.0, 3.0), (0.11, 9.0), (1.24, 4.0)):
        fmu.set({"feed": volts})
        entered.append((time, volts))
        fmu.step(time, length)
        time += length
    fmu.step(time, 4.0)
    time += 4.0
    given = (
        sum(
            0.01 * volts * (min(end, time - late) - start)
            for (start, volts), end in zip(
                entered[1:], [t for t, _ in entered[2:]] + [time], strict=True
            )
            if start < time - late
        )
        + 0.01 * 4.0 * late
    )
    assert fmu.get("store.level") == pytest.approx(2.0 + given - taken * time, rel=1e-12)
    fmu.close()


@pytest.mark.parametrize(("friction", "version"), cases(FRICTIONS))
def test_every_switch_and_a_delay_between_two_steps(friction, version, tmp_path):
    """A trip, a start, a pump that runs dry: as often and, within a share of a step, when."""
    point = rig(tmp_path, friction, delay=True)
    path = written(process_model(point, 24, origin("rig", 1.0)), tmp_path, version)
    whole, cut = (Imported(path, tmp_path, name).initialise() for name in ("whole", "cut"))
    names = [v.name for v in whole.description.modelVariables if v.causality != "parameter"]
    counts = [name for name in names if name.endswith(".count")]
    levels, time = ["upper.level", "lower.level"], 0.0
    for sample in range(400):
        feed = {"feed": 9.0 if sample % 200 < 100 else 0.0}
        for fmu in (whole, cut):
            fmu.set(feed)
        whole.step(float(sample), 1.0)
        for length in (0.317, 0.4, 0.283):
            cut.step(time, length)
            time += length
        time = sample + 1.0
    assert sum(whole.get_all(counts)) >= 4
    assert whole.get_all(counts) == cut.get_all(counts)
    assert cut.get_all(levels) == pytest.approx(whole.get_all(levels), abs=1e-5)
    for fmu in (whole, cut):
        fmu.close()


@pytest.mark.parametrize("version", VERSIONS)
def test_a_state_between_two_steps_is_gone_back_to(version, tmp_path):
    point = rig(tmp_path, delay=True)
    path = written(process_model(point, 24, origin("rig", 1.0)), tmp_path, version)
    fmu = Imported(path, tmp_path).initialise()
    names = [v.name for v in fmu.description.modelVariables if v.causality == "output"]
    fmu.set({"feed": 7.0})
    fmu.step(0.0, 0.3)
    kept = fmu.serialised(fmu.state())
    ends = []
    for _ in range(2):
        fmu.step(0.3, 9.01)
        ends.append(fmu.get_all(names))
        fmu.set_state(fmu.deserialised(kept))
    assert ends[0] == ends[1]
    fmu.close()
