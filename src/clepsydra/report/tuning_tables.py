"""What a tuning by simulation changed, as tables."""

from __future__ import annotations

from clepsydra.base.section import Table
from clepsydra.process.process import Process
from clepsydra.report.facts import DIGITS
from clepsydra.report.quantities import number_text
from clepsydra.report.score_tables import score_text
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.tuning.result import TuningResult


def tuning_grid(tuning: TuningResult, process: Process, duration: float = 0.0) -> Table:
    """Return objective, scores and max\\|S\\| before and after a tuning.

    Parameters
    ----------
    tuning : TuningResult
    process : Process
        Lends display units.
    duration : float
        Of the runs that were compared [s], as `clepsydra.report.score_tables.score_text` takes it.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.process.reader import load_process
    >>> found = SimpleNamespace(objective=0.6, start_objective=1.0, maximum_sensitivity=1.8,
    ...     start_maximum_sensitivity=1.2, scores={"iae[level_1]": 30.0},
    ...     start_scores={"iae[level_1]": 50.0})
    >>> tuning_grid(found, load_process("quadruple-tank")).rows[2]
    ('IAE of level_1', '50.0 V s', '30.0 V s')
    """
    peaks = tuning.start_maximum_sensitivity, tuning.maximum_sensitivity
    errors = tuning.start_objective, tuning.objective
    rows = [
        ("objective", *(number_text(value, DIGITS) for value in errors)),
        ("max|S|", *(number_text(value) for value in peaks)),
    ]
    for key, value in tuning.scores.items():
        name, signal = score_key(key)
        before = tuning.start_scores[key]
        if name in SCORES and signal:
            cells = [
                " ".join(score_text(process, signal, number, SCORES[name], duration)).strip()
                for number in (before, value)
            ]
            rows.append((score_key(key).title, *cells))
        else:
            rows.append((key, number_text(before), number_text(value)))
    return Table("Tuned by simulation", ("", "start", "tuned"), tuple(rows))
