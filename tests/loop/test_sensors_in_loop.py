"""A loop whose controller sees its level through a real transmitter."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.reader import load_process

ONE_TANK = (Path(__file__).parents[1] / "one-tank.toml").read_text(encoding="utf-8")
STEP = 0.05e-3  # [A]


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Loop:
    """One tank with a transmitter of 4 to 20 mA for 0 to 20 cm, lagged, noisy and rounded."""
    head, _ = ONE_TANK.split("[sensors.")
    path = tmp_path_factory.mktemp("plant") / "plant.toml"
    path.write_text(
        head + '[sensors.level_1]\ntank = "tank_1"\nspan = ["0 cm", "20 cm"]\n'
        'range = ["4 mA", "20 mA"]\nlag = "2 s"\nnoise = "1 %"\nresolution = "0.05 mA"\n',
        encoding="utf-8",
    )
    analysis = analyse(load_process(path))
    return Loop(design_simc(analysis.model, analysis.pairing), analysis.model)


def test_noise_of_the_scenario_is_that_of_the_sensor(loop: Loop) -> None:
    scenario = default_scenario(loop.model)
    noise = scenario.noise[scenario.noise[:, 0] != 0.0, 0]
    # 1 % of 16 mA; the standard error of a deviation is 1 / √(2 n) of it.
    assert noise.size > 100
    assert np.std(noise) == pytest.approx(0.16e-3, rel=4 / np.sqrt(2 * noise.size))


def test_noise_of_a_disturbance_stays_in_its_segment() -> None:
    process = replace(load_process("quadruple-tank"), noise={"inflow_2": 1e-7})
    noisy = default_scenario(analyse(process).model)
    quiet = default_scenario(analyse(load_process("quadruple-tank")).model)
    assert np.array_equal(noisy.noise, quiet.noise)
    moved = noisy.disturbances - quiet.disturbances
    within = noisy.time >= noisy.segments[-1].start
    column = [signal.name for signal in process.disturbances].index("inflow_2")
    deviation = np.std(moved[within, column])
    assert deviation == pytest.approx(1e-7, rel=4 / np.sqrt(2 * np.sum(within)))
    moved[within, column] = 0.0
    assert not np.any(moved)


def test_an_analyser_holds_the_noise_of_its_reading() -> None:
    """Read, disturbed and rounded when it is read; told 8 samples later, and every 12 samples."""
    file = Path(__file__).parents[2] / "docs" / "examples" / "analyser.toml"
    analysis = analyse(load_process(f"{file}:seldom"))
    scenario = default_scenario(analysis.model)
    run = Loop(design_simc(analysis.model, analysis.pairing), analysis.model).run(scenario)
    read = run.true_measurement("strength") + scenario.noise[:, 1]
    told = run.values["strength"]
    assert np.ptp(scenario.noise[:, 1]) > 1.0
    for sample in range(18, scenario.samples, 12):
        following = told[sample : sample + 12]
        assert np.all(following == following[0])
        assert following[0] == pytest.approx(read[sample - 8], rel=1e-13)


@pytest.mark.thorough
@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_the_controller_gets_what_the_transmitter_shows(loop: Loop, solver: str) -> None:
    scenario = default_scenario(loop.model)
    # Noise so large that the signal meets both of its limits.
    scenario = replace(scenario, noise=100.0 * scenario.noise)
    run = loop.run(scenario, solver=solver)
    true = 4e-3 + 16e-3 * run.values["level_1.lagged"] / 0.2
    assert np.allclose(run.true_measurement("level_1"), true, rtol=1e-13, atol=0.0)
    rounded = np.floor((true + scenario.noise[:, 0]) / STEP + 0.5) * STEP
    expected = np.clip(rounded, 3.8e-3, 20.5e-3)
    shown = run.values["level_1"]
    # Rounding of the true reading may move a sample that stands between two steps.
    moved = np.abs(shown - expected) > 1e-15
    assert np.mean(moved) < 1e-3
    assert np.sum(shown == 3.8e-3) > 10
    assert np.sum(shown == 20.5e-3) > 10


@pytest.mark.thorough
def test_both_solvers_agree(loop: Loop) -> None:
    """A reading between two steps may be rounded either way, which moves the level by less."""
    scenario = default_scenario(loop.model)
    kernel, reference = loop.run(scenario), loop.run(scenario, solver="reference")
    step_in_level = STEP * 0.2 / 16e-3
    for name in ("tank_1.level", "level_1.lagged"):
        assert np.max(np.abs(kernel.values[name] - reference.values[name])) < 0.1 * step_in_level


def test_a_sensor_that_is_out_of_range_does_not_follow(loop: Loop) -> None:
    """Scores of a run see the level, the controller a signal that stands at 20.5 mA."""
    process = loop.process
    assert float(process.display([25e-3])) == 20.5e-3
    assert float(process.measure([0.25, 0.25], process.parameter_values)) == pytest.approx(24e-3)
