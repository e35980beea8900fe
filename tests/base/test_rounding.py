"""Numbers of so many significant digits."""

import math

import numpy as np
import pytest

from clepsydra.base.rounding import rounded, rounded_matrix


@pytest.mark.parametrize("value", [2.0 / 3.0, -1e-17 / 3.0, 123456.75, 1e300 / 3.0, 9.999999e-5])
@pytest.mark.parametrize("digits", [1, 6, 15])
def test_a_rounded_number_is_the_decimal_of_so_many_digits(value, digits):
    assert rounded(value, digits) == float(f"{value:.{digits - 1}e}")


@pytest.mark.parametrize("value", [0.0, math.inf, -math.inf])
def test_what_has_no_digits_stays(value):
    assert rounded(value, 6) == value


def test_what_is_nothing_beside_the_others_is_zero():
    matrix = np.array([[1.0, 1e-12], [1e-12, 1e-12]])
    assert rounded_matrix(matrix, 6, np.ones((2, 2))).tolist() == [[1.0, 0.0], [0.0, 0.0]]
    sizes = np.array([[1.0, 1e-6], [1e-6, 1e-12]])
    assert rounded_matrix(matrix, 6, sizes).tolist() == matrix.tolist()
