"""CLAIMS names tests and their tier; this one fails when a named test is not there or elsewhere."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
NAMED = re.findall(r"`(tests/[\w/]+\.py)::(\w+)`(?: \((\w+)\))?", (ROOT / "CLAIMS.md").read_text())
#: Those of their own, beside the fast one.
TIERS = ("thorough", "browser")


@cache
def tiers(file: str) -> dict[str, str]:
    """Return the tier in which each test of a file runs, empty for the fast one."""
    tree = ast.parse((ROOT / file).read_text())
    whole = [
        ast.unparse(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark"
    ]
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            marks = {*whole, *map(ast.unparse, node.decorator_list)}
            found[node.name] = next((t for t in TIERS if f"pytest.mark.{t}" in marks), "")
    return found


def test_claims_name_tests():
    assert len(NAMED) >= 15


@pytest.mark.parametrize(("file", "test", "tier"), NAMED)
def test_a_named_test_exists_in_the_tier_that_is_said(file, test, tier):
    assert tiers(file)[test] == tier
