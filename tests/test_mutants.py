"""The drawing of mutants: what is changed, and where."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

import mutants


@pytest.mark.parametrize(
    ("line", "changed"),
    [
        ("y = a + b", {"(a - b)"}),
        ("y = a < b", {"(a <= b)"}),
        ("y = a and not b", {"(a or not b)", "(b)"}),
        ("y = 2", {"(3)"}),
        ("y = 0.0", {"(1.0)"}),
        ("y = [True, 2.0]", {"(False)", "(3.0)"}),
        ("y: list[3] = f(x)", set()),
        ('y = f"{x + 1}"', set()),
        ('"""Text."""', set()),
    ],
)
def test_one_operator_or_number_of_a_line_is_changed(line, changed, tmp_path):
    path = tmp_path / "ä.py"
    path.write_text(f"# ä\n{line}\n", encoding="utf-8")
    found = list(mutants.mutants(path))
    assert {each.new for each in found} == changed
    assert all(each.line == 2 for each in found)


def test_positions_count_bytes(tmp_path):
    path = tmp_path / "one.py"
    path.write_text('x = ("ä", 1)\n', encoding="utf-8")
    (only,) = mutants.mutants(path)
    text = path.read_bytes()
    assert (
        text[: only.start] + only.new.encode() + text[only.end :]
    ).decode() == 'x = ("ä", (2))\n'


def test_the_same_seed_draws_the_same(monkeypatch):
    monkeypatch.setattr(mutants, "SOURCE", mutants.ROOT / mutants.SOURCE / "base")
    assert mutants.drawn(5, 1) == mutants.drawn(5, 1) != mutants.drawn(5, 2)
