"""A comparison as a screen of text, as all of it, and as JSON."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterable
from typing import Any

from compare_commits.commits import Commit
from compare_commits.comparison import KINDS, Comparison, words_of
from compare_commits.difference import ABSENT, Difference
from compare_commits.plan import SAMPLED

_GROUPS = 7  # shown on one screen, each in two lines
_WIDTH = 100
_PLACE = 32  # characters of a place in its group's second line
_SHOWN = 34  # and of a value


def screen(comparison: Comparison, first: Commit, second: Commit) -> str:
    """Return how many of what differ, and the first of each kind of place."""
    groups = _grouped(comparison.differences)
    lines = [*_head(comparison, first, second)]
    for found in groups[:_GROUPS]:
        lines += _group(found)
    if len(groups) > _GROUPS:
        lines.append(f"... and {len(groups) - _GROUPS} more kinds of place")
    if groups:
        lines.append("Every difference: --all")
    return "\n".join([*lines, *_foot(comparison)])


def whole(comparison: Comparison, first: Commit, second: Commit) -> str:
    """Return every difference, a command after the other."""
    lines = [*_head(comparison, first, second)]
    command = None
    for difference in comparison.differences:
        if difference.command != command:
            command = difference.command
            lines.append(command)
        lines.append(f"  {words_of(difference.kind):<11} {_said(difference)}")
    return "\n".join([*lines, *_foot(comparison)])


def document(comparison: Comparison, first: Commit, second: Commit) -> str:
    """Return the comparison as JSON; numbers that JSON has no form for become text."""
    found = {
        "first": {"named": first.named, "key": first.key, "commands": len(comparison.first)},
        "second": {"named": second.named, "key": second.key, "commands": len(comparison.second)},
        "bound": comparison.bound.relative,
        "floor": comparison.bound.floor,
        "left_out": comparison.left_out,
        "sampled": SAMPLED,
        "counts": comparison.counts,
        "differences": [
            {
                "command": one.command,
                "place": one.place,
                "kind": words_of(one.kind),
                "first": one.first,
                "second": one.second,
                **({"relative": one.size} if one.kind == "number" else {}),
            }
            for one in comparison.differences
        ],
    }
    return json.dumps(_plain(found), indent=2, ensure_ascii=False, allow_nan=False)


def _head(comparison: Comparison, first: Commit, second: Commit) -> list[str]:
    found, bound = comparison.differences, comparison.bound
    commands = f"{len(comparison.first)} and {len(comparison.second)} commands"
    told = f"numbers to {bound.relative:.0e}, and {bound.floor:.0e} is nothing"
    head = f"{first} against {second}: {commands}; {told}."
    if not found:
        return [head, "No difference."]
    counts = ", ".join(f"{n} {words_of(kind)}" for kind, n in comparison.counts.items())
    places = f"{len(found)} difference{'s' if len(found) > 1 else ''}"
    touched = len({difference.command for difference in found})
    return [head, f"{places} in {touched} command{'s' if touched > 1 else ''}: {counts}", ""]


def _foot(comparison: Comparison) -> list[str]:
    out = comparison.left_out
    left = ", ".join(f"{count} {kind}" for kind, count in out.items())
    return ["", *textwrap.wrap(f"Left out as no difference: {left}. {SAMPLED}", _WIDTH)]


def _grouped(found: Iterable[Difference]) -> list[list[Difference]]:
    """Return the differences by kind, group and pattern: the worst kind, then the most, first."""
    groups: dict[tuple[str, str, str], list[Difference]] = {}
    for difference in found:
        key = (difference.kind, difference.group, difference.pattern)
        groups.setdefault(key, []).append(difference)
    return sorted(groups.values(), key=lambda group: (KINDS.index(group[0].kind), -len(group)))


def _group(found: list[Difference]) -> list[str]:
    first = found[0]
    where = first.command.removeprefix(first.group).strip() or first.command
    largest = f"  at most {_share(max(d.size for d in found))}" if first.kind == "number" else ""
    return [
        _cut(f"{len(found):>6} {words_of(first.kind):<11} {first.group}: {first.pattern}{largest}"),
        _cut(f"       {where}: {_said(first, _PLACE)}"),
    ]


def _said(difference: Difference, longest: int = 1000) -> str:
    place = difference.place
    place = place if len(place) <= longest else f"...{place[3 - longest :]}"
    first, second = _pair(difference.first, difference.second)
    share = f" ({_share(difference.size)})" if difference.kind == "number" else ""
    return f"{place}: {first} -> {second}{share}"


def _share(size: float) -> str:
    return "not finite" if math.isinf(size) else f"{size:.1e}"


def _pair(first: Any, second: Any) -> tuple[str, str]:
    """Return two values briefly; of two long texts, where they begin to differ."""
    if not (isinstance(first, str) and isinstance(second, str)) or ABSENT in (first, second):
        return _brief(first), _brief(second)
    same = next(
        (n for n, (a, b) in enumerate(zip(first, second, strict=False)) if a != b),
        min(len(first), len(second)),
    )
    begin = max(0, same - 12) if max(len(first), len(second)) > _SHOWN else 0
    mark = "..." if begin else ""
    return _brief(mark + first[begin:]), _brief(mark + second[begin:])


def _brief(value: Any) -> str:
    if value == ABSENT:
        return ABSENT
    if isinstance(value, float):
        return f"{value:.12g}"  # all digits are in the JSON
    text = json.dumps(_plain(value), ensure_ascii=False)
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _cut(line: str) -> str:
    return line if len(line) <= _WIDTH else line[: _WIDTH - 3] + "..."
