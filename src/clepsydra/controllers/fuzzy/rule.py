"""Rules: if … then …, read from a line of text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import TypeVar

from clepsydra.base.errors import InputError

T = TypeVar("T")

_TOKEN = re.compile(r"\s*([A-Za-z][A-Za-z0-9_]*|[()]|\S)")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_KEYWORDS = ("if", "is", "and", "or", "then")
_FORM = "write as in if e is N and de is ZO then u is PS"


@dataclass(frozen=True)
class Is:
    """A variable is a set: its degree of membership."""

    variable: str
    set: str

    def __str__(self) -> str:
        return f"{self.variable} is {self.set}"


@dataclass(frozen=True)
class All:
    """All parts hold: the smallest of their degrees."""

    parts: tuple[Condition, ...]

    def __str__(self) -> str:
        return " and ".join(f"({p})" if isinstance(p, Some) else str(p) for p in self.parts)


@dataclass(frozen=True)
class Some:
    """Some part holds: the largest of their degrees."""

    parts: tuple[Condition, ...]

    def __str__(self) -> str:
        return " or ".join(map(str, self.parts))


Condition = Is | All | Some


def atoms(condition: Condition) -> Iterator[Is]:
    """Yield every "variable is set" of a condition.

    Examples
    --------
    >>> [atom.set for atom in atoms(All((Is("e", "N"), Is("de", "P"))))]
    ['N', 'P']
    """
    if isinstance(condition, Is):
        yield condition
    else:
        for part in condition.parts:
            yield from atoms(part)


def firing(
    condition: Condition,
    degrees: Mapping[tuple[str, str], T],
    least: Callable[[T, T], T],
    greatest: Callable[[T, T], T],
) -> T:
    """Return how far a condition holds: AND by the smallest, OR by the largest degree.

    `degrees`: (variable, set) to its degree, of any type; `least`, `greatest`: the smaller and the
    larger of two degrees.

    Examples
    --------
    >>> firing(All((Is("e", "N"), Is("de", "P"))), {("e", "N"): 0.7, ("de", "P"): 0.2}, min, max)
    0.2
    """
    if isinstance(condition, Is):
        return degrees[condition.variable, condition.set]
    joined = least if isinstance(condition, All) else greatest
    return reduce(joined, (firing(part, degrees, least, greatest) for part in condition.parts))


@dataclass(frozen=True)
class Rule:
    """A rule: where the condition holds, each output is its set.

    `conclusions`: an output and one of its sets, each output once.

    Examples
    --------
    >>> rule = parse_rule("R1", "if e is N and de is ZO then u is PS and v is NS")
    >>> rule.condition, len(rule.conclusions)
    (All(parts=(Is(variable='e', set='N'), Is(variable='de', set='ZO'))), 2)
    """

    name: str
    condition: Condition
    conclusions: tuple[Is, ...]

    def __str__(self) -> str:
        return f"if {self.condition} then {' and '.join(map(str, self.conclusions))}"


def joined(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Return rules of which no two conclude the same: those that do are one rule by OR.

    It holds as far as the one of them that holds most. What conditions begin with is taken out of
    them: (a and b) or (a and c) is a and (b or c), of degrees no less than of truths. The name of
    what is joined is that of its conclusions.

    Examples
    --------
    >>> a, b, c = (parse_rule(f"R{k}", f"if e is N and d is {s} then u is P")
    ...            for k, s in enumerate("NZP", start=1))
    >>> (rule,) = joined((a, b, c))
    >>> rule.name, str(rule)
    ('u_P', 'if e is N and (d is N or d is Z or d is P) then u is P')
    """
    alike: dict[tuple[Is, ...], list[Rule]] = {}
    for rule in rules:
        alike.setdefault(rule.conclusions, []).append(rule)
    return tuple(
        Rule("_".join(f"{each.variable}_{each.set}" for each in told), _either(conditions), told)
        if len(conditions) > 1
        else some[0]
        for told, some in alike.items()
        for conditions in [[_parts(rule.condition) for rule in some]]
    )


def _parts(condition: Condition) -> tuple[Condition, ...]:
    return condition.parts if isinstance(condition, All) else (condition,)


def _either(some: Iterable[tuple[Condition, ...]]) -> Condition:
    """Return that all parts hold of one of several conditions."""
    begun: dict[Condition, list[tuple[Condition, ...]]] = {}
    for first, *rest in some:
        begun.setdefault(first, []).append(tuple(rest))
    # Where one of them asks for no more, the others add nothing.
    found = [
        All((first, *_parts(_either(rests)))) if all(rests) else first
        for first, rests in begun.items()
    ]
    return found[0] if len(found) == 1 else Some(tuple(found))


def parse_rule(name: str, text: str) -> Rule:
    """Read a rule: ``if e is N and (de is N or de is ZO) then u is PS and v is NS``.

    AND binds closer than OR; parentheses group. Keywords may be in capitals.

    Raises InputError: it is no such rule, or an output is concluded twice.

    Examples
    --------
    >>> str(parse_rule("R1", "IF a is X or b is Y and c is Z THEN u is W").condition)
    'a is X or b is Y and c is Z'
    """
    return _Parser(name, text).rule()


class _Parser:
    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.tokens = [match[1] for match in _TOKEN.finditer(text)]
        self.next = 0

    def rule(self) -> Rule:
        self._expect("if")
        condition = self._some()
        self._expect("then")
        conclusions = self._listed("and", self._is)
        if self.next < len(self.tokens):
            raise self._error("the end of the rule, or and")
        outputs = [each.variable for each in conclusions]
        twice = next((output for output in outputs if outputs.count(output) > 1), None)
        if twice is not None:
            raise InputError(
                f"rules.{self.name}", f"{twice} twice", "each output once in a rule",
                "write a rule for each",
            )  # fmt: skip
        return Rule(self.name, condition, tuple(conclusions))

    def _some(self) -> Condition:
        parts = self._listed("or", self._all)
        return parts[0] if len(parts) == 1 else Some(tuple(parts))

    def _all(self) -> Condition:
        parts = self._listed("and", self._part)
        return parts[0] if len(parts) == 1 else All(tuple(parts))

    def _listed(self, joint: str, read: Callable[[], T]) -> list[T]:
        found = [read()]
        while self._take(joint):
            found.append(read())
        return found

    def _part(self) -> Condition:
        if not self._take("("):
            return self._is()
        inner = self._some()
        self._expect(")")
        return inner

    def _is(self) -> Is:
        variable = self._name("the name of a variable")
        self._expect("is")
        return Is(variable, self._name("the name of a set"))

    def _name(self, expected: str) -> str:
        token = self._token
        if not _NAME.fullmatch(token) or token.lower() in _KEYWORDS:
            raise self._error(expected)
        self.next += 1
        return token

    @property
    def _token(self) -> str:
        return self.tokens[self.next] if self.next < len(self.tokens) else ""

    def _take(self, token: str) -> bool:
        found = self._token.lower() == token
        self.next += found
        return found

    def _expect(self, token: str) -> None:
        if not self._take(token):
            raise self._error(token)

    def _error(self, expected: str) -> InputError:
        before = " ".join(self.tokens[max(0, self.next - 3) : self.next])
        shown = self._token[:40] or "the end"
        value = f"{shown} after {before[-40:]}" if before else shown
        return InputError(f"rules.{self.name}", value, expected, _FORM)
