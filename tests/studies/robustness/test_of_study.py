"""The first controllers of a study on drawn plants: the column, and who is demoted."""

from __future__ import annotations

from importlib.resources import files

import pytest

import clepsydra as cl
from clepsydra.studies.result import Standing


@pytest.fixture(scope="module")
def wide(tmp_path_factory):
    """Three coupled tanks of which every area may be 60 % smaller or larger than on paper."""
    text = (files("clepsydra.process.catalogue") / "three-tanks.toml").read_text(encoding="utf-8")
    path = tmp_path_factory.mktemp("wide") / "three-tanks.toml"
    path.write_text(f'{text}\n[uncertainty]\ndefault = "60 %"\n')
    return cl.load(path)


def test_the_worst_of_the_draws_stands_beside_the_error_on_paper():
    plant = cl.load("three-tanks")
    study = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    found = study.with_draws(16)
    assert [each.drawn.draws for each in found.ranking] == [16, 16]
    assert "worst of 16" in str(found)
    assert "worst of" not in str(study)
    best = found.ranking[0]
    alone = cl.robustness(best.controller, plant, draws=16, sensitivity=False)
    assert best.drawn.worst == alone.worst().value
    assert [each.controller.name for each in found.ranking] == [
        each.controller.name for each in study.ranking
    ]
    assert found.as_dict()["ranking"][0]["drawn"] == {
        "draws": 16, "worst": best.drawn.worst, "unsettled": 0,
    }  # fmt: skip


def test_who_does_not_settle_on_some_plants_goes_behind_who_does(wide):
    """With 9 %/% and 80 s it is the best on paper, at max|S| 1.70."""
    calm = cl.design.simc(wide)
    fast = calm.with_values({"level_3": {"K": "9 %/%", "Ti": "80 s"}}).named("fast")
    study = cl.study(wide, [fast, calm])
    assert study.best.controller.name == "fast"
    assert study.best.standing is Standing.ROBUST
    found = study.with_draws()
    assert [each.controller.name for each in found.ranking] == ["PI, SIMC", "fast"]
    last = found.ranking[-1]
    assert last.drawn.unsettled > 0
    assert last.standing is Standing.STABLE
    words = f"Does not settle on {last.drawn.unsettled} of {last.drawn.draws} drawn plants"
    assert words in last.reason
    assert found.verdict.startswith("Use PI, SIMC on")
    assert f"{last.drawn.unsettled} unstable" in str(found)


def test_who_does_not_settle_is_said_so_in_a_study_of_cases_too(wide):
    calm = cl.design.simc(wide)
    fast = calm.with_values({"level_3": {"K": "9 %/%", "Ti": "80 s"}}).named("fast")
    low = wide.at(outputs={"level_3": f"{0.9 * wide.point.as_dict()['level_3']} m"})
    found = cl.study(wide, [fast, calm], cases={"low": low}).with_draws(64)
    last = next(each for each in found.ranking if each.controller.name == "fast")
    assert last.drawn.unsettled > 0
    assert last.reason.startswith(f"Does not settle on {last.drawn.unsettled} of")
