"""What a page says of units before a regulator is switched on, so that wrong ones are seen."""

import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig

RESPONSES = f"""
import {{ errorResponse, lastingSamples }} from "{source("lab/error_responses.ts")}";
const matrixOf = ([rows, columns, values]) =>
  ({{ rows, columns, values: Float64Array.from(values) }});
const [A, B, C, D] = given.matrices.map(matrixOf);
answer([given.periods.map(lastingSamples), errorResponse({{ A, B, C, D }}, 1, 0, 0.01, 40)]);
"""
CHOICES = f"""
import {{ unitChoices }} from "{source("lab/units_asked.ts")}";
const {{ signals, laws }} = given.data;
answer(given.asked.map((names) => unitChoices(names.map((name) => ({{
  signal: signals.find((each) => each.name === name),
  percent: laws.percent[name],
  others: laws.units[name] ?? [],
}})))));
"""


def test_an_error_that_stays_moves_an_output_by_gain_and_integral(tmp_path):
    # PI control from y − r by the second error: K = 3, and 0.2 more with each sample.
    matrices = [[1, 1, [1.0]], [1, 2, [5.0, -0.2]], [1, 1, [1.0]], [1, 2, [7.0, -3.0]]]
    given = {"matrices": matrices, "periods": [0.05, 1.0, 30.0, 1e-4]}
    samples, (first, last) = answered(RESPONSES, given, tmp_path)
    assert samples == [1200, 60, 60, 5000]
    assert first == pytest.approx(0.03, rel=1e-12)
    assert last == pytest.approx(0.01 * (3 + 40 * 0.2), rel=1e-12)


def test_units_of_a_variant_of_the_process_are_offered(tmp_path):
    plant = cl.load("laboratory-four-tanks")
    data = page_data(Rig(plant.linear, [cl.design.simc(plant)]))
    asked = [["level_1", "level_2"], ["pump_1", "pump_2"]]
    levels, pumps = answered(CHOICES, {"data": data, "asked": asked}, tmp_path)
    assert [each["words"] for each in levels] == ["%, as shown here", "V: 1 V = 20 %"]
    assert [each["words"] for each in pumps] == ["%, as shown here", "V: 1 V = 6.667 %"]
    # 25 cm are 5 V, and 15 V all that a pump has.
    assert levels[1]["scales"] == pytest.approx([0.2, 0.2], rel=1e-9)
    assert pumps[1]["scales"] == pytest.approx([1 / 15, 1 / 15], rel=1e-9)
