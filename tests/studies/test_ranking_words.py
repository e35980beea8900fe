"""The grammar of a ranking."""

from clepsydra.scores.score import SCORES
from clepsydra.studies.ranking import rule_of
from clepsydra.studies.ranking_words import in_sentence


def test_no_title_of_a_score_stands_with_a_capital_within_a_sentence_but_abbreviations():
    for score in SCORES.values():
        shown = in_sentence(score.title)
        assert shown.lower() == score.title.lower()
        assert shown[0].islower() or shown.split(",")[0].isupper()


def test_the_rule_of_asked_scores_is_one_sentence():
    assert "mean of IAE and total variation, each averaged" in rule_of(["iae", "total_variation"])
