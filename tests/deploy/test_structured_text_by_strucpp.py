"""Printed text through STruC++, the newer compiler of OpenPLC: it runs as the engine does.

The compiler is skipped where it is not: name its cli.js by CLEPSYDRA_STRUCPP. What it does not
take is looked for in the text in any case.
"""

import re

import numpy as np
import pytest
from deployed import all_bits
from families import IN_DOUBLE, family
from strucpp import CompiledByStrucpp, Strucpp
from tools import need_grammar

from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.deploy.proof.text.tree import content, parse, walk
from clepsydra.deploy.structured_text.printer import print_structured_text

OFTEN = ("PI, SIMC", "Smith predictor, PI")
NAMES = [
    pytest.param(name, marks=[] if name in OFTEN else [pytest.mark.thorough]) for name in IN_DOUBLE
]


@pytest.mark.parametrize("name", NAMES)
def test_the_text_has_nothing_that_it_does_not_take(name):
    """No NOT of a bracketed AND or OR, no repetition in an array, no literal before what it is
    compared with, no SEL as a condition, no output to an array; and nothing is asked twice."""
    need_grammar()
    ready = family(name)[1]
    root = parse(print_structured_text(ready.program, origin=ready.origin, dialect="matiec"))
    for node in walk(root):
        text = " ".join(content(node).split()) if node.type != "source_file" else ""
        assert node.type != "array_repetition", text
        assert not re.match(r"(MIN|MAX)\(-?\d|(IF|ELSIF) SEL\(", text), text
        assert not re.search(r"=> \w+\[", text), text
        if node.type == "unary_expression" and text.startswith("NOT ("):
            assert not re.search(r"\b(AND|OR)\b", text), text
        if node.type == "binary_expression":
            assert not re.fullmatch(r"(\w+) (AND|OR) \1", text), text


@pytest.mark.thorough
@pytest.mark.parametrize("dialect", ["matiec", "codesys"])
@pytest.mark.parametrize("name", IN_DOUBLE)
def test_a_controller_runs_as_in_the_engine(name, dialect, tmp_path):
    """With whatever goes wrong in a plant, bit for bit."""
    Strucpp()
    program, period = family(name)[1].program, family(name)[1].process.sampling_period
    inputs = random_scans(program, 1000, 1, period)
    found = CompiledByStrucpp(program, tmp_path, dialect).run(inputs)
    np.testing.assert_array_equal(all_bits(found), all_bits(engine_run(program, inputs)))
