"""Lets the tests of this folder import the models by hand of the designs' tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
