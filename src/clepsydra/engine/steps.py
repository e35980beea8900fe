"""The steps of a likely path: statements, and what stands for them where usual conditions hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from clepsydra.program.operation import Operation
from clepsydra.program.program import Statement, written_by


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


@dataclass(frozen=True)
class Bounded:
    """A square root of what is not near zero, which multiply-adds may compute.

    Parameters
    ----------
    operation : Operation
    endless : bool
        Whether it may be of the largest numbers, and of infinity; else a path tests that it is not.
    refined : bool
        Whether multiply-adds compute it.
    """

    operation: Operation
    endless: bool = False
    refined: bool = False


Step = Statement | Required | Known | Same | Bounded


def statement_in(step: Step) -> Statement | None:
    """Return the statement that a step computes, if it computes one."""
    if isinstance(step, Bounded):
        return step.operation
    return None if isinstance(step, (Required, Known, Same)) else step


def reads(step: Step, read_by: Callable[[Statement], tuple[int, ...]]) -> tuple[int, ...]:
    """Return the values that a step reads, if `read_by` says it of a statement."""
    if isinstance(step, Required):
        return step.condition.arguments
    if isinstance(step, Same):
        return (step.source,)
    statement = statement_in(step)
    return () if statement is None else read_by(statement)


def writes(step: Step) -> tuple[int, ...]:
    """Return the values that a step gives."""
    if isinstance(step, (Known, Same)):
        return (step.target,)
    statement = statement_in(step)
    return () if statement is None else tuple(written_by(statement))
