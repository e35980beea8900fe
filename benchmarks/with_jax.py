"""The case in JAX: vmap of a scan, double precision, on the processor."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from benchmarks.case import (
    GRAVITY,
    HIGH_LIMIT,
    LOW_LIMIT,
    NOMINAL,
    NOMINAL_VOLTAGE,
    SAMPLING_PERIOD,
    SENSOR_GAIN,
    Case,
    Solution,
)


def jax_set_up() -> Any:
    """Return JAX with double precision and full vectors."""
    # XLA is given full-width vectors: 14 % faster on AVX-512 than its own choice.
    flags = os.environ.get("XLA_FLAGS", "")
    if "prefer_vector_width" not in flags:
        os.environ["XLA_FLAGS"] = f"{flags} --xla_cpu_prefer_vector_width=512".strip()
    import jax

    jax.config.update("jax_enable_x64", True)
    return jax


def version() -> str:
    """Return JAX's version."""
    return str(jax_set_up().__version__)


def batch(case: Case) -> Callable[[], Solution]:
    """Return a call that solves all scenarios; its first call compiles.

    This is the fastest form found: scalars apart instead of vectors of four tanks, one sample
    a turn of the scan (two a turn: 0.65 of its speed), the whole batch at once (parts of 64 to
    2,048 scenarios: no faster).
    """
    jax = jax_set_up()
    import jax.numpy as jnp

    def one_scenario(parameters: Any, setpoints: Any, initial_levels: Any) -> Any:
        gains = [SENSOR_GAIN] * 2
        integrals = [jnp.asarray(NOMINAL_VOLTAGE)] * 2
        return closed_loop(parameters, setpoints, gains, list(initial_levels), integrals)

    all_scenarios = jax.jit(jax.vmap(one_scenario, in_axes=(1, None, None)))
    arguments = tuple(
        jax.device_put(values) for values in (case.parameters, case.setpoints, case.initial_levels)
    )

    def run() -> Solution:
        final = jax.block_until_ready(all_scenarios(*arguments))
        return Solution(np.array(final))

    return run


#: Takes the number of a sample and returns the noise of both measurements [V].
Noise = Callable[[Any], Any]


def closed_loop(
    parameters: Any,
    setpoints: Any,
    sensor_gains: Sequence[Any],
    levels: Sequence[Any],
    integrals: Sequence[Any],
    noise: Noise | None = None,
) -> list[Any]:
    """Return what one scenario ends with, in the order of `FINAL`.

    The noise is in what the controllers see, not in the errors that are summed.
    """
    jax = jax_set_up()
    import jax.numpy as jnp

    half, sixth = SAMPLING_PERIOD / 2, SAMPLING_PERIOD / 6
    p = dict(zip(NOMINAL, parameters, strict=True))
    fall = jnp.sqrt(2 * GRAVITY)
    out = [fall * p[f"outlet_area_{t}"] / p[f"tank_area_{t}"] for t in (1, 2, 3, 4)]
    upper = [
        fall * p["outlet_area_3"] / p["tank_area_1"],
        fall * p["outlet_area_4"] / p["tank_area_2"],
    ]
    into = [
        p["split_1"] * p["pump_gain_1"] / p["tank_area_1"],
        p["split_2"] * p["pump_gain_2"] / p["tank_area_2"],
        (1 - p["split_2"]) * p["pump_gain_2"] / p["tank_area_3"],
        (1 - p["split_1"]) * p["pump_gain_1"] / p["tank_area_4"],
    ]
    gain = [p["proportional_gain_1"], p["proportional_gain_2"]]
    integral_gain = [SAMPLING_PERIOD * gain[i] / p[f"integral_time_{i + 1}"] for i in (0, 1)]
    tracking_gain = [SAMPLING_PERIOD / p[f"tracking_time_{i + 1}"] for i in (0, 1)]

    def slope(levels: list[Any], filled: list[Any]) -> list[Any]:
        root = [jnp.sqrt(jnp.maximum(level, 0.0)) for level in levels]
        return [
            filled[0] - out[0] * root[0] + upper[0] * root[2],
            filled[1] - out[1] * root[1] + upper[1] * root[3],
            filled[2] - out[2] * root[2],
            filled[3] - out[3] * root[3],
        ]

    def sample(carried: Any, given: Any) -> Any:
        levels, integral, absolute_error = carried
        setpoint, number = given
        true_error = [setpoint[i] - sensor_gains[i] * levels[i] for i in (0, 1)]
        error = true_error
        if noise is not None:
            seen = noise(number)
            error = [true_error[i] - seen[i] for i in (0, 1)]
        unlimited = [gain[i] * error[i] + integral[i] for i in (0, 1)]
        voltage = [jnp.clip(v, LOW_LIMIT, HIGH_LIMIT) for v in unlimited]
        absolute_error = [
            absolute_error[i] + SAMPLING_PERIOD * jnp.abs(true_error[i]) for i in (0, 1)
        ]
        integral = [
            integral[i]
            + integral_gain[i] * error[i]
            + tracking_gain[i] * (voltage[i] - unlimited[i])
            for i in (0, 1)
        ]
        pump_of_tank = (0, 1, 1, 0)
        filled = [into[t] * voltage[pump_of_tank[t]] for t in range(4)]
        k1 = slope(levels, filled)
        k2 = slope([h + half * k for h, k in zip(levels, k1, strict=True)], filled)
        k3 = slope([h + half * k for h, k in zip(levels, k2, strict=True)], filled)
        k4 = slope([h + SAMPLING_PERIOD * k for h, k in zip(levels, k3, strict=True)], filled)
        levels = [levels[t] + sixth * (k1[t] + 2 * (k2[t] + k3[t]) + k4[t]) for t in range(4)]
        return (levels, integral, absolute_error), None

    start = list(levels), list(integrals), [jnp.asarray(0.0)] * 2
    end, _ = jax.lax.scan(sample, start, (setpoints, jnp.arange(len(setpoints))))
    return [value for group in end for value in group]
