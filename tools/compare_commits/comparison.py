"""The records of two commits, command by command."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

from compare_commits.difference import ABSENT, Bound, Difference, differences
from compare_commits.runner import STOPPED

#: The worst first.
KINDS = ("stopped", "status", "gone", "came", "order", "number", "text")
_WORDS = {
    "stopped": "stopped", "status": "exit status", "gone": "key gone", "came": "key new",
    "order": "other order", "number": "number", "text": "text",
}  # fmt: skip


@dataclass(frozen=True)
class Comparison:
    """What two commits printed, and where it differs.

    Parameters
    ----------
    first, second : dict
        Label of a command to its record.
    """

    first: dict[str, dict[str, Any]]
    second: dict[str, dict[str, Any]]
    bound: Bound
    differences: list[Difference]

    @property
    def left_out(self) -> dict[str, int]:
        """How many times, versions, paths and dates were taken out, of both."""
        count: Counter[str] = Counter({"times": 0, "versions": 0, "paths": 0, "dates": 0})
        for record in (*self.first.values(), *self.second.values()):
            count.update(record["left out"])
        return dict(count)

    @property
    def counts(self) -> dict[str, int]:
        """How many differences of each kind there are, the worst first."""
        found = Counter(difference.kind for difference in self.differences)
        return {kind: found[kind] for kind in KINDS if found[kind]}


def compare(
    first: dict[str, dict[str, Any]], second: dict[str, dict[str, Any]], bound: Bound
) -> Comparison:
    """Compare the records of two commits.

    A command that was stopped is a difference, whatever the other side did.
    """
    found: list[Difference] = []
    for label in sorted({*first, *second}):
        one, other = first.get(label), second.get(label)
        if one is None or other is None:
            kind = "gone" if other is None else "came"
            first_way, second_way = (ABSENT if r is None else "run" for r in (one, other))
            found.append(
                Difference(label, group_of(one or other), ("command",), kind, first_way, second_way)
            )
            continue
        stopped = []
        for name in {**one["shown"], **other["shown"]}:
            ways = [r["shown"].get(name, {}).get("status", ABSENT) for r in (one, other)]
            if STOPPED in ways:
                stopped.append(Difference(label, group_of(one), (name,), "stopped", *ways))
        found += stopped or differences(one["shown"], other["shown"], bound, label, group_of(one))
    return Comparison(first, second, bound, found)


def group_of(record: dict[str, Any] | None) -> str:
    """Return what the differences of a command are counted under."""
    return str(record["group"]) if record else ""


def words_of(kind: str) -> str:
    """Return a kind of difference as it is printed."""
    return _WORDS[kind]
