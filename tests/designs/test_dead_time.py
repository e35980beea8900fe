"""Designs for a process with dead time, against the formulas and a brute-force sweep."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.models.transfer_element import transfer_element
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.process.reader import load_process

FILE = Path(__file__).parents[1] / "dead-time.toml"
STUDY = f"""
process = "{FILE}"
[scenario]
duration = "5 min"
[[scenario.setpoint]]
signal = "level_2"
at = "10 s"
by = "1 cm"
"""


def process_with(folder, delay, period=2.0):
    path = folder / f"delay-{delay}-{period}.toml"
    text = FILE.read_text().replace('"5 s"', f'"{delay} s"').replace('"2 s"', f'"{period} s"')
    path.write_text(text)
    return load_process(path)


def element_of(process):
    return transfer_element(analyse(process).model, "level_2", "feed")


def test_the_element_has_the_dead_time_and_the_phase_of_it(tmp_path):
    late, prompt = element_of(process_with(tmp_path, 5.0)), element_of(process_with(tmp_path, 0.1))
    assert (late.dead_time, prompt.dead_time) == (5.0, 0.1)
    assert late.gain == pytest.approx(prompt.gain, rel=1e-12)
    assert prompt.phase(0.3) - late.phase(0.3) == pytest.approx(0.3 * 4.9, rel=1e-12)


def test_simc_takes_dead_time_and_half_the_smaller_lag_for_delay(tmp_path):
    process = process_with(tmp_path, 30.0)
    analysis = analyse(process)
    times = sorted(-1.0 / analysis.poles.real)
    theta, tau = 30.0 + 1.0 + times[0] / 2, times[1] + times[0] / 2
    slope = abs(analysis.static_gain[0, 0]) / tau
    chosen = design_simc(analysis.model, analysis.pairing, closed_loop_time_constant=theta)
    assert chosen.values["level_2.proportional_gain"] == pytest.approx(
        1 / (slope * 2 * theta), rel=1e-9
    )
    assert chosen.values["level_2.integral_time"] == pytest.approx(min(tau, 8 * theta), rel=1e-9)


def test_phase_margin_is_exact_with_dead_time(tmp_path):
    analysis = analyse(process_with(tmp_path, 20.0))
    omega = 0.008
    made = design_phase_margin(analysis.model, analysis.pairing, crossover=omega)
    gain, time = made.values["level_2.proportional_gain"], made.values["level_2.integral_time"]
    s = 1j * omega
    fast, slow = -analysis.poles.real[::-1]
    plant = analysis.static_gain[0, 0] * fast * slow / ((s + fast) * (s + slow))
    loop = plant * np.exp(-s * 21.0) * gain * (1 + 1 / (time * s))
    assert abs(loop) == pytest.approx(1.0, rel=1e-9)
    assert np.degrees(np.angle(loop)) == pytest.approx(-120.0, abs=1e-7)


@pytest.mark.parametrize("delay", [4.0, 5.0, 37.3])
def test_the_sensitivity_peak_is_that_of_a_sweep(tmp_path, delay):
    process, period = process_with(tmp_path, delay), 2.0
    analysis = analyse(process)
    model = linearise(analysis.operating_point)
    made = design_simc(analysis.model, analysis.pairing)
    gain, time = made.values["level_2.proportional_gain"], made.values["level_2.integral_time"]
    # The held process by partial fractions of its step response, shifted by the dead time.
    fast, slow = -analysis.poles.real[::-1]
    static = analysis.static_gain[0, 0]

    def step(t):
        rest = (fast * np.exp(-slow * t) - slow * np.exp(-fast * t)) / (fast - slow)
        return np.where(t > 0, static * (1 - rest), 0.0)

    k = np.arange(8000)
    pulses = np.diff(step(period * k - delay), prepend=0.0)
    omegas = np.linspace(1e-4, np.pi / period, 6000)
    z = np.exp(1j * omegas * period)
    plant = np.polynomial.polynomial.polyval(1 / z, pulses)
    # The law uses its integral before it adds the new error.
    loop = plant * gain * (1 + period / time / (z - 1))
    peak = float(np.max(1 / np.abs(1 + loop)))
    found = sampled_loop(made, model).maximum_sensitivity
    assert found == pytest.approx(peak, rel=1e-5)


def test_too_high_a_gain_for_the_dead_time_is_unstable(tmp_path):
    process = process_with(tmp_path, 37.3)
    analysis = analyse(process)
    made = design_simc(analysis.model, analysis.pairing)
    wild = replace(made, values={**made.values, "level_2.proportional_gain": 0.02})
    assert sampled_loop(wild, linearise(analysis.operating_point)).maximum_sensitivity == np.inf


def test_lqi_refuses_dead_time_in_words():
    with pytest.raises(NotApplicable, match="dead time"):
        design_lqi(analyse(load_process(FILE)).model)


def test_a_study_goes_through(tmp_path):
    """Those for which a step is a matter of states refuse, each in words, and the others run."""
    designs = ("simc", "phase_margin", "lqi_kalman", "lqi", "pole_placement")
    file = tmp_path / "compare.toml"
    wanted = [f'[controllers.{design}]\ndesign = "{design}"' for design in designs]
    file.write_text("\n".join([STUDY, *wanted]))
    result = cl.study(file)
    reasons = dict(result.not_applicable)
    assert reasons.keys() == {"lqi", "pole_placement"}
    assert all("dead time" in reason for reason in reasons.values())
    assert {each.controller.name for each in result.ranking} == set(designs) - reasons.keys()
    assert all(1.0 < each.maximum_sensitivity <= 2.0 + 1e-6 for each in result.ranking)
