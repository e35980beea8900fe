"""What a design loads: its own formula, and the machinery once it is asked for a controller."""

import subprocess
import sys

import pytest

PROGRAM = """
import sys
from clepsydra.designs.{module} import {function}
print(sum(name.partition(".")[0] == "clepsydra" for name in sys.modules))
"""
#: Modules of Clepsydra that a design may load as it is imported.
MOST = 33


@pytest.mark.parametrize(
    ("module", "function"),
    [
        ("simc", "design_simc"),
        ("lambda_tuning", "design_lambda"),
        ("amigo", "design_amigo"),
        ("tyreus_luyben", "design_tyreus_luyben"),
        ("ziegler_nichols", "design_ziegler_nichols"),
    ],
)
def test_a_rule_loads_little(module, function):
    program = PROGRAM.format(module=module, function=function)
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert int(found.stdout) <= MOST
