"""What the page gives a loop, beside what the study gave it, in every bit."""

import numpy as np
from hosted_report import inputs_of, live_of
from page_in_node import source

SCRIPT = f"""
import {{ inputsOf }} from "{source("live/inputs.ts")}";
answer(await inputsOf(given));
"""


def test_noise_of_sensors_and_pumps_is_made_again_in_the_page(studied, node):
    result = studied("laboratory-four-tanks")
    scenario, data = result.scenario, live_of(result)
    found = np.reshape(node(SCRIPT, data), (scenario.samples, -1))
    assert np.array_equal(found, inputs_of(data))
    columns = {column.tobytes() for column in found.T}
    noisy = [*scenario.noise.T, *(scenario.disturbances - scenario.quiet_disturbances).T]
    given = [*scenario.noise.T, *scenario.disturbances.T]
    assert sum(each.any() for each in noisy) == len(scenario.noises) == 6
    for column in given:
        assert np.ascontiguousarray(column).tobytes() in columns
    packed = [each for each in data["inputs"] if each["noise"]]
    assert len(packed) == 6 and all(each["packed"] is None for each in packed)
