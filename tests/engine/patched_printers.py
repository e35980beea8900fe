"""For tests that put something else in the place of a part of the printers."""

import os


def keep_nothing(monkeypatch):
    """Neither find machine code by what it was printed from, nor keep any: it is another's."""
    monkeypatch.setenv("CLEPSYDRA_CACHE", os.devnull)
