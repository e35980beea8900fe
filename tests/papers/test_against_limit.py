"""The page of the physical limit has what its experiments give, and says who is nearer.

Limits and published controllers are run anew, all of them; ours, whose studies take longer, in
`tests/cli/test_papers.py`.
"""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from clepsydra.base.signal import Signal
from clepsydra.papers.against_limit import (
    AgainstLimit,
    Entrant,
    Outcome,
    contests_of,
    outcome_of,
)
from clepsydra.papers.document import documents, load_document
from clepsydra.papers.limit_page import page_text

PAGE = Path(__file__).parents[2] / "docs" / "papers" / "against-the-limit.md"
EXPERIMENTS = [
    (key, title) for key, document in documents().items() for title in contests_of(document)
]
#: What the last digits of linear algebra and of a search may change a multiple of a limit by, and
#: the rounding to three digits.
TOLERANCE = 0.01


def rows_of(key, title):
    """Return the rows of a table of the page by controller and whose it is, its cells as text."""
    _, _, part = PAGE.read_text("utf-8").partition(f"## {load_document(key).title}\n")
    _, _, table = re.split(r"\n## ", part)[0].partition(f"### {title}\n")
    cells = [
        line.strip("|").split(" | ")
        for line in re.split(r"\n### ", table)[0].splitlines()
        if line.startswith("| ")
    ]
    return {(row[0].strip(" †‡"), row[1]): row[2:] for row in cells[2:]}


def overview():
    """Return the rows of the first table of the page by document and experiment."""
    lines = re.findall(r"^\| ([a-z-]+) \| ([^|]+) \| ([^|]+) \|", PAGE.read_text("utf-8"), re.M)
    return {(key, title): float(least) for key, title, least in lines if key in documents()}


def test_every_experiment_stands_on_the_page():
    assert list(overview()) == EXPERIMENTS
    for key, title in EXPERIMENTS:
        whose = [whose for _, whose in rows_of(key, title)]
        assert whose.count("ours, recommended") == 1 and "published" in whose


@pytest.mark.thorough
@pytest.mark.parametrize(("key", "title"), EXPERIMENTS)
def test_limits_and_published_controllers_are_those_of_the_page(key, title):
    found, rows = outcome_of(key, title, ours=False), rows_of(key, title)
    assert found.proved
    assert overview()[key, title] == pytest.approx(found.limit, rel=TOLERANCE)
    published = [name for name, whose in rows if whose == "published"]
    assert sorted(published) == sorted(each.name for each in found.entrants)
    for each in found.entrants:
        error, times, peak, left = rows[each.name, "published"]
        # How far an unstable loop has come in the end hangs on the last digits.
        tolerance = 0.1 if math.isinf(each.peak) else TOLERANCE
        assert float(error) == pytest.approx(each.error, rel=tolerance)
        assert float(times) == pytest.approx(each.times, rel=tolerance)
        assert (peak == "unstable") == math.isinf(each.peak)
        assert math.isinf(each.peak) or float(peak) == pytest.approx(each.peak, rel=TOLERANCE)
        assert each.works or left.strip(" |") or math.isinf(each.peak)
        assert each.times > 0.995


LEVEL, PUMP = Signal("level", "m", low=0.0, high=1.0), Signal("pump", "V", low=0.0, high=10.0)
OURS = Entrant("PI, SIMC", False, True, False, True, 12.0, 1.2, 1.3, {"level": 0.0}, {"pump": 0.0})
THEIRS = replace(OURS, name="PID", published=True, recommended=False, error=20.0, times=2.0)
FAILED = replace(
    THEIRS, name="LQR", integrates=False, peak=math.inf, left={"level": 0.5}, swings={"pump": 1.0}
)


def page_of(*entrants):
    steps = ((LEVEL, 0.1),)
    outcome = Outcome("eight-tanks", "Every minute", 10.0, True, steps, (PUMP,), 60.0, entrants)
    return page_text(AgainstLimit((outcome,)))


def test_who_is_nearer_and_who_fails_is_told():
    said = page_of(OURS, THEIRS, FAILED)
    assert "In 1 of 1 experiments a controller of ours comes nearer to the best possible" in said
    assert "at worst in eight-tanks, Every minute, at 1.20 times" in said
    assert "| LQR ‡ | published | 20.0 | 2.00 | unstable | level 50 % |" in said
    assert (
        "LQR: unstable at this sampling period; level ends 50 % of its step away, pump still "
        "swings over up to 100 % of the range." in said
    )
    assert (
        "Steps of level by +0.1 m; pump 0 to 10 V; 60 s. The least possible error is 10.0 s."
        in said
    )


def test_where_the_document_is_nearer_it_is_told():
    said = page_of(replace(THEIRS, times=1.05), OURS)
    assert "In 0 of 1 experiments" in said
    assert (
        "the nearest of ours, PI, SIMC, is behind the document's PID, 1.20 against 1.05 times, "
        "with a max|S| of 1.30 against 1.30." in said.replace("\\", "")
    )


def test_where_none_of_the_document_works_it_is_told():
    said = page_of(OURS, FAILED)
    assert "in 1 of the experiments none of them works" in said and "none works" in said
