"""Digits that the document on three tanks leaves out, and the poles that the others make."""

import numpy as np
import pytest
from plain_three_tanks import characteristic, gains_for, optimal_poles


@pytest.fixture(scope="module")
def rows(audited):
    return {(row.place, row.name): row for row in audited("three-tanks").rows}


@pytest.mark.parametrize(
    ("key", "printed", "right", "beside", "made"),
    [
        (
            ("Table 2", "K1, -5 ± j5"),
            (1.0, 214.0, 36710.0), 0.768, (-40.0, -5 + 5j), (-57.9, -3.60 + 4.65j),
        ),
        (
            ("Table 3", "K1, R = 0.001"),
            (0.2, 29.1, 3120.5), 0.169, (-5.5, -2.8 + 4.8j), (-8.10, -2.51 + 3.85j),
        ),
    ],
)  # fmt: skip
def test_two_gains_make_other_poles_in_the_digits_that_are_printed(
    rows, key, printed, right, beside, made
):
    for K, wanted, near in ((printed, made, 2e-3), ((right, *printed[1:]), beside, 2e-2)):
        poles = np.roots(characteristic(np.array(K)))
        (pair,) = poles[poles.imag > 1e-6]
        (real,) = poles[abs(poles.imag) < 1e-6].real
        assert (real, pair) == pytest.approx(wanted, rel=near)
    words = f"{made[0]:.3g} and {made[1].real:.3g} ± j{made[1].imag:.3g}".replace("-", "−")
    assert words in rows[key].reason
    assert rows[key].computed == pytest.approx(right, rel=3e-3)
    # 1.0e+04 * [0.0001 0.0214 3.6710], as four decimals under one factor.
    factor = 10.0 ** np.floor(np.log10(printed[2]))
    gains = gains_for(np.poly([beside[0], beside[1], np.conj(beside[1])]).real)
    if key[0] == "Table 3":
        gains = gains_for(np.poly(optimal_poles(1e-3)).real)
    shares = [f"{gain / factor:.4f}" for gain in gains]
    assert [factor * float(each) for each in shares] == pytest.approx(printed, rel=1e-12)
    assert f"{factor:.0f} [{' '.join(shares)}]" in rows[key].reason


def test_one_entry_makes_other_poles_in_the_digit_that_is_printed(rows):
    """det(s I - A) of the printed matrix by hand: -46.0 and -22.0 ± j23.1 with 0.03."""
    place = "closed loop with precompensator"

    def poles(a21, a13=-6e7, a33=-0.04):
        a11, a12, a22, a23 = -90.0, -101300.0, -0.058, 0.026
        pairs = a11 * a22 - a12 * a21 + a11 * a33 + a22 * a33 - a23 * a23
        whole = a11 * (a22 * a33 - a23 * a23) - a12 * a21 * a33 + a13 * a21 * a23
        found = np.roots([1.0, -(a11 + a22 + a33), pairs, -whole])
        return found[abs(found.imag) < 1e-6].real[0], found[found.imag > 1e-6][0]

    assert poles(0.03) == pytest.approx((-46.0, -22.0 + 23.1j), rel=2e-3)
    assert poles(0.032) == pytest.approx((-40.0, -25.0 + 25.0j), rel=7e-3)
    assert poles(0.0322) == pytest.approx((-40.0, -25.0 + 25.0j), rel=1e-2)
    row = rows[place, "A21"]
    assert row.verdict == "misprint"
    assert "0.03 makes −46 and −22 ± j23.1, up to 15 % off" in row.reason
    # A13 and A33 have one digit as well, and move nothing.
    assert poles(0.0322, a13=-59951844.0, a33=-0.0371) == pytest.approx(poles(0.0322), rel=2e-3)
    for name in ("A13", "A33"):
        assert rows[place, name].verdict == "reproduced"
        assert "In fewer digits than its neighbours, but" in rows[place, name].reason


@pytest.mark.parametrize(
    ("key", "printed", "made", "off"),
    [
        (("Table 2", "K1, -25 ± j25"), (1.4, 1560.0, 923188.0), "−42 and −24.5 ± j24.3", 5),
        (("Table 3", "K1, R = 0.01"), (0.11, 13.4, 980.7), "−3.53 and −1.87 ± j3.44", 7),
    ],
)
def test_two_gains_in_two_digits_move_a_pole_and_are_no_misprints(rows, key, printed, made, off):
    poles = np.roots(characteristic(np.array(printed)))
    real, pair = poles[abs(poles.imag) < 1e-6].real[0], poles[poles.imag > 1e-6][0]
    words = f"{real:.3g} and {pair.real:.3g} ± j{pair.imag:.3g}".replace("-", "−")
    assert words == made and rows[key].verdict == "reproduced"
    assert f"In two digits, as K1 of other rows: as printed it makes the poles {made}, up to " in (
        rows[key].reason
    )
    beside = {"Table 2": -40.0, "Table 3": -3.8}[key[0]]
    assert round(100 * abs(real / beside - 1.0)) == off
