"""What a session that was run again says: where it ended, and its scores."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.base.words import time_text
from clepsydra.laboratory.replay import Replayed
from clepsydra.report.alarm_tables import alarms_of_run
from clepsydra.report.quantities import number_text, quantity_text
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import ScoreKey, by_signal

#: What of the scores is told on a screen.
_TOLD = ("iae", "total_variation", "time_in_saturation")


def session_answer(found: Replayed) -> Section:
    """Return where a session ended, and its scores."""
    samples, touches = found.session.samples, len(found.session.touches)
    said = time_text(samples * found.process.sampling_period, 4)
    hands = f"{touches} {'touch' if touches == 1 else 'touches'}"
    words = f"{found.process.title}, {said}: {samples} samples, {hands}."
    levels = tuple(
        (name, quantity_text(found.process.signal(name), value, 6))
        for name, value in found.levels.items()
    )
    scores = tuple(
        (str(ScoreKey(key, signal)), SCORES[key].words, number_text(value, 6))
        for key in _TOLD
        for signal, value in by_signal(found.scores, key).items()
    )
    tables = (
        Table("Where it ends", ("state", "value"), levels),
        Table("Scores, in SI units", ("score", "what it is", "value"), scores),
    )
    return Section("Session", (Line(words, Mark.ANSWER), *tables, *alarms_of_run(found)))
