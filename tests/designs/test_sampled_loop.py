"""The sampled loop against a second model in plain numpy, and against simulated divergence."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import SampledLoop, SampledLoops, sampled_loop
from clepsydra.designs.sampled.sensitivity_peaks import sensitivity_peaks
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"
AREA, HOLE, GAIN, GRAVITY, VOLTAGE = 28e-4, 0.071e-4, 3.33e-6, 9.81, 1.5


def tank_rates() -> tuple[float, float]:
    """Return a and b of Δḣ = a Δh + b Δu at rest: q = k u = hole √(2 g h)."""
    flow = GAIN * VOLTAGE
    level = (flow / HOLE) ** 2 / (2 * GRAVITY)
    return -flow / (2 * level) / AREA, GAIN / AREA


def with_settings(controller: Controller, gain: float, integral_time: float) -> Controller:
    values = dict(controller.values)
    for y in controller.measurements:
        values[f"{y}.proportional_gain"] = gain
        values[f"{y}.integral_time"] = integral_time
        values[f"{y}.tracking_time"] = integral_time
    return replace(controller, values=values)


class OneTank:
    """The single tank at some sampling period, under a PI controller of any setting."""

    def __init__(self, folder, period: float):
        path = folder / f"one-tank-{period}.toml"
        text = ONE_TANK.read_text().replace('"1 s"', f'"{period} s"')
        path.write_text(text)
        self.process: Process = load_process(path)
        self.period = period
        analysis = analyse(self.process)
        self.point = analysis.operating_point
        self.model = linearise(self.point)
        self.simc = design_simc(analysis.model, analysis.pairing)
        a, b = tank_rates()
        self.held = np.exp(a * period)
        self.moved = b * (self.held - 1.0) / a

    def sampled(self, gain: float, integral_time: float) -> SampledLoop:
        return sampled_loop(with_settings(self.simc, gain, integral_time), self.model)

    def closed(self, gain: float, integral_time: float) -> np.ndarray:
        """Return the closed loop's matrix over level and integral.

        h⁺ = φ h + γ u,  u = -K h + I,  I⁺ = I - K T/Ti h.
        """
        return np.array(
            [
                [self.held - self.moved * gain, self.moved],
                [-gain * self.period / integral_time, 1.0],
            ]
        )

    def peak(self, gain: float, integral_time: float) -> float:
        """Return max |S|, S = 1/(1 + L), L(z) = γ/(z - φ) · K (1 + T/(Ti (z - 1)))."""

        def sensitivity(angle):
            z = np.exp(1j * angle)
            controller = gain * (1 + self.period / integral_time / (z - 1))
            return np.abs(1 / (1 + self.moved / (z - self.held) * controller))

        return refined_peak(sensitivity)


def refined_peak(sensitivity) -> float:
    """Return the maximum of a function of many angles, by a sweep and a search near its best."""
    angles = np.concatenate([np.geomspace(1e-6, np.pi, 20001), np.linspace(1e-3, np.pi, 20001)])
    angles.sort()
    values = sensitivity(angles)
    best = int(np.argmax(values))
    low, high = angles[max(best - 1, 0)], angles[min(best + 1, len(angles) - 1)]
    found = minimize_scalar(
        lambda angle: -sensitivity(np.array([angle]))[0],
        bounds=(low, high),
        options={"xatol": 1e-12},
    )
    return max(float(values[best]), -float(found.fun))


@pytest.fixture(scope="module", params=[1.0, 10.0])
def tank(request, tmp_path_factory) -> OneTank:
    return OneTank(tmp_path_factory.mktemp("tank"), request.param)


def critical_gain(tank: OneTank, integral_time: float) -> float:
    """Jury: with an eigenvalue at -1, 1 + trace + determinant is zero."""
    share = tank.period / integral_time
    return 2 * (1 + tank.held) / (tank.moved * (2 - share))


@pytest.mark.parametrize("share", [0.05, 0.3, 0.8, 0.97])
@pytest.mark.parametrize("periods", [3.0, 40.0])
def test_maximum_sensitivity_is_the_peak_of_a_brute_force_sweep(tank, share, periods):
    integral_time = periods * tank.period
    gain = share * critical_gain(tank, integral_time)
    sampled = tank.sampled(gain, integral_time)
    assert np.max(np.abs(np.linalg.eigvals(tank.closed(gain, integral_time)))) < 1
    assert sampled.is_stable
    expected = tank.peak(gain, integral_time)
    assert expected > 1.001
    assert sampled.maximum_sensitivity == pytest.approx(expected, rel=1e-8)


def test_the_eigenvalues_are_those_of_the_second_model(tank):
    integral_time = 5 * tank.period
    gain = 0.4 * critical_gain(tank, integral_time)
    own = np.linalg.eigvals(tank.closed(gain, integral_time))
    sampled = np.linalg.eigvals(tank.sampled(gain, integral_time).A)
    # Other states of the law, such as the last output, are not fed back: eigenvalues at zero.
    kept = sampled[np.abs(sampled) > 1e-9]
    assert np.sort_complex(kept) == pytest.approx(np.sort_complex(own), rel=1e-10)


def test_the_direct_term_is_the_identity(tank):
    assert np.array_equal(tank.sampled(10.0, 20.0).D, np.eye(1))


@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_stability_is_what_the_simulation_does(tank, factor):
    """After a setpoint step of a micrometre the pump's swing dies out or grows by its mode."""
    integral_time = 50 * tank.period
    gain = factor * critical_gain(tank, integral_time)
    sampled = tank.sampled(gain, integral_time)
    stable = factor < 1
    assert sampled.is_stable == stable
    assert np.isinf(sampled.maximum_sensitivity) == (not stable)

    samples = 120
    level = float(tank.point.measurements[0])
    scenario = Scenario(
        sampling_period=tank.period,
        setpoints=np.full((samples, 1), level) + 1e-6 * (np.arange(samples) > 0)[:, None],
        disturbances=np.zeros((samples, len(tank.process.disturbances))),
        noise=np.zeros((samples, 1)),
        segments=(),
        seed=1,
    )
    controller = with_settings(tank.simc, gain, integral_time)
    run = Loop(controller, tank.model).run(scenario)
    swing = np.abs(np.diff(run.values["pump_1"]))
    growth = np.max(swing[90:100]) / np.max(swing[20:30])
    # The mode near -1 swings from sample to sample; the integral's own is slow and smooth.
    eigenvalue = np.min(np.linalg.eigvals(tank.closed(gain, integral_time)).real)
    assert (growth > 1) == (eigenvalue < -1) == (not stable)
    assert growth == pytest.approx(eigenvalue**70, rel=0.05)


@pytest.mark.parametrize("distance", [-1e-6, 1e-6])
def test_the_limit_of_stability_is_that_of_jury(tank, distance):
    integral_time = 50 * tank.period
    gain = (1 + distance) * critical_gain(tank, integral_time)
    assert tank.sampled(gain, integral_time).is_stable == (distance < 0)


def test_two_coupled_loops_against_a_sweep_of_singular_values():
    """S = (I + N G K)⁻¹ of the quadruple tank, sampled by a Taylor series of its own."""
    process = load_process("quadruple-tank-nonminimum-phase")
    analysis = analyse(process)
    point = analysis.operating_point
    model = linearise(point)
    controller = design_simc(analysis.model, analysis.pairing)
    period = process.sampling_period
    A, B, C = model.A, model.B, model.C[:2]
    held, integral, term = np.zeros((4, 4)), np.zeros((4, 4)), np.eye(4)
    for k in range(1, 30):
        held, integral = held + term, integral + term * period / k
        term = term @ A * period / k
    moved = integral @ B
    gains, wires = [], np.zeros((2, 2))
    for y, u in zip(controller.measurements, controller.manipulated, strict=True):
        wires[model.inputs.index(u), process.controlled.index(y)] = 1
        gains.append((u, *(controller.values[f"{y}.{n}"] for n in
                           ("proportional_gain", "integral_time"))))  # fmt: skip
    of_input = {u: (K, Ti) for u, K, Ti in gains}

    def sensitivity(angles):
        z = np.exp(1j * angles)[:, None]
        law = np.hstack(
            [of_input[u][0] * (1 + period / of_input[u][1] / (z - 1)) for u in model.inputs]
        )
        reached = C @ np.linalg.solve(z[..., None] * np.eye(4) - held, moved)
        loop = reached * law[:, None, :] @ wires
        return np.linalg.svd(np.linalg.inv(np.eye(2) + loop), compute_uv=False)[:, 0]

    # Both sensors have the same range, so that no scaling is seen.
    sampled = sampled_loop(controller, model)
    assert sampled.maximum_sensitivity == pytest.approx(refined_peak(sensitivity), rel=1e-8)


def together(loops: list[SampledLoop]) -> SampledLoop:
    return SampledLoop(*map(np.array, zip(*loops, strict=True)))


def test_peaks_of_many_loops_are_those_of_each(tank):
    largest = critical_gain(tank, 30.0)
    loops = [tank.sampled(share * largest, 30.0) for share in (0.1, 0.3, 1.1, 0.5)]
    found = sensitivity_peaks(together(loops)).values.tolist()
    assert found == [each.maximum_sensitivity for each in loops]
    assert np.isfinite(found).tolist() == [True, True, False, True]


def test_peaks_of_loops_that_are_all_unstable_are_infinite(tank):
    unstable = [tank.sampled(share * critical_gain(tank, 30.0), 30.0) for share in (1.1, 2.0)]
    assert sensitivity_peaks(together(unstable)).values.tolist() == [np.inf, np.inf]


def test_the_peak_of_a_loop_without_a_state_is_that_of_its_direct_way():
    gain = SampledLoop(
        np.zeros((1, 0, 0)), np.zeros((1, 0, 1)), np.zeros((1, 1, 0)), np.eye(1)[None]
    )
    assert sensitivity_peaks(gain).values.tolist() == [1.0]


def test_many_loops_of_a_controller_at_once_are_those_of_each(tank):
    values, key = tank.simc.values, f"{tank.simc.measurements[0]}.proportional_gain"
    gains = critical_gain(tank, 30.0) * np.array([0.1, 1.1])
    loops = SampledLoops(tank.simc, tank.model)
    ((places, stack),) = loops.each(values | {key: gains})
    assert places.tolist() == [0, 1]
    for place, gain in enumerate(gains.tolist()):
        one = loops.at(values | {key: gain})
        assert all(np.array_equal(whole[place], own) for whole, own in zip(stack, one, strict=True))
