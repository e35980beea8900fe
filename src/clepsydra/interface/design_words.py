"""What the designs are called and what they are, the usual ones first."""

from __future__ import annotations

from clepsydra.designs.design import DESIGNS


def design_words() -> tuple[tuple[str, str], ...]:
    """Return name and words of each design, in the order in which studies try them.

    >>> design_words()[1]
    ('simc', 'PI or PID by SIMC')
    """
    return tuple((name, each.words) for name, each in DESIGNS.known().items())
