"""The process of a soft PLC imports what it scans with, and no numeric library."""

import subprocess
import sys

HEAVY = ("casadi", "llvmlite", "numpy", "pandas", "scipy")


def test_it_begins_at_once():
    code = "import sys, clepsydra.hil.soft_plc, clepsydra.hil.commands; "
    code += f"print([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
