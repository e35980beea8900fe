"""One pair of bounds of a tuning, as it was written in a study file."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.process.table_reader import TableReader, shown_value


@dataclass(frozen=True, eq=False)
class Bound:
    """The bounds of one parameter, or one weight, as they were written.

    Parameters
    ----------
    table : TableReader
        With a list of two quantities at `key`.
    key : str
        A parameter of the law, a key of a loop, or what a weight is of.
    owner : str or None
        What it belongs to, if that is written before it: a loop; of a weight its kind, "inputs".

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> text = b'level.gain = ["0.1 %/%", "10 %/%"]'
    >>> Bound(TableReader(parse(text, "study.toml"), ("level",), None), "gain", "level").owner
    'level'
    """

    table: TableReader
    key: str
    owner: str | None

    def check_order(self, low: float, high: float) -> None:
        """Refuse bounds of which the low one, as it was read, is not below the high one.

        Raises
        ------
        InputError
        """
        if not low < high:
            raise self.table.refused(
                self.key,
                shown_value(self.table.raw(self.key)),
                "a low bound below the high bound",
                "exchange or correct them",
            )
