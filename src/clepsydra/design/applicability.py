"""Whether a design method can be used, and the reason where it cannot."""

from __future__ import annotations

from clepsydra.base.errors import ClepsydraError


class NotApplicable(ClepsydraError):
    """A design method cannot give a controller for this process.

    Parameters
    ----------
    method : str
        "SIMC"
    reason : str
        In the reader's words.

    Examples
    --------
    >>> print(NotApplicable("LQI", "tank_3.level is not measured"))
    LQI is not applicable: tank_3.level is not measured.
    """

    def __init__(self, method: str, reason: str) -> None:
        self.method = method
        self.reason = reason
        super().__init__(f"{method} is not applicable: {reason}.")
