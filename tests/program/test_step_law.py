"""Step laws: signatures in order, and equations that do not fit refused."""

import numpy as np
import pytest

from clepsydra import InputError, Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, step_law


def law(equations, *, state=(), inputs=("a", "b"), parameters=("gain",), outputs=("y",)):
    return step_law(
        "tested",
        inputs=[Signal(name) for name in inputs],
        parameters=[Signal(name) for name in parameters],
        state=[Signal(name) if isinstance(name, str) else name for name in state],
        outputs=[Signal(name) for name in outputs],
        equations=equations,
    )


def numbers(values) -> list[float]:
    return np.array(values).ravel().tolist()


def test_arguments_and_results_stand_in_the_order_of_the_signals():
    made = law(
        lambda s: Equations(
            {"second": s["first"], "first": s["second"] - s["b"]},
            {"z": s["gain"] * s["a"], "y": s["b"]},
            {"inner": s["a"] + s["b"]},
        ),
        state=("first", "second"),
        outputs=("y", "z"),
    )
    next_state, outputs, intermediates = made.function([2, 3], [5, 7], [11])
    assert numbers(next_state) == [-4.0, 2.0]
    assert numbers(outputs) == [7.0, 55.0]
    assert numbers(intermediates) == [12.0]
    assert [signal.name for signal in made.intermediates] == ["inner"]


def test_plain_numbers_are_expressions_too():
    made = law(lambda s: Equations({"x": 0}, {"y": 2.5}), state=("x",))
    next_state, outputs, _ = made.function([9], [0, 0], [0])
    assert numbers(next_state) == [0.0] and numbers(outputs) == [2.5]


def test_a_law_without_state_and_parameters_is_a_function_of_its_inputs():
    made = law(lambda s: Equations({}, {"y": s["a"] - s["b"]}), parameters=())
    assert numbers(made.function([], [7, 2], [])[1]) == [5.0]


def test_the_entry_of_a_delay_ring_is_its_oldest_value_and_the_value_to_write():
    made = law(
        lambda s: Equations({"pipe": s["a"]}, {"y": s["pipe"]}),
        state=(DelayRing(Signal("pipe"), 4),),
    )
    next_state, outputs, _ = made.function([6], [1, 0], [0])
    assert numbers(next_state) == [1.0] and numbers(outputs) == [6.0]
    assert made.state[0].name == "pipe"


@pytest.mark.parametrize("length", [0, -3])
def test_a_delay_below_one_sample_is_refused(length):
    with pytest.raises(InputError, match=f"{length}"):
        DelayRing(Signal("pipe"), length)


@pytest.mark.parametrize(
    "groups",
    [
        {"inputs": ("a", "a")},
        {"inputs": ("a", "gain")},
        {"inputs": ("a", "x")},
        {"parameters": ("gain", "x")},
        {"parameters": ("gain", "gain")},
        {"state": ("x", DelayRing(Signal("x"), 3))},
    ],
)
def test_names_that_clash_are_refused(groups):
    with pytest.raises(ValueError, match="tested"):
        law(lambda s: Equations({"x": s["x"]}, {"y": 0}), **({"state": ("x",)} | groups))


@pytest.mark.parametrize(
    ("equations", "missing"),
    [
        (lambda s: Equations({}, {"y": 1}), "forgotten"),
        (lambda s: Equations({"forgotten": 0}, {}), "y"),
    ],
)
def test_a_state_or_output_left_undefined_is_refused(equations, missing):
    with pytest.raises(ValueError, match=rf"tested.*{missing}"):
        law(equations, state=("forgotten",))


def test_a_value_for_a_signal_that_the_law_lacks_is_refused():
    for equations in (
        lambda s: Equations({"x": 0, "typing_error": 1}, {"y": 0}),
        lambda s: Equations({"x": 0}, {"y": 0, "typing_error": 1}),
    ):
        with pytest.raises(ValueError, match="typing_error"):
            law(equations, state=("x",))
