"""The scores by name: those that the files of this folder declare, and any declared later."""

from __future__ import annotations

import importlib
import pkgutil

import clepsydra.scores
from clepsydra.scores.score import REGISTERED, Of

#: Score by key, in the order of tables: by what it is of, then as the files build on each other.
SCORES = REGISTERED

for _module in pkgutil.iter_modules(clepsydra.scores.__path__):
    importlib.import_module(f"clepsydra.scores.{_module.name}")
for _score in sorted(SCORES.values(), key=lambda score: list(Of).index(score.of)):
    SCORES[_score.key] = SCORES.pop(_score.key)
