"""Linear models, equilibria and gains of the catalogue against the numbers of their documents.

Tolerances are half a unit of the last printed digit, unless the comment beside them says why not.
Where a document contradicts its own equations, the test names the misprint.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from clepsydra import LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import Derivatives, linearise
from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.process.reader import load_process


def model_of(name: str) -> LinearModel:
    return linearise(find_equilibrium(load_process(name)))


def averaging(variant: str, inputs: list[str]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A, B and C in the document's order: x = (C, V), y = (C, V), the given inputs.

    The document's V is our level over 1 m². Our concentration is in mol/m³ where the document
    writes kmol/m³: it scales B's entry of a flow, which is zero at C_in = C, and no other.
    """
    model = model_of(f"averaging-tank:{variant}")
    assert model.inputs == tuple(inputs)
    states = [model.states.index(name) for name in ("tank.impurity", "tank.level")]
    outputs = [model.outputs.index(name) for name in ("concentration", "volume")]
    return model.A[np.ix_(states, states)], model.B[states], model.C[np.ix_(outputs, states)]


# Kolankowski and Piotrowski, section 2.2, the equilibrium under equation (34).
F, V = 0.2, 2.0


def test_averaging_tank_with_constant_outflow() -> None:
    """Equation (32) with (f_in, C_in, C, V) = (0.2, 5, 5, 2)."""
    A, B, C = averaging("outflow-constant", ["inflow", "inflow.impurity"])
    np.testing.assert_allclose(A, [[-F / V, 0], [0, 0]], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(B, [[0, F / V], [1, 0]], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(C, np.eye(2), rtol=1e-15)


def test_averaging_tank_with_constant_inflow() -> None:
    """Equation (34)."""
    A, B, C = averaging("inflow-constant", ["outflow", "inflow.impurity"])
    np.testing.assert_allclose(A, [[-F / V, 0], [0, 0]], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(B, [[0, F / V], [-1, 0]], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(C, np.eye(2), rtol=1e-15)


def test_averaging_tank_with_all_inputs() -> None:
    """Equation (16): f_in and f_out act on V alone, and C_in on C with T = V / f_in = 10 s."""
    A, B, _ = averaging("all-inputs", ["inflow", "outflow", "inflow.impurity"])
    assert -1 / A[0, 0] == pytest.approx(10.0, rel=1e-12)
    np.testing.assert_allclose(B, [[0, 0, 0.1], [1, -1, 0]], rtol=1e-12, atol=1e-9)


def test_averaging_tank_away_from_equal_concentrations() -> None:
    """Equation (32) in general: B11 = (C_in - C) / V, and the sign of A follows from it."""
    process = load_process("averaging-tank")
    assert [signal.name for signal in process.state] == ["tank.level", "tank.impurity"]
    local = Derivatives(process).at(
        np.array([2.0, 5000.0]), np.array([0.2, 7000.0]), np.array([0.2])
    )
    np.testing.assert_allclose(
        local.rates_by_input, [[1, 0], [2000.0 / 2, 0.2 / 2]], rtol=1e-12, atol=1e-12
    )
    assert local.rates_by_state[1, 1] == pytest.approx(-0.1, rel=1e-12)
    # Ċ = f (C_in - C) / V, so dĊ/dV = -f (C_in - C) / V².
    assert local.rates_by_state[1, 0] == pytest.approx(-0.2 * 2000 / 4, rel=1e-12)


def three_tanks_at_printed_levels() -> tuple[np.ndarray, np.ndarray]:
    """A and B where Nagammai and Latha linearise, at the levels of table 1: no equilibrium."""
    local = Derivatives(load_process("three-tanks")).at(
        np.array([0.5, 0.45, 0.4]), np.array([50e-6]), np.array([0.0])
    )
    return local.rates_by_state, local.rates_by_input


def test_three_tanks_matrices() -> None:
    """Nagammai and Latha, equation (2)."""
    A, B = three_tanks_at_printed_levels()
    printed = [[-0.0322, 0.0322, 0], [0.0322, -0.0578, 0.0257], [0, 0.0257, -0.0371]]
    # The sum 0.0578 of the middle is 0.05789: the document adds its rounded terms or cuts off.
    np.testing.assert_allclose(A, printed, rtol=0, atol=1.0e-4)
    # 1 / 0.0154 is 64.935: printed cut off, as 64.93.
    np.testing.assert_allclose(B, [[64.93], [0], [0]], rtol=0, atol=0.01)


def test_three_tanks_transfer_function() -> None:
    """Equation (3): 0.054 / (s³ + 0.1272 s² + 0.0035 s + 9.4e-6)."""
    A, B = three_tanks_at_printed_levels()
    denominator = np.poly(A)
    numerator = A[2, 1] * A[1, 0] * B[0, 0]
    assert numerator == pytest.approx(0.054, abs=0.0005)
    assert denominator[1] == pytest.approx(0.1272, abs=0.0001)  # a sum of rounded terms
    assert denominator[2] == pytest.approx(0.0035, abs=0.00005)
    assert denominator[3] == pytest.approx(9.4e-6, abs=0.05e-6)
    # K_p: 5744 is printed; (3) as printed gives 5745, and the exact constants 5711.
    assert numerator / denominator[3] == pytest.approx(5711, abs=0.5)


def test_three_tanks_equilibrium() -> None:
    """The printed parameters at 50 cm³/s: Δh = (q / (a C))² / 2g for each opening."""
    point = find_equilibrium(load_process("three-tanks")).as_dict()
    levels = [point[f"tank_{i}.level"] for i in (1, 2, 3)]
    np.testing.assert_allclose(levels, [0.1816, 0.1306, 0.0510], rtol=0, atol=0.5e-4)
    falls = [(50e-6 / (5e-5 * c)) ** 2 / (2 * 9.81) for c in (1.0, 0.8, 1.0)]
    np.testing.assert_allclose(levels, np.cumsum(falls[::-1])[::-1], rtol=1e-10)


def test_three_tanks_corrected() -> None:
    """Table 1: 0.5, 0.45 and 0.4 m; C1 = 1 is printed and leaves level 1 one millimetre off."""
    point = find_equilibrium(load_process("three-tanks", "corrected")).as_dict()
    levels = [point[f"tank_{i}.level"] for i in (1, 2, 3)]
    np.testing.assert_allclose(levels[1:], [0.45, 0.4], rtol=0, atol=1e-5)
    assert levels[0] - 0.45 == pytest.approx(1 / (2 * 9.81), abs=1e-5)


@pytest.mark.parametrize(("variant", "gain"), [("paper", 3.08), ("corrected", 1 / 0.3925)])
def test_eight_tanks(variant: str, gain: float) -> None:
    """Bobál et al., equations (3) to (8), in minutes: each tank is gain / (2 s + 1)."""
    model = model_of(f"eight-tanks:{variant}")
    A, feed = model.A * 60, model.B[:, [model.inputs.index("feed")]]  # [1/min], [m per m³]
    # The first six digits of 1/3.08 and 2/3.08 stand in the file.
    time_constant = 2.0
    expected = (np.eye(8, k=-1) - np.eye(8)) / time_constant
    np.testing.assert_allclose(A, expected, rtol=3e-6, atol=1e-12)
    per_minute = 1 / 60  # of a static gain [s/m²] to [min/m²]
    every = LinearModel(
        model.A, feed, model.E, np.eye(8), np.zeros((8, 1)), model.states, ("feed",),
        model.disturbances, model.states,
    )  # fmt: skip
    np.testing.assert_allclose(static_gain(every) * per_minute, gain, rtol=3e-6)
    assert (static_gain(model) * per_minute)[0, 0] == pytest.approx(gain, rel=3e-6)

    # Step of 0.04 m³/min (section 3.2): h8 = K Δq (1 - exp(-t/T) Σ (t/T)^k / k!, k = 0..7).
    C = model.C[model.outputs.index("level_8")]
    for minutes in (5.0, 16.0, 40.0):
        share = minutes / time_constant
        waiting = math.exp(-share) * sum(share**k / math.factorial(k) for k in range(8))
        joined = np.zeros((9, 9))
        joined[:8, :8], joined[:8, 8:] = model.A, feed
        response = C @ expm(joined * minutes * 60)[:8, 8] * 0.04 / 60
        assert response == pytest.approx(gain * 0.04 * (1 - waiting), rel=1e-4)


# Feng, Yu and Wang, tables 1 and 2 [cm] and equations (22) to (25) [cm²].
LABORATORY = {
    "laboratory-four-tanks:report": (
        [19.775, 27.325, 13.9, 23.5], [0.1563, 0.1283, 0.0637, 0.0566], 0.625,
    ),
    "laboratory-four-tanks-nonminimum-phase:report": (
        [19.0, 27.25, 6.0, 9.25], [0.1538, 0.1331, 0.1617, 0.1504], 0.375,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", LABORATORY)
def test_laboratory_levels_at_7_5_volts(name: str) -> None:
    printed, areas, _ = LABORATORY[name]
    for variants, voltage in ((f"{name},volts", 7.5), (f"{name},percent", 0.5)):
        process = load_process(variants)
        point = find_equilibrium(process, inputs={"pump_1": voltage, "pump_2": voltage}).as_dict()
        for i, (level, area) in enumerate(zip(printed, areas, strict=True), 1):
            # h ~ (k/a)²: half a digit of the area and half a digit of k count twice.
            tolerance = 2 * (0.5e-4 / area + 0.005 / 3.74)
            assert 100 * point[f"tank_{i}.level"] == pytest.approx(level, rel=tolerance)


@pytest.mark.parametrize("name", LABORATORY)
def test_laboratory_matrices(name: str) -> None:
    """Equations (9) and (10), from the printed areas at the levels of the operating point."""
    _, areas, gamma = LABORATORY[name]
    model = model_of(f"{name},volts")
    assert model.point is not None
    levels = model.point.state
    section, k = 15.5179e-4, np.array([4.32e-6, 3.74e-6])
    t = section / (np.array(areas) * 1e-4) * np.sqrt(2 * levels / 9.81)
    A = -np.diag(1 / t)
    A[0, 2], A[1, 3] = 1 / t[2], 1 / t[3]
    B = np.zeros((4, 2))
    B[0, 0], B[1, 1] = gamma * k / section
    B[3, 0], B[2, 1] = (1 - gamma) * k / section
    np.testing.assert_allclose(model.A, A, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(model.B, B, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(model.C, 20 * np.eye(4), rtol=1e-12)  # k_c = 0.2 V/cm


@pytest.mark.parametrize(
    ("name", "gain"),
    [("laboratory-four-tanks", 1.5625), ("laboratory-four-tanks-nonminimum-phase", -0.5625)],
)
def test_laboratory_relative_gains(name: str, gain: float) -> None:
    """Equations (19) and (20)."""
    model = model_of(name).select(outputs=["level_1", "level_2"])
    np.testing.assert_allclose(
        relative_gain_array(static_gain(model)),
        [[gain, 1 - gain], [1 - gain, gain]],
        rtol=1e-9,
    )


@pytest.mark.parametrize(
    ("variant", "levels"), [("report", [10.9, 11.3]), ("fitted", [15.0, 15.0])]
)
def test_laboratory_manual_control(variant: str, levels: list[float]) -> None:
    """Exercise 2.2.3: 44 % and 24 % print 15 cm in both tanks; the report's own areas do not."""
    point = find_equilibrium(load_process("laboratory-four-tanks", variant)).as_dict()
    assert (point["pump_1"], point["pump_2"]) == (0.44, 0.24)
    found = [100 * point[f"tank_{i}.level"] for i in (1, 2)]
    np.testing.assert_allclose(found, levels, rtol=0, atol=0.05)
