"""Steps begin as soon as what they read is there, and none is lost."""

import numpy as np
import pytest

from clepsydra.engine.step_order import Form, soonest_first
from clepsydra.engine.steps import Bounded, Known, Required, Same, reads, writes
from clepsydra.program.operation import Operation

CODES = "add", "multiply", "divide", "square_root", "select", "exp", "absolute", "maximum"


def by_arguments(each):
    return each.arguments


def form(lanes=8, *, refines=False):
    return Form(lanes, refines, by_arguments, lambda each: each.code == "add")


def some_steps(seed, count=300):
    random = np.random.default_rng(seed)
    steps = []
    for value in range(4, 4 + count):
        given = tuple(int(each) for each in random.integers(max(value - 40, 0), value, 2))
        kind = random.choice(["operation"] * 6 + ["required", "known", "same", "root"])
        if kind == "operation":
            steps.append(Operation(value, str(random.choice(CODES)), given))
        elif kind == "required":
            steps += [Required(Operation(value, "less", given), False), Known(value, False)]
        elif kind == "known":
            steps.append(Known(value, True))
        elif kind == "same":
            steps.append(Same(value, given[0]))
        else:
            steps.append(Bounded(Operation(value, "square_root", given[:1])))
    return steps


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("refines", [False, True])
def test_every_step_follows_what_it_reads(seed, refines):
    steps = some_steps(seed)
    found = soonest_first(steps, form(refines=refines))
    there, late = {0, 1, 2, 3}, {value for step in steps for value in writes(step)}
    for step in found:
        assert all(value in there or value not in late for value in reads(step, by_arguments))
        there.update(writes(step))
    alike = [Bounded(each.operation) if isinstance(each, Bounded) else each
             for each in found]  # fmt: skip
    assert sorted(map(repr, alike)) == sorted(map(repr, steps))


def chains(count, length):
    """Independent chains of a bounded root and a sum, one after the other."""
    steps, value = [], count
    for chain in range(count):
        last = chain
        for _ in range(length):
            steps += [
                Bounded(Operation(value, "square_root", (last,))),
                Operation(value + 1, "add", (value, value)),
            ]
            last, value = value + 1, value + 2
    return steps


def test_chains_take_turns():
    found = soonest_first(chains(4, 3), form(lanes=1))
    roots = [each.operation.target for each in found if isinstance(each, Bounded)]
    # The first root of each chain of six values comes before the second of any.
    assert {(root - 4) // 6 for root in roots[:4]} == {0, 1, 2, 3}


@pytest.mark.parametrize(
    ("lanes", "refines", "least", "most"), [(8, False, 0, 0), (8, True, 6, 12)]
)
def test_multiply_adds_take_roots_that_the_divider_has_no_time_for(lanes, refines, least, most):
    found = soonest_first(chains(8, 2), form(lanes, refines=refines))
    assert least <= sum(isinstance(each, Bounded) and each.refined for each in found) <= most


def test_a_root_that_need_not_wait_is_left_to_the_divider():
    found = soonest_first(chains(1, 5), form(refines=True))
    assert not any(isinstance(each, Bounded) and each.refined for each in found)
