"""The audit as a whole: its rows have names of their own, and processes may share its work."""

import pytest

from clepsydra.papers import audit as audits
from clepsydra.papers.comparison import claimed
from clepsydra.papers.documents import load_document
from clepsydra.papers.experiment import Document, Experiment, Findings


def test_two_rows_of_one_name_are_a_mistake(monkeypatch):
    row = claimed("t", "n", "c", True, "1", reason="r")
    twice = Document("d", "d", "d", (Experiment("e", "e", lambda: Findings((row, row))),))
    monkeypatch.setattr(audits, "load_document", lambda key: twice)
    with pytest.raises(AssertionError, match="more than once"):
        audits.audit(["d"])


@pytest.mark.thorough
def test_processes_share_the_work_and_find_the_same(audited):
    told = []
    shared = audits.audit(["three-tanks"], workers=2, progress=told.append)
    assert shared.rows == audited("three-tanks").rows
    parts = len(load_document("three-tanks").experiments)
    assert [each.done for each in told] == list(range(1, parts + 1))
    assert {each.of for each in told} == {parts}
