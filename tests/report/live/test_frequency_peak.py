"""max|S| in the page, beside Python's, of loops of every process of the catalogue."""

import math

import numpy as np
import pytest
from page_in_node import source

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import SampledLoop, sampled_loop

SCRIPT = f"""
import {{ eigenvalues }} from "{source("live/eigenvalues.ts")}";
import {{ largestGain }} from "{source("live/frequency_peak.ts")}";
answer(given.map((system) => {{
  const of = Object.fromEntries(Object.entries(system).map(
    ([name, {{ rows, columns, values }}]) =>
      [name, {{ rows, columns, values: Float64Array.from(values) }}]));
  return largestGain(of, eigenvalues(of.A));
}}));
"""
DESIGNS = ("simc", "lqi", "lqi_kalman", "smith_predictor", "glover_mcfarlane", "recomputed_lqi")
#: Each search stops where a maximum can rise by no more than this share.
RISE = 1e-9


def peaks_in_page(node, systems):
    names = "ABCD"
    given = [
        {name: {"rows": m.shape[0], "columns": m.shape[1], "values": m.ravel().tolist()}
         for name, m in zip(names, system, strict=True)}
        for system in systems
    ]  # fmt: skip
    return np.array(node(SCRIPT, given))


@pytest.mark.sampled
@pytest.mark.parametrize("process", [entry.name for entry in cl.catalogue()])
def test_loops_have_the_peak_that_python_finds(process, node):
    plant, loops = cl.load(process), []
    for name in DESIGNS:
        try:
            loops.append(sampled_loop(getattr(cl.design, name)(plant), plant.measured))
        except cl.NotApplicable:
            continue
    expected = np.array([loop.maximum_sensitivity for loop in loops])
    assert len(loops) >= 3 and np.all(np.isfinite(expected))
    np.testing.assert_allclose(peaks_in_page(node, loops), expected, rtol=2 * RISE)


def test_random_loops_have_the_peak_that_python_finds(node):
    """With one to five outputs, resonances, and peaks at rest and at half the sampling rate."""
    random, loops = np.random.default_rng(2), []
    for _ in range(60):
        n, q = int(random.integers(1, 15)), int(random.integers(1, 6))
        A = random.normal(size=(n, n))
        A *= random.uniform(0.3, 0.999) / max(np.abs(np.linalg.eigvals(A)))
        B, C = random.normal(size=(n, q)), random.normal(size=(q, n))
        loops.append(SampledLoop(A, B, C, np.eye(q)))
    expected = [loop.maximum_sensitivity for loop in loops]
    np.testing.assert_allclose(peaks_in_page(node, loops), expected, rtol=2 * RISE)


def test_a_resonance_has_its_peak_in_closed_form(node):
    """1/(s² + 2 ζ s + 1) with the frequencies of s = (z − 1)/(z + 1): 1/(2 ζ √(1 − ζ²))."""
    zeta, one = 0.003, np.eye(2)
    A = np.array([[0.0, 1.0], [-1.0, -2.0 * zeta]])
    inverse = np.linalg.inv(one - A)
    B, C = np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
    image = ((one + A) @ inverse, math.sqrt(2.0) * inverse @ B, math.sqrt(2.0) * C @ inverse,
             C @ inverse @ B)  # fmt: skip
    expected = 1.0 / (2.0 * zeta * math.sqrt(1.0 - zeta**2))
    np.testing.assert_allclose(peaks_in_page(node, [image]), expected, rtol=2 * RISE)
