"""The grammar of a ranking."""

import pytest

from clepsydra.scores.score import SCORES
from clepsydra.studies.ranking import rule_of
from clepsydra.studies.ranking_words import in_sentence, with_article


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("setpoint error", "a setpoint error"),
        ("load error", "a load error"),
        ("outflow change", "an outflow change"),
        ("IAE of level_1", "an IAE of level_1"),
        ("rise time", "a rise time"),
    ],
)
def test_the_article_fits_the_sound(words, said):
    assert with_article(words) == said


def test_no_title_of_a_score_stands_with_a_capital_within_a_sentence_but_abbreviations():
    for score in SCORES.values():
        shown = in_sentence(score.title)
        assert shown.lower() == score.title.lower()
        assert shown[0].islower() or shown.split(",")[0].isupper()


def test_the_rule_of_asked_scores_is_one_sentence():
    assert "mean of IAE and total variation, each averaged" in rule_of(["iae", "total_variation"])
