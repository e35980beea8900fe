"""A sample without its unlikely branches: what is left of a block where usual conditions hold.

Nobody marks a condition as usual; two forms say so by themselves. Where ``x < low`` stands beside
``max(x, low)``, another law takes over below `low`, such as laminar flow near a closed gap. And
what enters a law is nearly always a number, ``|x| <= 1e300``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

from clepsydra.engine.steps import Bounded, Known, Required, Same, Step, reads, statement_in, writes
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, ForLoop, Statement

#: What no number lies beyond.
LARGEST = 1e300
#: A path that leaves out fewer operations, or a smaller share of all, is not worth its code.
_FEWEST, _SHARE = 16, 1 / 16


def likely_path(
    statements: Iterable[Statement],
    constants: Mapping[int, float],
    held: Collection[int],
    following: Mapping[int, int],
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
    following : mapping
        Value of the state to what it becomes.
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
    >>> for step in likely_path([less, larger, *small, chosen], {}, {0, 1}, {}, [22],
    ...                         lambda each: each.arguments):
    ...     print(type(step).__name__)
    Required
    Same
    Same
    """
    whole = list(statements)
    loops = [each for each in whole if isinstance(each, ForLoop)]
    # What a loop has written into its rings cannot be taken back; one whose turns are told is run
    # a few times, to estimate an error.
    if any(each.rings or each.adjustable for each in loops):
        return ()
    wanted, usual = list(results), dict(_usual(whole, constants, held, following))
    steps = _needed(_Folding(usual, whole).steps(whole), wanted, read_by)
    before = _length(_needed(whole, wanted, read_by))
    saved = before - _length(steps)
    return tuple(steps) if usual and saved >= max(_FEWEST, _SHARE * before) else ()


def _length(steps: Iterable[Step]) -> int:
    """Return how many operations and tests stand in the code of steps, their bodies included."""
    found = 0
    for step in steps:
        statement = statement_in(step)
        if isinstance(step, Required) or isinstance(statement, Operation):
            found += 1
        elif statement is not None:
            found += sum(1 for _ in Block(0, (statement,), ()).operations())
    return found


def _usual(
    statements: list[Statement],
    constants: Mapping[int, float],
    held: Collection[int],
    following: Mapping[int, int],
) -> Iterator[tuple[int, bool]]:
    """Yield conditions with what they usually are."""
    chosen = {
        each.target: each.arguments[1:]
        for each in statements
        if isinstance(each, Operation) and each.code == "select"
    }
    operations = [each for each in statements if isinstance(each, Operation)]
    larger = {each.arguments for each in operations if each.code == "maximum"}
    magnitudes = {each.target for each in operations if each.code == "absolute"}
    for each in operations:
        if each.code == "less" and each.arguments[1] in held and each.arguments in larger:
            yield each.target, False
        elif each.code == "less_equal" and each.arguments[0] in magnitudes:
            if constants.get(each.arguments[1]) == LARGEST:
                yield each.target, True
        elif each.code == "not_equal":
            one, other = each.arguments
            for setting, last in (one, other), (other, one):
                if setting in held and last in following:
                    after = following[last]
                    if setting in chosen.get(after, (after,)):
                        yield each.target, False


class _Folding:
    """What statements become where conditions are known."""

    def __init__(self, usual: Mapping[int, bool], statements: list[Statement]) -> None:
        self.usual, self.truths = usual, dict[int, bool]()
        self.origins: dict[int, int] = {}
        #: Settings and what they were in the sample before: the same bits.
        self.unchanged = {
            frozenset(each.arguments)
            for each in statements
            if isinstance(each, Operation) and each.code == "not_equal" and each.target in usual
        }
        #: Values to what they are larger than.
        self.larger = {
            each.arguments[0]: each.arguments[1]
            for each in statements
            if isinstance(each, Operation) and each.code == "less" and each.target in usual
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
            elif isinstance(step, Same):
                self.origins[step.target] = self.origins.get(step.source, step.source)
                if step.source in self.truths:
                    self.truths[step.target] = self.truths[step.source]
            yield step

    def _step(self, each: Operation) -> Step:
        target, code, given = each.target, each.code, each.arguments
        if target in self.usual:
            return Known(target, self.usual[target])
        if code == "maximum" and self.larger.get(given[0]) == given[1]:
            return Same(target, given[0])
        if code == "square_root":
            origin = self.origins.get(given[0], given[0])
            return Bounded(each) if origin in self.larger else each
        if code == "not" and given[0] in self.truths:
            return Known(target, not self.truths[given[0]])
        if code == "select" and given[0] in self.truths:
            return Same(target, given[1] if self.truths[given[0]] else given[2])
        if code == "select" and frozenset(given[1:]) in self.unchanged:
            return Same(target, given[1])
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
        if isinstance(step, Required) or not wanted.isdisjoint(writes(step)):
            wanted.update(reads(step, read_by))
            kept.append(step)
    return kept[::-1]
