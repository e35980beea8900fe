"""Lets the tests of this folder import the interpreter and the random blocks of the programs."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "program"))
