"""Lets the tests of FMUs import their helpers by name, and leaves them out where they cannot run.

They need FMPy and a C compiler; with CLEPSYDRA_REQUIRE_TOOLS=1 they run, and fail, without.
"""

import importlib.util
import os
import sys
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.deploy.compiler import find_compiler

sys.path.insert(0, str(Path(__file__).parent))


def _tools() -> bool:
    try:
        find_compiler("tests of FMUs")
    except InputError:
        return False
    return importlib.util.find_spec("fmpy") is not None


if not _tools() and os.environ.get("CLEPSYDRA_REQUIRE_TOOLS") != "1":
    collect_ignore_glob = ["test_*.py"]
