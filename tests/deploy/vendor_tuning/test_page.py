"""The page on vendors' blocks: its tables are the blocks, its example is what is computed."""

import math
from pathlib import Path

import pytest
from page_rows import entry, table_row
from plants import designed

from clepsydra import PidForm
from clepsydra.deploy.vendor_tuning.translation import translate
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK

PAGE = (Path(__file__).parents[3] / "docs" / "vendor-tuning.md").read_text(encoding="utf-8")
FLOWING = " ".join(PAGE.split())


@pytest.fixture(scope="module")
def example():
    controller = designed("simc", "three-tanks", form=PidForm("PID"))
    return translate(controller, controller.plant.process)


@pytest.mark.parametrize("block", EVERY_BLOCK, ids=lambda block: block.key)
def test_the_page_describes_every_block(block):
    assert table_row(block) in PAGE
    assert entry(block) in FLOWING


def test_the_example_s_lines_are_those_of_the_translation(example):
    lines = PAGE.split("## An example")[1].splitlines()
    shown = [line for line in lines if line.startswith("| ") and not line.startswith("| block")]
    computed = {line.rsplit("|", 2)[0] + "|" for line in example.as_markdown().splitlines()}
    assert len(shown) == 6
    assert set(shown) <= computed


def test_the_example_s_formulas_give_its_numbers(example):
    """By hand, from the five digits that the page starts from."""
    ti, td, tf = 217.78, 23.926, 2.3926
    percent = 8.1694 * 70 / 100
    q = math.sqrt((ti - tf) ** 2 - 4 * ti * td)
    series_time = (ti + tf + q) / 2
    lead = ti * td / (series_time - tf)
    for number, text in (
        (percent, "5.7186 %/%"),
        (100 / percent, "17.487 %"),
        (ti / 60, "3.6296 min"),
        (td / 60, "0.39877 min"),
        (percent / (ti / 60), "1.5755 1/min"),
        (percent * td / 60, "2.2804 min"),
        (q, "159.84 s"),
        (series_time, "190.01 s"),
        (lead, "27.773 s"),
        (percent * series_time / ti, "4.9893 %/%"),
        (tf / lead, "0.086148"),
    ):
        assert text in FLOWING
        assert float(text.split()[0]) == pytest.approx(number, rel=5e-5)
    numbers = example.tunings[0].settings
    assert numbers.integral_time == pytest.approx(ti, rel=3e-5)
    assert numbers.filter_time == pytest.approx(tf, rel=3e-5)
