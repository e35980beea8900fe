"""What the page of one controller shows."""

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.report.controller_page import controller_page

STUDY = (
    flow_cascade(duration="1 min", at="10 s", by="2 %")
    + """\
[controllers.single.loops.level]
measurement = "level"
output = "duty"
actions = "P"
action = "direct"
gain = "3 %/%"
"""
)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    path = tmp_path_factory.mktemp("cascade") / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    result = cl.study(path)
    return {
        candidate.controller.name: controller_page(result, place)
        for place, candidate in enumerate(result.ranking)
    }


def test_a_cascade_shows_its_inner_setpoint_and_a_single_loop_has_none(pages):
    assert "inner setpoint of duty_flow" in pages["cascade"].picture
    assert "inner setpoint" not in pages["single"].picture


def test_the_time_at_the_limits_of_the_inner_setpoint_is_among_the_scores(pages):
    titles = {name: [row[0] for table in page.scores for row in table.rows]
              for name, page in pages.items()}  # fmt: skip
    assert "Time at a setpoint limit" in titles["cascade"]
    assert "Time at a setpoint limit" not in titles["single"]


def test_each_of_the_first_controllers_shows_the_blocks_of_its_export(pages):
    assert ">loop_flow_asks<" in pages["cascade"].blocks_picture
    assert ">level_check<" in pages["single"].blocks_picture
    assert "loop_flow" not in pages["single"].blocks_picture
