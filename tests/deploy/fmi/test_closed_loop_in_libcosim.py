"""Controller and process as two FMUs, joined by libcosim, which shares no code with FMPy.

It reads FMI 2.0 for co-simulation and comes by ``pip install libcosimpy``. Where it is missing
the tests are skipped, unless CLEPSYDRA_REQUIRE_TOOLS=1.
"""

import numpy as np
import pytest
from fmus import Imported, written
from models import pi_model, process_of
from plants import plant
from tools import need

SCANS = 300
#: From this scan on there is a new setpoint.
CHANGE, SETPOINT = 20, 7.0
SECOND = 1_000_000_000  # libcosim counts nanoseconds

pytestmark = pytest.mark.thorough


@pytest.fixture(autouse=True)
def _libcosim():
    need("libcosimpy")


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    """Return the FMUs of process and controller, their folder, and the setpoints at rest."""
    folder = tmp_path_factory.mktemp("loop")
    point = plant("quadruple-tank").point
    paths = [written(model, folder, "2.0") for model in (process_of("quadruple-tank"), pi_model())]
    return *paths, folder, point.measurements[:2]


def by_libcosim(tank_path, controller_path, levels) -> np.ndarray:
    """Return measurements and manipulated variables after each step [scans, 4]."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(step_size=SECOND)

    def added(path, name):
        place = execution.add_local_slave(CosimLocalSlave(str(path), name))
        variables = execution.slave_variables(place)
        return place, {v.name.decode(): v.reference for v in variables}

    tank, of_tank = added(tank_path, "tank")
    controller, of_controller = added(controller_path, "controller")
    for k in (1, 2):
        execution.connect_real_variables(
            tank, of_tank[f"level_{k}"], controller, of_controller[f"level_{k}.pv"]
        )
        execution.connect_real_variables(
            controller, of_controller[f"pump_{k}.out"], tank, of_tank[f"pump_{k}"]
        )
        setpoint = of_controller[f"level_{k}.sp"]
        execution.real_initial_value(controller, setpoint, float(levels[k - 1]))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    rows = []
    for scan in range(SCANS):
        if scan == CHANGE:
            manipulator.slave_real_values(controller, [of_controller["level_1.sp"]], [SETPOINT])
        assert execution.step()
        measured = [of_tank[f"level_{k}"] for k in (1, 2)]
        moved = [of_controller[f"pump_{k}.out"] for k in (1, 2)]
        rows.append(
            [
                *observer.last_real_values(tank, measured),
                *observer.last_real_values(controller, moved),
            ]
        )
    return np.array(rows)


def by_fmpy(tank_path, controller_path, folder, levels) -> np.ndarray:
    """Do the same step by step: both step together, then each gets what the other one shows."""
    tank, controller = Imported(tank_path, folder), Imported(controller_path, folder)
    controller.set({f"level_{k}.sp": levels[k - 1] for k in (1, 2)})
    tank.enter()
    controller.enter()

    def exchange():
        controller.set({f"level_{k}.pv": tank.get(f"level_{k}") for k in (1, 2)})
        tank.set({f"pump_{k}": controller.get(f"pump_{k}.out") for k in (1, 2)})

    exchange()
    tank.fmu.exitInitializationMode()
    controller.fmu.exitInitializationMode()
    rows = []
    for scan in range(SCANS):
        if scan == CHANGE:
            controller.set({"level_1.sp": SETPOINT})
        for fmu in (tank, controller):
            fmu.step(float(scan), 1.0)
        exchange()
        shown = [tank.get(f"level_{k}") for k in (1, 2)]
        rows.append([*shown, *(controller.get(f"pump_{k}.out") for k in (1, 2))])
    tank.close()
    controller.close()
    return np.array(rows)


def test_the_loop_runs_as_in_fmpy_bit_for_bit(loop):
    tank, controller, folder, levels = loop
    found = by_libcosim(tank, controller, levels)
    expected = by_fmpy(tank, controller, folder, levels)
    assert np.array_equal(found, expected)


def test_the_loop_rests_and_then_reaches_its_setpoint(loop):
    tank, controller, _, levels = loop
    found = by_libcosim(tank, controller, levels)
    assert found[:CHANGE, :2] == pytest.approx(np.tile(levels, (CHANGE, 1)), abs=1e-9)
    assert found[-1, :2] == pytest.approx([SETPOINT, levels[1]], abs=0.02)
