"""One run of each document for every test that asks for it, in any process, and its page."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

from clepsydra.papers.audit import Audit, DocumentAudit, audit
from clepsydra.papers.document import documents

PAGES = Path(__file__).parents[2] / "docs" / "papers"


@pytest.fixture(scope="session")
def audited(alone) -> Callable[[str], DocumentAudit]:
    """Key to a document with what its experiments found, audited by the worker that is first."""

    @cache
    def found(key: str) -> DocumentAudit:
        with alone(f"audit-{key}") as folder:
            file = folder / f"audit-{key}.pickle"
            if not file.exists():
                file.write_bytes(pickle.dumps(audit([key]).documents[0]))
            return pickle.loads(file.read_bytes())

    return found


@pytest.fixture(scope="session")
def page_holds(audited) -> Callable[[str], bool]:
    """Whether the page of a document prints the sentence that its audit gives now."""

    def holds(key: str) -> bool:
        words = (PAGES / f"{key}.md").read_text("utf-8")
        return Audit((audited(key),)).summary in words

    return holds


@pytest.fixture(scope="module", autouse=True)
def _forgotten() -> Iterator[None]:
    """Let go after a module what the documents keep of their runs: it comes to gigabytes."""
    yield
    for document in documents().values():
        document.forget()
