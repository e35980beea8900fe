"""LQI with tuned weights: against a grid, against the document's optimum, and what is refused."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError, LinearModel
from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.studies.trial import scores_of
from clepsydra.studies.tuning.batch import BatchEvaluation
from clepsydra.studies.tuning.objective import Goal, Limits, Objective, minimax, weighted_sum
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.tuning.weight_space import (
    WeighedLqi,
    lqi_of_weights,
    usual_wear,
    weighed_lqi,
    weight_space,
)

VESSEL = Path(__file__).with_name("tuning") / "vessel.toml"
PERIOD, STEP = 2.0, 0.05
#: Of the level [1/m²], of the feed [s²/m⁶] and of the level's integral [1/(m s)²].
NUMBERS = (100.0, 4e6, 0.01)


@pytest.fixture(scope="module")
def vessel() -> LinearModel:
    return cl.load(VESSEL).linear


def step_of_level(samples: int = 300) -> Scenario:
    """Return a step of the vessel's level by 5 cm."""
    setpoints = np.full((samples, 1), 0.5)
    setpoints[5:] += STEP
    part = Segment("setpoint", "level", 5 * PERIOD, samples * PERIOD, STEP)
    none = np.zeros((samples, 1))
    return Scenario(PERIOD, setpoints, none, none, (part,), 1)


def quadratic(model: LinearModel, **matrices: np.ndarray):
    """Return weights as those that Bryson's rule makes, with other matrices."""
    return dataclasses.replace(weighed_lqi(model).weights, **matrices)


def weights_by_numbers(model: LinearModel, numbers: tuple[float, float, float] = NUMBERS):
    matrices = np.reshape(numbers, (3, 1, 1))
    return quadratic(model, **dict(zip(("states", "inputs", "integrals"), matrices, strict=True)))


def tuned_weights(
    start: WeighedLqi, scenario, objective, *, parameters=None, limits=None, **options
) -> TuningResult:
    """Tune weights on the process with all its measurements."""
    goal = Goal(
        linearise(operating_point_of(start.model)),
        scenario,
        objective,
        Limits() if limits is None else limits,
    )
    return tune(weight_space(start, parameters), goal, Search(**options))


def weights_found(model: LinearModel, tuned: dict[str, float]) -> dict[str, dict[str, float]]:
    """Return the weights of a tuning by the names of what they weigh."""
    numbers = weight_space(weighed_lqi(model)).numbers | tuned
    found: dict[str, dict[str, float]] = {"states": {}, "inputs": {}, "integrals": {}}
    for name, value in numbers.items():
        kind, _, weighed = name.partition(".")
        found[kind][weighed] = value
    return found


@pytest.mark.thorough
def test_the_objective_falls_the_limits_hold_and_the_gains_are_those_of_the_weights():
    plant = cl.load("quadruple-tank")
    model, whole = plant.linear, plant.measured
    scenario = default_scenario(model)
    start = weighed_lqi(model)
    limits = Limits(2.0, total_variation=usual_wear(start.controller, whole, scenario))
    errors = minimax(*(f"iae[{y}]" for y in model.outputs))
    # A whole search: the valley along the second limit is flat, 1e-3 of the objective in all, and
    # searches by the seeds 2 and 3 come to its end, that by 1 does not.
    found = tuned_weights(start, scenario, errors, limits=limits, seed=2)
    before = scores_of(Loop(cl.design.lqi(plant), whole).run(scenario))
    after = scores_of(Loop(found.controller, whole).run(scenario))
    ratios = [after[f"iae[{y}]"] / before[f"iae[{y}]"] for y in model.outputs]
    assert found.objective == pytest.approx(max(ratios), rel=1e-9) and found.objective < 0.5
    for name in model.inputs:
        wear = f"total_variation[{name}]"
        assert after[wear] <= 2.0 * before[wear] * (1.0 + 1e-5), name
        assert f"total variation of {name}" in " ".join(found.binding), name
    assert found.maximum_sensitivity == pytest.approx(
        sampled_loop(found.controller, whole).maximum_sensitivity
    )
    assert found.maximum_sensitivity < 2.0
    # The design by the weights that were found makes the same law.
    again = cl.design.lqi_by_weights(plant, weights_found(model, found.tuned))
    for name, value in again.values.items():
        if ".feedback." in name or ".integral_gain." in name:
            assert found.controller.values[name] == pytest.approx(value, rel=1e-6, abs=1e-9), name


KMOL = 1e3
#: (97a) and (100a): C, V, their integrals, f_in and C_in, with C in kmol/m³.
BY_HAND, PRINTED = (2.0, 3.0, 10.0, 10.0, 1.0, 0.1), (1e-6, 0.1309, 12.04, 10.88, 1e-6, 1e-6)


def averaging_tank() -> cl.Plant:
    """Return the document's tank, whose volume and concentration are both controlled."""
    process = cl.load("averaging-tank:outflow-constant").process
    return cl.Plant(
        dataclasses.replace(process, sampling_period=0.01, controlled=("concentration", "volume"))
    )


def weights_of(numbers: tuple, scale: float = 1.0) -> dict[str, dict[str, float]]:
    c, v, ic, iv, inflow, inlet = (scale * number for number in numbers)
    return {
        "states": {"tank.impurity": c / KMOL**2, "tank.level": v},
        "inputs": {"inflow": inflow, "inflow.impurity": inlet / KMOL**2},
        "integrals": {"concentration": ic / KMOL**2, "volume": iv},
    }


def diagonal(model: LinearModel, weights: dict[str, dict[str, float]]):
    """Return the matrices of weights by names."""
    names = {"states": model.states, "inputs": model.inputs, "integrals": model.outputs}
    return quadratic(
        model,
        **{kind: np.diag([weights[kind][name] for name in names[kind]]) for kind in names},
    )


def document_step(samples: int = 2001) -> Scenario:
    setpoints = np.tile([5.25 * KMOL, 2.1], (samples, 1))
    part = Segment("setpoint", "volume", 0.0, samples * 0.01, 0.1)
    return Scenario(0.01, setpoints, np.full((samples, 1), 0.2), np.zeros((samples, 2)), (part,), 1)


def larger_itae(controller: Controller, model: LinearModel) -> float:
    """Return the larger ITAE of C [kmol] and V [m³], by Simpson's rule on a straight error."""
    run = Loop(controller, model).run(document_step())
    found = []
    for name, target, unit in (("concentration", 5.25 * KMOL, KMOL), ("volume", 2.1, 1.0)):
        error = (target - run.true_measurement(name)) / unit
        # Ten parts of each sample find the zeros in between well enough.
        fine = np.linspace(0.0, run.time[-1], 10 * (len(run.time) - 1) + 1)
        found.append(float(np.trapezoid(fine * np.abs(np.interp(fine, run.time, error)), fine)))
    return max(found)


@pytest.mark.thorough
def test_on_the_averaging_tank_tuned_weights_beat_those_by_hand_and_the_printed_optimum():
    """ITAE of a step of C by 0.25 kmol/m³ and V by 0.1 m³; R not below the document's 1e-6."""
    plant = averaging_tank()
    model = plant.linear
    # Only ratios count: scaled so that the weight that is kept is the printed 12.04.
    hand = weights_of(BY_HAND, 12.04 / 10.0)
    start = {f"{kind}.{name}": w for kind in hand for name, w in hand[kind].items()}
    del start["integrals.concentration"]
    lowest = {name: 1e-6 / KMOL**2 if "impurity" in name else 1e-6 for name in start}
    bounds = [TunedParameter(name, lowest[name], 100.0 * w) for name, w in start.items()]
    index = {"itae[concentration]": 1.0 / KMOL, "itae[volume]": 1.0}
    found = tuned_weights(
        lqi_of_weights(model, diagonal(model, hand), anti_windup="none"),
        document_step(),
        Objective("minimax", index, relative=False),
        parameters=bounds,
        generations=0,
    )
    tuned = larger_itae(found.controller, model)
    printed, by_hand = (
        larger_itae(cl.design.lqi_by_weights(plant, weights_of(numbers), anti_windup="none"), model)
        for numbers in (PRINTED, BY_HAND)
    )
    assert found.objective == pytest.approx(tuned, rel=1e-3)
    assert tuned < by_hand / 100.0
    assert tuned <= printed
    # What the audit says of (100a): the bound of R, and not the index, chose the weights.
    assert found.tuned["inputs.inflow.impurity"] == pytest.approx(1e-12, rel=1e-3)
    assert any("inputs.inflow.impurity chose" in note for note in found.controller.notes)


@pytest.mark.thorough
def test_no_pair_of_weights_on_a_grid_is_better(vessel):
    scenario = step_of_level()
    # Where wear counts as well there is a best within the bounds.
    objective = weighted_sum({"ise[level]": 1.0, "total_variation[feed]": 50.0})
    start = weighed_lqi(vessel)
    found = tuned_weights(start, scenario, objective, generations=8)
    assert found.binding == ()
    design = weight_space(start)
    state, moved, _ = design.numbers
    assert list(found.tuned) == [state, moved]
    factors = np.logspace(-3, 3, 21)
    laws = [
        design.law_values(
            design.numbers | {state: a * design.numbers[state], moved: b * design.numbers[moved]}
        )
        for a in factors
        for b in factors
    ]
    batch = BatchEvaluation(start.controller, vessel, scenario, list(objective.names))
    scores = batch.run({name: np.array([law[name] for law in laws]) for name in laws[0]}).scores
    best = np.min(objective.value(objective.parts(scores, found.start_scores)))
    assert found.objective <= best * (1.0 + 1e-9)
    # And the grid is fine enough to say something.
    assert found.objective > 0.97 * best
    assert best < 0.95 * found.start_objective


def test_only_ratios_of_weights_count():
    design = weight_space(weighed_lqi(cl.load("quadruple-tank").linear))
    once = design.law_values(design.numbers)
    again = design.law_values({name: 7.0 * value for name, value in design.numbers.items()})
    assert once.keys() == again.keys() and len(once) == 14
    for name, value in once.items():
        assert again[name] == pytest.approx(value, rel=1e-8, abs=1e-10), name


def test_what_stands_beside_the_diagonal_keeps_its_correlation(vessel):
    model = cl.load("quadruple-tank").linear
    # 0.5 of the roots of the weights beside it.
    integrals = np.array([[4.0, 3.0], [3.0, 9.0]]) * 1e-4
    design = weight_space(
        lqi_of_weights(
            model,
            quadratic(model, states=np.eye(4) * 1e3, inputs=np.eye(2), integrals=integrals),
        )
    )
    weights = design.weights({**design.numbers, "integrals.level_1": 16.0e-4})
    assert weights.integrals == pytest.approx(np.array([[16.0, 6.0], [6.0, 9.0]]) * 1e-4)
    assert np.array_equal(weights.states, np.eye(4) * 1e3)


def test_the_start_is_the_designed_controller_but_for_its_rounding(vessel):
    for start in (
        weighed_lqi(vessel),
        lqi_of_weights(vessel, weights_by_numbers(vessel)),
    ):
        space = weight_space(start)
        # Half of the sixth digit.
        own = pytest.approx(start.controller.values, rel=5e-6)
        assert space.controller_values(space.start) == own
        assert space.controller_values(space.start) != start.controller.values
        # Near the start it is near: nothing jumps.
        near = space.controller_values(space.start + 1e-7)
        for name, value in start.controller.values.items():
            assert near[name] == pytest.approx(value, rel=1e-4), name


def test_a_bound_on_cheap_moves_is_said_to_have_chosen(vessel):
    bound = TunedParameter("inputs.feed", 1e6, 1e8)
    weights = weights_by_numbers(vessel)
    found = tuned_weights(
        lqi_of_weights(vessel, weights),
        step_of_level(),
        minimax("ise[level]"),
        parameters=[bound],
        generations=0,
    )
    assert found.tuned == {"inputs.feed": pytest.approx(1e6)}
    assert found.binding == ("weight of inputs.feed at least 1e+06",)
    assert any("limit the total variation" in note for note in found.controller.notes)
    assert any("states.vessel.level = 100, integrals.level = 0.01" in note
               for note in found.controller.notes)  # fmt: skip
    assert "weight of inputs.feed = 1e+06" in found.controller.design


def tuned_vessel(vessel: LinearModel, **options):
    objective = weighted_sum({"ise[level]": 1.0, "total_variation[feed]": 50.0})
    return tuned_weights(weighed_lqi(vessel), step_of_level(), objective, **options)


@pytest.mark.thorough
def test_the_same_seed_gives_the_same_weights_and_a_break_changes_nothing(vessel, tmp_path):
    first = tuned_vessel(vessel, generations=2, seed=3)
    kept = tmp_path / "tuning.json"
    seen, stages = [], []

    def stop(progress):
        seen.append(progress)
        if len(seen) == 3:
            raise KeyboardInterrupt

    part = tuned_vessel(vessel, generations=2, seed=3, progress=stop, state_file=kept)
    assert part.interrupted and part.evaluations < first.evaluations
    whole = tuned_vessel(vessel, generations=2, seed=3, progress=stages.append, state_file=kept)
    assert not whole.interrupted
    assert whole.tuned == first.tuned and whole.evaluations == first.evaluations
    assert whole.controller.values == first.controller.values
    assert {each.stage for each in stages} >= {"global search", "local search"}


def test_a_state_file_of_other_weights_is_refused(vessel, tmp_path):
    """The gains of the start are the same, and the bounds: another weight is kept."""
    kept = tmp_path / "tuning.json"
    bound = [TunedParameter("inputs.feed", 1e6, 1e8)]
    for integral in (0.01, 0.02):
        weights = weights_by_numbers(vessel, (100.0, 4e6, integral))
        start, errors = lqi_of_weights(vessel, weights), minimax("iae[level]")
        options = {"parameters": bound, "generations": 0, "state_file": kept}
        if integral == 0.01:
            tuned_weights(start, step_of_level(), errors, **options)
            continue
        with pytest.raises(InputError, match="another problem"):
            tuned_weights(start, step_of_level(), errors, **options)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ([TunedParameter("inputs.feed", 1.0, 2.0)], "a start within its bounds"),
        ([TunedParameter("inputs.feed", 1e3, 1e9)] * 2, "each name once"),
    ],
)
def test_wrong_bounds_are_refused_in_words(vessel, parameters, said):
    with pytest.raises(InputError, match=said):
        weight_space(weighed_lqi(vessel), parameters)
