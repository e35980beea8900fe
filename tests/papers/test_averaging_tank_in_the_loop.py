"""Hardware in the loop without a clock: what cards do to the document's loops."""

from pathlib import Path

import numpy as np
import pytest

from clepsydra.hil.wire_check import as_it_is
from clepsydra.papers.averaging_tank.hardware_in_the_loop import counted, run, scanned
from clepsydra.papers.averaging_tank.range_controllers import controller_of
from clepsydra.papers.averaging_tank.step_run import model_of, step_run

PAGE = (Path(__file__).parents[2] / "docs/papers/averaging-tank.md").read_text("utf-8")
#: A count of C [mol/m³] and of V [m³].
COUNTS = {"concentration": 25e3 / 27648, "volume": 6.0 / 27648}


@pytest.mark.parametrize("law", ["PI", "LQI"])
def test_without_cards_it_is_the_document_s_own_experiment(law):
    """The loop that the tables of the document are computed with, without a shell.

    Its kernel fuses multiplications and additions, and rounds less often.
    """
    found = scanned(law, as_it_is)
    plain = step_run(controller_of("outflow", law, 0.01), model_of("outflow", 0.01, high=True))
    for name, column in found.true.items():
        assert np.ptp(column) > 0.04 * column[0]
        assert column == pytest.approx(plain.true_measurement(name)[: len(column)], rel=1e-12)


@pytest.mark.parametrize("law", ["PI", "LQI"])
def test_cards_move_it_by_about_a_count(law):
    """A setpoint and a measurement are rounded by half a count each."""
    found = scanned(law, counted)
    for name, count in COUNTS.items():
        assert 0.1 * count < found.largest(name) < 1.5 * count


def test_the_page_and_the_picture_say_so():
    (figure,) = run()
    for panel, (name, step) in zip(
        figure.panels, (("concentration", 250.0), ("volume", 0.1)), strict=True
    ):
        largest = [100.0 * scanned(law, counted).largest(name) / step for law in ("PI", "LQI")]
        drawn = [np.max(np.abs(curve.y)) for curve in panel.curves]
        assert drawn == pytest.approx(largest)
        assert "{} by {:.2f} and {:.2f} %".format(panel.title, *largest) in PAGE
    for law in ("PI", "LQI"):
        exact = scanned(law, as_it_is)
        assert all(np.array_equal(exact.simulated[n], y) for n, y in exact.true.items())
