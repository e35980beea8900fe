"""A sample without its unlikely branches: what is left of a block where usual conditions hold.

Nobody marks a condition as usual; two forms say so by themselves. Where ``x < low`` stands beside
``max(x, low)``, another law takes over below `low`, such as laminar flow near a closed gap. And
what enters a law is nearly always a number, ``|x| <= 1e300``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass

from clepsydra.program.operation import Operation
from clepsydra.program.program import ForLoop, Statement, written_by

#: What no number lies beyond.
_LARGEST = 1e300
#: A path that leaves out fewer statements is not worth its code.
_FEWEST = 16


@dataclass(frozen=True)
class Required:
    """A condition that has to be as it usually is.

    Parameters
    ----------
    condition : Operation
        ``a < b``, which is false where ``b < a``, so that not-a-number fails; or ``a <= b``.
    usual : bool
    """

    condition: Operation
    usual: bool


@dataclass(frozen=True)
class Known:
    """A truth value that is known on the path."""

    target: int
    truth: bool


@dataclass(frozen=True)
class Same:
    """A value that is another one on the path."""

    target: int
    source: int


Step = Statement | Required | Known | Same


def likely_path(
    statements: Iterable[Statement],
    constants: Mapping[int, float],
    held: Collection[int],
    results: Iterable[int],
    read_by: Callable[[Statement], tuple[int, ...]],
) -> tuple[Step, ...]:
    """Return the steps of a sample in which every test holds; none where that saves too little.

    Where all tests hold, each result is the number that all statements would give, in every bit: a
    step is left out only if nothing reads it, and a value stands for another only if it is that.

    Parameters
    ----------
    statements : iterable of Statement
        Of every sample.
    constants : mapping
        Value to its number.
    held : collection of int
        Values that were there before the sample and stay.
    results : iterable of int
        Values that are asked for.
    read_by : callable
        The values that a statement reads as it is printed.

    Examples
    --------
    >>> less, larger, small = (
    ...     Operation(2, "less", (0, 1)), Operation(3, "maximum", (0, 1)),
    ...     [Operation(k, "multiply", (k - 1, 0)) for k in range(4, 22)],
    ... )
    >>> chosen = Operation(22, "select", (2, 21, 3))
    >>> for step in likely_path([less, larger, *small, chosen], {}, {0, 1}, [22],
    ...                         lambda each: each.arguments):
    ...     print(type(step).__name__)
    Required
    Same
    Same
    """
    whole = list(statements)
    if any(isinstance(each, ForLoop) and each.rings for each in whole):
        return ()  # what a loop has written into its rings cannot be taken back
    wanted, usual = list(results), dict(_usual(whole, constants, held))
    steps = _needed(_Folding(usual, whole).steps(whole), wanted, read_by)
    done = sum(not isinstance(step, (Known, Same)) for step in steps)
    saved = len(_needed(whole, wanted, read_by)) - done
    return tuple(steps) if usual and saved >= _FEWEST else ()


def _usual(
    statements: list[Statement], constants: Mapping[int, float], held: Collection[int]
) -> Iterator[tuple[int, bool]]:
    """Yield conditions with what they usually are."""
    operations = [each for each in statements if isinstance(each, Operation)]
    larger = {each.arguments for each in operations if each.code == "maximum"}
    for each in operations:
        if each.code == "less" and each.arguments[1] in held and each.arguments in larger:
            yield each.target, False
        elif each.code == "less_equal" and constants.get(each.arguments[1]) == _LARGEST:
            yield each.target, True


class _Folding:
    """What statements become where conditions are known."""

    def __init__(self, usual: Mapping[int, bool], statements: list[Statement]) -> None:
        self.usual, self.truths = usual, dict[int, bool]()
        #: Pairs of which the first is the larger.
        self.larger = {
            each.arguments
            for each in statements
            if isinstance(each, Operation) and usual.get(each.target) is False
        }

    def steps(self, statements: Iterable[Statement]) -> Iterator[Step]:
        """Yield what each statement becomes."""
        for each in statements:
            if not isinstance(each, Operation):
                yield each
                continue
            if each.target in self.usual:
                yield Required(each, self.usual[each.target])
            step = self._step(each)
            if isinstance(step, Known):
                self.truths[step.target] = step.truth
            elif isinstance(step, Same) and step.source in self.truths:
                self.truths[step.target] = self.truths[step.source]
            yield step

    def _step(self, each: Operation) -> Step:
        target, code, given = each.target, each.code, each.arguments
        if target in self.usual:
            return Known(target, self.usual[target])
        if code == "maximum" and given in self.larger:
            return Same(target, given[0])
        if code == "not" and given[0] in self.truths:
            return Known(target, not self.truths[given[0]])
        if code == "select" and given[0] in self.truths:
            return Same(target, given[1] if self.truths[given[0]] else given[2])
        if code in ("and", "or"):
            known = [self.truths[value] for value in given if value in self.truths]
            decides = code == "or"
            if decides in known:
                return Known(target, decides)
            rest = [value for value in given if value not in self.truths]
            if len(rest) < len(given):
                return Same(target, rest[0]) if rest else Known(target, not decides)
        return each


def _needed(
    steps: Iterable[Step], results: Iterable[int], read_by: Callable[[Statement], tuple[int, ...]]
) -> list[Step]:
    """Return the steps that something reads; every test is one."""
    wanted, kept = set(results), list[Step]()
    for step in reversed(list(steps)):
        if isinstance(step, Required):
            wanted.update(step.condition.arguments)
        elif isinstance(step, (Known, Same)):
            if step.target not in wanted:
                continue
            if isinstance(step, Same):
                wanted.add(step.source)
        elif wanted.isdisjoint(written_by(step)):
            continue
        else:
            wanted.update(read_by(step))
        kept.append(step)
    return kept[::-1]
