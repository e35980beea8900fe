"""The setpoint that a cascade gives to its inner loop: recorded, counted, and told."""

from functools import cache

import numpy as np
import pandas
import pytest
from flow_cascade import flow_cascade

import clepsydra as cl

# The gain of the outer loop, 3 % of 60 l/s for 1 % of 16 mA [m³/(s A)].
GAIN = -3.0 * 0.06 / 0.016
NAME = "duty_flow.inner_setpoint"


@pytest.fixture(scope="module")
def cascade(tmp_path_factory):
    """Return a function: what differs in the study → its only candidate."""

    @cache
    def tried(**words: str) -> cl.Candidate:
        path = tmp_path_factory.mktemp("cascade") / "study.toml"
        path.write_text(flow_cascade(**words), encoding="utf-8")
        return cl.study(path).best

    return tried


def test_it_is_what_the_outer_loop_asks_for_in_the_same_sample(cascade):
    run, quiet = cascade(noise="true").run, cascade().run
    rest = quiet.values[NAME][0]
    assert rest == pytest.approx(quiet.values["duty_flow"][0], rel=1e-12)
    asked = rest + GAIN * (run.values["level.setpoint"] - run.values["level"])
    assert run.values[NAME] == pytest.approx(np.clip(asked, 0.0, 0.035), abs=1e-12)
    assert np.ptp(run.values[NAME]) > 1e-3
    # Up by 5 %, which the pump answers by less flow.
    step = round(120.0 / run.scenario.sampling_period)
    assert run.values[NAME][step] < run.values[NAME][step - 1] - 5e-3


@pytest.mark.thorough
def test_both_solvers_record_it_and_it_stands_in_the_table(cascade, tmp_path):
    controller = cascade().controller
    events = [cl.step("level", "5 %", at="2 min")]
    kernel, reference = (
        cl.simulate(controller.plant, controller, events, duration="5 min", solver=solver)
        for solver in ("kernel", "reference")
    )
    assert kernel.values[NAME] == pytest.approx(reference.values[NAME], abs=1e-8)
    (signal,) = [s for s in kernel.signals if s.name == NAME]
    assert (signal.unit, signal.high) == ("m^3/s", 0.06)
    kernel.save(tmp_path / "run.parquet")
    table = pandas.read_parquet(tmp_path / "run.parquet")
    assert np.array_equal(table[NAME], kernel.values[NAME])


@pytest.mark.parametrize(
    ("by", "end", "limit", "shown"),
    [("-9 %", "high", 0.021, "21 l/s"), ("45 %", "low", 0.0, "0 l/s")],
)
def test_a_cascade_that_saturates_at_its_inner_setpoint_is_told(cascade, by, end, limit, shown):
    """Down by 9 % at 3 %/% asks for 16 l/s more than at rest, where the limit allows no more than
    a little; up by 45 % for no flow, while the inflow fills the well."""
    found = cascade(by=by, high="21 l/s")
    values = found.run.values[NAME]
    stood = np.sum(np.abs(values - limit) < 1e-12)
    period = found.run.scenario.sampling_period
    assert found.scores["time_at_setpoint_limit[duty_flow]"] == stood * period
    share = stood / values.size
    assert share > 0.5
    told = [words for words in found.warnings if "inner setpoint" in words.lower()]
    assert told == [
        f"The inner setpoint of duty_flow stands at a limit for {100 * share:.0f} % of the time, "
        f"mostly at its {end} limit of {shown}: the outer loop controls nothing for most of it; "
        f"widen setpoint_{end} of the inner loop, or ask for less."
    ]


def test_a_cascade_with_room_is_not(cascade):
    found = cascade()
    assert not [words for words in found.warnings if "inner setpoint" in words.lower()]
    assert found.scores["time_at_setpoint_limit[duty_flow]"] == 0.0
