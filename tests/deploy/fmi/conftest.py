"""Lets the tests of FMUs import their helpers by name, and skips them where they cannot run.

They need FMPy, which they and their helpers import, and a C compiler.
"""

import sys
from pathlib import Path

import pytest
from tools import REQUIRE, missing

sys.path.insert(0, str(Path(__file__).parent))


@pytest.hookimpl(tryfirst=True)
def pytest_make_collect_report(collector: pytest.Collector) -> pytest.CollectReport | None:
    reason = "" if REQUIRE else missing("fmpy", compiler=True)
    if not reason or not collector.path.is_file():
        return None
    return pytest.CollectReport(collector.nodeid, "skipped", (str(collector.path), 1, reason), [])
