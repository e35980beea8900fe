"""Lets the tests of this folder import the interpreter by name, and what benchmarks solve."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
sys.path.append(str(Path(__file__).parents[2]))
