"""What the page tells of a run that was tried, in Node."""

import pytest
from page_in_node import source

SCRIPT = f"""
import {{ warnings }} from "{source("live/told.ts")}";
const outcome = (seconds) => ({{
  ran: {{ spills: [], limits: [], bands: [{{ name: "level", seconds }}] }}, analysed: null,
}});
const before = given.before === null ? undefined : outcome(given.before);
answer(warnings(outcome(given.now), before, {{ columns: [], period: 10 }}, "recommended"));
"""


@pytest.mark.parametrize(
    ("before", "now", "told"),
    [
        (None, 16851.0, ["Loads drive level out of its band for 4.68\u00a0h."]),
        (60.0, 90.0, ["Loads drive level out of its band for 90\u00a0s (recommended 60\u00a0s)."]),
        (60.0, 65.0, []),  # by less than a sample
        (60.0, 0.0, []),
    ],
)
def test_a_level_out_of_its_band_is_told_where_it_was_not_so_before(before, now, told, node):
    assert node(SCRIPT, {"before": before, "now": now}) == told
