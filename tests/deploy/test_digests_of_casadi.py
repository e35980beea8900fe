"""Another version of CasADi writes single loops otherwise, and they have the same digest.

Skipped unless CLEPSYDRA_OTHER_CASADI names a folder that pip has put CasADi 3.7.0 into:
`pip install --no-deps --target FOLDER casadi==3.7.0`.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from families import family

from clepsydra.deploy.printing.heading import digest

NAMES = ("PI, SIMC", "PID, phase margin", "PI, variable structure", "PI, gain scheduling",
         "LQI with Kalman filter", "Feedback linearisation", "Smith predictor, PI")  # fmt: skip
SCRIPT = """
import sys
from families import family
from clepsydra.deploy.printing.heading import digest
for name in sys.argv[1:]:
    print(digest(family(name)[1].program))
"""

pytestmark = pytest.mark.thorough


def test_single_loops_have_one_digest():
    folder = os.environ.get("CLEPSYDRA_OTHER_CASADI", "")
    if not Path(folder, "casadi").is_dir():
        pytest.skip("CLEPSYDRA_OTHER_CASADI names no folder with another CasADi")
    path = os.pathsep.join([folder, *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *NAMES],
        env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.split() == [digest(family(name)[1].program) for name in NAMES]
