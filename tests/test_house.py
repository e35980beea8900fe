"""What the checks refuse: in a test a clock, by whatever name it comes; in the source a label."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / ".ci"))

from clocks import clocks, read_in  # noqa: E402
from labels import FREE, OWN_NAMES, decided_in, labels  # noqa: E402


@pytest.mark.parametrize(
    "text",
    [
        "import time\nbegin = time.perf_counter()",
        "import time as t\nbegin = t.process_time()",
        "import os\nbegin = os.times()",
        "import datetime\nbegin = datetime.datetime.now()",
        "import datetime as d\nbegin = d.date.today()",
        "from datetime import datetime as moment\nbegin = moment.utcnow()",
    ],
)
def test_a_clock_that_is_read_is_found(text):
    assert clocks(text) == [2]


@pytest.mark.parametrize(
    "text",
    [
        "from time import monotonic_ns",
        "from time import thread_time as spent",
        "import timeit",
        "from timeit import default_timer",
        "from resource import getrusage",
    ],
)
def test_a_clock_that_is_imported_is_found(text):
    assert clocks(text) == [1]


def test_sleeping_and_times_of_a_run_are_no_clocks():
    text = "import time\ntime.sleep(1)\nrun.time[0]\nprofile(x)\nnp.array(t.time)\n"
    assert clocks(text) == []


def test_no_test_reads_a_clock_but_where_it_waits(tmp_path):
    assert read_in(ROOT / "tests") == []
    (tmp_path / "waiting.py").write_text("import time\ntime.monotonic()\n")
    (tmp_path / "test_it.py").write_text("import time\nassert time.time() < 1\n")
    (line,) = read_in(tmp_path)
    assert line.startswith(f"{tmp_path / 'test_it.py'}:2: ")


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ('inside = [e for e in elements if e.symbol == "tank"]', "symbol"),
        ('if not controller.family.startswith("multiloop"):\n    pass', "family"),
        ("if controller.family == FAMILY:\n    pass", "family"),
        ("if FAMILY != pid.family:\n    pass", "family"),
        ('known = "PI" in controller.family', "family"),
        ('found = element.symbol in ("pump", "flow")', "symbol"),
        ('if score.name == "variance_ratio":\n    pass', "name"),
        ('stem = signal.name.removesuffix(".level")', "name"),
        ('match e.symbol:\n    case "tank":\n        pass', "symbol"),
        ('size = {"tank": 1.0, "pump": 2.0}[e.symbol]', "symbol"),
        ('match = design.title.endswith("tuned")', "title"),
    ],
)
def test_a_label_that_decides_is_found(text, label):
    assert labels(text) == [(1, label)]


@pytest.mark.parametrize(
    "text",
    [
        "inside = [e for e in elements if e.holds_liquid]",
        "known = {signal.name: signal for signal in signals}\nfound = known[name]",
        "same = signal.name == other.name",
        "first = signal.name == name",
        'said = f"{controller.family} of {plant.title}"',
    ],
)
def test_a_name_that_is_looked_up_or_told_is_no_decision(text):
    assert labels(text) == []


def test_no_label_decides_in_the_source(tmp_path):
    source = ROOT / "src" / "clepsydra"
    assert decided_in(source) == []
    assert all((source / path).exists() for path in (*OWN_NAMES, *FREE))
    (tmp_path / "score.py").write_text('wears = score.name == "travel"\n')
    (line,) = decided_in(tmp_path)
    assert line.startswith(f"{tmp_path / 'score.py'}:1: a name decides")
