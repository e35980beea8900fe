"""Routines that laws call with expressions, and that stay routines in their programs."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import casadi as ca

from clepsydra.program.routine import Routine
from clepsydra.program.routine_writer import Algorithm, Shape, computed, routine

_PREFIX, _WHERE = "routine_", "where_"
_NAME = re.compile(f"({_WHERE})?" + _PREFIX + r"(?P<name>\w+)_of(?P<sizes>(_\d+)+)")


@dataclass(frozen=True)
class Written:
    """What a routine of some sizes is written from, see `routine_writer.routine`."""

    algorithm: Algorithm
    arguments: Mapping[str, Shape]
    results: Mapping[str, Shape]
    local: Mapping[str, Shape] = field(default_factory=dict)


@dataclass(frozen=True)
class Family:
    """A routine for arrays of any sizes.

    Called with sizes and a matrix of expressions for each argument, it returns a matrix for each
    result. In the program of a law the call stays one, and an argument of numbers alone is a table.

    Parameters
    ----------
    name : str
        An identifier, which no other family has.
    write : callable
        Takes the sizes and returns the `Written`.
    description : str
    """

    name: str
    write: Callable[..., Written]
    description: str

    def routine(self, sizes: tuple[int, ...]) -> Routine:
        """Return the routine for some sizes."""
        return _routine(self, sizes)

    def expressions(self, sizes: tuple[int, ...], given: list[ca.SX]) -> list[ca.SX]:
        """Return the results row by row, computed from the elements of each argument."""
        return computed(self.routine(sizes), self.write(*sizes).algorithm, given)

    def __call__(self, sizes: tuple[int, ...], *given: ca.SX) -> list[ca.SX]:
        """Return a matrix for each result.

        Raises
        ------
        ValueError
            An argument has another shape.
        """
        return self._called(_function(self, sizes), sizes, [], given)

    def where(self, condition: ca.SX, sizes: tuple[int, ...], *given: ca.SX) -> list[ca.SX]:
        """Return a matrix for each result, zero where a condition is false.

        A program passes over the routine there. A law is linearised where the condition is false,
        so that nothing of a result is differentiated.

        Raises
        ------
        ValueError
            An argument has another shape.
        """
        return self._called(_function_where(self, sizes), sizes, [condition], given)

    def _called(
        self, function: ca.Function, sizes: tuple[int, ...], first: list[ca.SX], given: Any
    ) -> list[ca.SX]:
        written = self.write(*sizes)
        for (name, shape), each in zip(written.arguments.items(), given, strict=True):
            if each.shape != _matrix(shape):
                raise ValueError(f"{self.name}: {name} is {each.shape}, expected {_matrix(shape)}")
        found = function.call([*first, *(ca.vec(ca.densify(each).T) for each in given)])
        shapes = map(_matrix, written.results.values())
        return [ca.reshape(each, *shape[::-1]).T for each, shape in zip(found, shapes, strict=True)]


def called_family(
    function: ca.Function, families: Iterable[Family]
) -> tuple[Family, tuple[int, ...]] | None:
    """Return the family and the sizes of the routine that a function stands for, if any does."""
    found = _NAME.fullmatch(function.name())
    if found is None:
        return None
    (family,) = (each for each in families if each.name == found["name"])
    return family, tuple(map(int, found["sizes"].split("_")[1:]))


def is_conditional(function: ca.Function) -> bool:
    """Return whether a function that stands for a routine has its condition before the rest."""
    return bool(function.name().startswith(_WHERE))


def _matrix(shape: Shape) -> tuple[int, int]:
    rows, columns, *_ = *shape, 1, 1
    return rows, columns


@lru_cache
def _routine(family: Family, sizes: tuple[int, ...]) -> Routine:
    written = family.write(*sizes)
    return routine(
        family.name,
        written.algorithm,
        arguments=written.arguments,
        results=written.results,
        local=written.local,
        description=family.description,
    )


@lru_cache
def _function(family: Family, sizes: tuple[int, ...]) -> ca.Function:
    """Return what a routine computes as a function that is kept as a call."""
    made = family.routine(sizes)
    given = [ca.SX.sym(array.name, array.size) for array in made.arguments]
    found = family.expressions(sizes, given)
    results, place = [], 0
    for array in made.results:
        results.append(ca.densify(ca.vertcat(*found[place : place + array.size])))
        place += array.size
    whole = f"{_PREFIX}{family.name}_of_{'_'.join(map(str, sizes))}"
    return ca.Function(whole, given, results, {"never_inline": True})


@lru_cache
def _function_where(family: Family, sizes: tuple[int, ...]) -> ca.Function:
    """Return what a routine computes where a condition is true, as a function without slopes."""
    plain, condition = _function(family, sizes), ca.SX.sym("condition")
    given = [ca.SX.sym(plain.name_in(i), plain.numel_in(i)) for i in range(plain.n_in())]
    results = [ca.if_else(condition, each, 0) for each in plain.call(given)]
    no_slopes = {"is_diff_in": [False] * (1 + len(given)), "is_diff_out": [False] * len(results)}
    options = {"never_inline": True} | no_slopes
    return ca.Function(_WHERE + plain.name(), [condition, *given], results, options)
