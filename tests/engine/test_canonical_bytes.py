"""Content as bytes: the same for what is equal, another for whatever differs in anything."""

import math
import struct
import sys
from copy import copy
from dataclasses import dataclass, fields, is_dataclass

import numpy as np
import pytest
from solved import solving
from test_loop_rings import ring_program

from clepsydra import program_of
from clepsydra.engine.canonical_bytes import canonical_bytes
from clepsydra.engine.host import host
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import Operation


@dataclass(frozen=True)
class Alone:
    value: object


@dataclass(frozen=True)
class Other:
    value: object


DIFFERENT = [
    0, 1, True, False, None, "1", "True", "None", "", 1.0, 0.0, -0.0, 5e-324, math.inf, -math.inf,
    math.nan, -math.nan, struct.unpack("<d", struct.pack("<Q", 0x7FF8000000000001))[0],
    0.1, math.nextafter(0.1, 1), (), (1,), ((1,),), (1, 1), (1.0,), ("1",), "(1,)", frozenset(),
    frozenset({1}), frozenset({(1,)}), {}, {1: 1}, {1: (1,)}, {"": ()}, Alone(1), Alone((1,)),
    Other(1), Alone(Alone(1)), Alone(None), ("a", "b"), ("a, b",), ("a', 'b",), ("a", ("b",)),
]  # fmt: skip


def test_no_two_different_things_have_the_same_bytes():
    found = [canonical_bytes(each) for each in DIFFERENT]
    assert len(set(found)) == len(DIFFERENT)


def test_equal_things_of_different_make_have_the_same_bytes():
    word, number = "".join(["le", "vel"]), float("0.5")
    assert word is not sys.intern("level")
    alike = [
        (0.5, np.float64(0.5)), (3, np.int64(3)), (frozenset("abcdef"), set("fedcba")),
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}), (word, sys.intern("level")),
        ((number, number), (number, float("0.5"))), ((word, word), ("level", word)),
        (Operation(1, "constant", (), 1), Operation(1, "constant", (), np.float64(1.0))),
    ]  # fmt: skip
    for one, other in alike:
        assert canonical_bytes(one) == canonical_bytes(other)


def test_what_it_does_not_know_has_none():
    for item in (object(), [1], b"1", (1, object()), Alone(len)):
        with pytest.raises(TypeError, match="has no canonical bytes"):
            canonical_bytes(item)


def changed(item):
    """Yield an item again and again, each time with one number, truth value or word changed."""
    if is_dataclass(item):
        for each in fields(item):
            for other in changed(getattr(item, each.name)):
                whole = copy(item)
                object.__setattr__(whole, each.name, other)
                yield whole
    elif isinstance(item, tuple):
        yield (*item, 7)
        for place, each in enumerate(item):
            yield item[:place] + item[place + 1 :]
            yield from ((*item[:place], other, *item[place + 1 :]) for other in changed(each))
    elif isinstance(item, frozenset):
        yield item | {"another"} if "u" in item else item | {10_000}
    elif isinstance(item, bool):
        yield not item
    elif isinstance(item, int):
        yield item + 1
    elif isinstance(item, str):
        yield f"{item}_"
    elif isinstance(item, float):
        yield math.nextafter(item, 2.0 if item == 1.0 else 1.0)
        yield -item


def conditional_program():
    program = ring_program(3)
    inner = BlockBuilder(1)
    body = inner.finish([inner.operation("multiply", 0, inner.constant(0.3))])
    builder = BlockBuilder(2)
    condition = builder.operation("less", 0, builder.constant(0.0))
    (value,) = builder.conditional("halve", condition, body, [1], [])
    whole = copy(program)
    object.__setattr__(whole, "block", builder.finish([value]))
    return whole


FORM = KernelForm(4, frozenset({"u"}), processor=host(), noisy=frozenset({"u"}))


@pytest.mark.parametrize(
    "item",
    [ring_program(3), conditional_program(), program_of(solving(2, 1)), FORM],
    ids=["loops and rings", "conditional", "routine", "form"],
)
def test_whatever_changes_in_a_program_or_its_form_changes_the_bytes(item):
    whole, others = canonical_bytes(item), [canonical_bytes(each) for each in changed(item)]
    assert len(others) > 5
    assert whole not in others
