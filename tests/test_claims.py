"""CLAIMS names tests and their tier; this one fails when a named test is not there or elsewhere."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
NAMED = re.findall(r"`(tests/[\w/]+\.py)::(\w+)`( \(thorough\))?", (ROOT / "CLAIMS.md").read_text())


@cache
def tiers(file: str) -> dict[str, bool]:
    """Return whether each test of a file runs in the thorough tier only."""
    tree = ast.parse((ROOT / file).read_text())
    whole = any(
        isinstance(node, ast.Assign)
        and ast.unparse(node.targets[0]) == "pytestmark"
        and "pytest.mark.thorough" in ast.unparse(node.value)
        for node in tree.body
    )
    return {
        node.name: whole or "pytest.mark.thorough" in map(ast.unparse, node.decorator_list)
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
    }


def test_claims_name_tests():
    assert len(NAMED) >= 15


@pytest.mark.parametrize(("file", "test", "thorough"), NAMED)
def test_a_named_test_exists_in_the_tier_that_is_said(file, test, thorough):
    assert tiers(file)[test] == bool(thorough)
