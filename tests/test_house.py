"""What the checks refuse in a test: a clock, by whatever name it comes."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / ".ci"))

from clocks import clocks, read_in  # noqa: E402


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
