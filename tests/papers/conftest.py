"""One run of each document for every test of a process that asks for it, and the page beside it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from clepsydra.papers.audit import Audit, DocumentAudit, audit

PAGES = Path(__file__).parents[2] / "docs" / "papers"


@cache
def _audited(key: str) -> DocumentAudit:
    (document,) = audit([key]).documents
    return document


@pytest.fixture(scope="session")
def audited() -> Callable[[str], DocumentAudit]:
    """Key to a document with what its experiments found."""
    return _audited


@pytest.fixture(scope="session")
def page_holds() -> Callable[[str], bool]:
    """Whether the page of a document prints the sentence that its audit gives now."""

    def holds(key: str) -> bool:
        words = (PAGES / f"{key}.md").read_text("utf-8")
        return Audit((_audited(key),)).summary in words

    return holds
