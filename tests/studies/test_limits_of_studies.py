"""A study beside the physical limit: in its ranking, report and JSON, and kept."""

import pytest

import clepsydra as cl
from clepsydra.studies import kept_limits, kept_work

STEP = [cl.step("level_3", "+1 cm", at="1 min")]


@pytest.fixture(scope="module")
def found():
    """Two controllers of the three tanks and one step of 1 cm."""
    plant = cl.load("three-tanks")
    return cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)], STEP)


@pytest.fixture(scope="module")
def beside(found):
    """The same beside the limit."""
    return found.with_limits()


def test_a_multiple_is_that_of_the_score(beside):
    """One output, one step: the multiple is that of its IAE after the step."""
    for each in beside.ranking:
        error = each.scores["iae_setpoint[level_3]"] / 0.01
        assert beside.times_limit(each) == pytest.approx(error / beside.limits.index, rel=1e-9)
        assert beside.times_limit(each) > 1.0


def test_the_ranking_the_answer_and_json_tell_it(found, beside):
    times = beside.times_limit(beside.recommended)
    assert "× limit" in str(beside) and "× limit" not in str(found)
    said = " ".join(str(beside).split())
    assert f"is {times:.3g} times the least that any controller could leave" in said
    told = beside.as_dict()["limit"]
    assert told["times"][beside.recommended.controller.name] == times
    assert "course" not in told["events"][0] and "limit" not in found.as_dict()


def test_the_report_draws_the_best_course(beside, tmp_path):
    beside.report(tmp_path / "it.html")
    text = (tmp_path / "it.html").read_text("utf-8")
    assert "The best that any controller could do" in text and "the best possible" in text


def test_what_was_found_is_kept(found, tmp_path, monkeypatch):
    store = kept_work.ObjectCache(tmp_path / "studies")
    monkeypatch.setattr(kept_work, "default_store", lambda: store)
    first = found.with_limits()
    monkeypatch.setattr(kept_limits, "limits_of", None)  # which would fail if it were asked
    again = found.with_limits()
    assert again.limits.index == first.limits.index
    assert again.limits.found[0].proofs == first.limits.found[0].proofs
    assert again.times_limit(again.best) == first.times_limit(first.best)
