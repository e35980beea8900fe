"""What the screen says of many plants, in the cases that a reader must not take for others."""

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

import clepsydra as cl
from clepsydra.report.robustness_answer import robustness_answer
from clepsydra.report.screen import Screen
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.robustness.tally import Tally

STILL = {"default": "0 %"}


def answered(name, **how):
    plant = cl.load(name)
    return cl.robustness(cl.design.simc(plant), plant, **how)


@pytest.fixture(scope="module")
def three():
    return answered("three-tanks", draws=100)


def words(found, width=80, every=False):
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(Screen(robustness_answer(found, every=every)))
    return [line.rstrip() for line in console.export_text().splitlines()]


def flat(found, **how):
    return " ".join(" ".join(words(found, **how)).split())


def changed(found, scores=lambda values: values, happened=None):
    """Return an answer in which other things came of the same draws."""
    drawn = found.loops.draw(np.arange(1, found.draws + 1))
    rows = {name: scores(values.copy()) for name, values in drawn.scores.items()}
    truths = {**drawn.happened, **(happened or {})}
    return replace(found, tally=Tally.of(replace(drawn, scores=rows, happened=truths)))


def first_ones(count):
    return np.arange(100) < count


@pytest.mark.parametrize("name", ["three-tanks", "quadruple-tank", "averaging-tank"])
def test_it_is_a_screen(name):
    found = answered(name, draws=80)
    lines = words(found)
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert lines[1].startswith("On 95 % of the plants the error is at most ") or name[0] == "a"
    assert any(line.startswith("Next: ") for line in lines[-2:])


def test_the_answer_is_that_of_the_numbers(three):
    quantile, worst = three.quantile(ERROR), three.worst()
    said = flat(three)
    assert f"at most {quantile.value:.2f} times what it is on paper" in said
    assert f"({quantile.low:.2f} to {quantile.high:.2f})" in said
    assert f"on the worst, draw {worst.draw}, it is {worst.value:.2f} times" in said
    # Wilson: of 100 plants without one, z²/(n + z²) = 3.7 %.
    assert "the loop settles on all" in said and "Never seen, so each on at most 4 %" in said


def test_what_never_happened_has_the_widest_bound_of_those_told():
    """Steady states are counted among all draws, the rest among those that have one."""
    some = {**STILL, "outlet_1.area": {"from": "0.06 cm^2", "to": "0.4 cm^2"}}
    found = answered("quadruple-tank", draws=30, uncertainty=some, sensitivity=False)
    bound = found.tally.share(Happening.OVERFLOW).high
    assert found.tally.share(Happening.OVERFLOW).of == found.simulated < 30
    told = float(flat(found).partition("each on at most ")[2].partition(" %")[0])
    assert bound <= told / 100.0 <= 1.1 * bound
    assert f"On 95 % of the {found.simulated} plants that have a steady state" in flat(found)
    assert "as pump_1 would leave its range" in flat(found)


def test_what_happens_on_paper_too_is_no_news(three):
    dry = changed(three, happened={Happening.DRY: first_ones(90)})
    assert "! A tank runs empty: 90 %" in flat(dry)
    paper = replace(dry, on_paper=frozenset({Happening.DRY}))
    assert "• A tank runs empty on paper too, and in 90 % of 100 draws" in flat(paper)
    assert "! A tank runs empty" not in flat(paper)
    only = replace(three, on_paper=frozenset({Happening.DRY}))
    assert "A tank runs empty on paper too, and in 0 of 100 draws" in flat(only)
    never = flat(only).partition("Never seen")[2].partition(".")[0]
    assert "runs empty" not in never


def test_it_is_known_what_happens_on_paper():
    plant = cl.load("eight-tanks")
    name = "level_8.proportional_gain"
    calm = cl.design.simc(plant)
    bold = calm.with_values({name: 6.0 * calm.values[name]})
    found = [cl.robustness(c, plant, draws=5, sensitivity=False) for c in (calm, bold)]
    assert Happening.UNSTABLE not in found[0].on_paper and Happening.UNSTABLE in found[1].on_paper
    assert "the loop does not settle on paper either" in flat(found[1])
    assert found[1].as_dict()["happened"]["unstable"]["on_paper"] is True


def test_one_loop_that_breaks_is_the_worst_and_not_the_95_percent(three):
    def broken(values):
        values[:, 41] = np.inf
        return values

    found = changed(three, broken, {Happening.UNSTABLE: np.arange(100) == 41})
    said = flat(found)
    assert "on the worst, draw 42, the loop breaks, and the loop does not settle on 1 of" in said
    assert f"at most {found.quantile(ERROR).value:.2f} times" in said and "∞" in said
    assert "try a calmer controller" in said


def test_where_more_than_5_percent_break_no_number_is_told_for_them(three):
    def broken(values):
        values[:, :20] = np.inf
        return values

    found = changed(three, broken, {Happening.UNSTABLE: first_ones(20)})
    median = found.quantile(ERROR, 0.5).value
    assert (
        f"On more than 5 % of the plants the loop breaks, while on half of them the error is at "
        f"most {median:.2f} times what it is on paper." in flat(found)
    )
    all_broken = changed(three, lambda values: np.full_like(values, np.inf))
    assert "On more than half of the plants the loop breaks." in flat(all_broken)


def test_where_nothing_varies_it_says_so():
    found = answered("three-tanks", draws=80, uncertainty=STILL)
    said = flat(found)
    assert "! Nothing varies but the noise" in said and "parameter" not in words(found)[0]
    assert "On 95 % of the plants the error is what it is on paper, to a percent;" in said


def test_where_nothing_rests_there_is_no_number():
    wide = {**STILL, "outlet_1.area": {"from": "0.3 cm^2", "to": "0.4 cm^2"}}
    found = answered("quadruple-tank", draws=20, uncertainty=wide)
    lines = words(found)
    assert "No plant has an admissible steady state, as pump_1 would leave its" in flat(found)
    assert not any("IAE" in line or "times" in line for line in lines)
    assert "Next: narrow [uncertainty]" in flat(found)


def test_unknown_causes_are_unknown(three):
    some = {**STILL, "outlet_1.area": {"from": "0.06 cm^2", "to": "0.4 cm^2"}}
    found = answered("quadruple-tank", draws=30, uncertainty=some)
    left_out = found.sensitivity.left_out
    assert left_out > 256
    assert f"Which parameters matter is unknown: {left_out} of 512 comparisons" in flat(found)
    alike = replace(three, tally=changed(three, np.ones_like).tally)
    assert "No parameter matters" in flat(alike)


def test_what_to_know_better_is_named_whether_or_not_something_is_known(three):
    assert "write how well outlet_3" in flat(three)
    varied = {**STILL, "outlet_3.area": "10 %"}
    said = flat(answered("three-tanks", draws=20, uncertainty=varied))
    assert "Next: see the worst plant on the page; measure outlet_3.area better" in said


def test_too_few_draws_say_how_many_it_takes():
    said = flat(answered("three-tanks", draws=20, sensitivity=False))
    assert "an upper bound takes 72 draws" in said and ": 20 plants, 9 parameters" in said
    assert ": 1 plant, 9" in flat(answered("three-tanks", draws=1, sensitivity=False))


def test_all_has_every_score_event_cause_and_parameter(three):
    said = flat(three, width=160, every=True)
    for title in ("Noise movement of feed", "Setpoint level_3 +1 cm", "with all that it acts with"):
        assert title in said
    assert all(name in said for name in three.spread.signals)
    assert "The error is the mean of these" in said and "--all" not in said
    assert len(words(three)) < len(words(three, every=True))


def test_the_rare_happenings_are_counted_in_one_line(three):
    happened = {
        what: first_ones(count)
        for count, what in enumerate((Happening.STEADY, Happening.DRY, Happening.OVERFLOW,
                                      Happening.HARM, Happening.UNSTABLE), 1)
    }  # fmt: skip
    said = flat(changed(three, happened=happened))
    assert "And a tank runs empty (2) and an error stays (1)." in said
    assert said.index("does not settle: 5") < said.index("is harmed: 4") < said.index("spills: 3")
