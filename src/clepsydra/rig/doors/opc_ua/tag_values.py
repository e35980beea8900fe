"""What the tags of a rig show, and which of them have changed since somebody looked."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence

import numpy as np
from asyncua import ua

from clepsydra.rig.doors.opc_ua.address_space import data_type
from clepsydra.rig.doors.opc_ua.told_value import GOOD, ToldValue
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import TagTable

#: Beyond the ends of a range, what rounding of a conversion explains [share of it].
_ROUNDING = 1e-9


class TagValues:
    """The tags of a table, looked at all together.

    Parameters
    ----------
    table : TagTable
    silent_after : float
        Where the plant has told nothing for so long, nobody knows what the tags are [s].

    Attributes
    ----------
    sample : int
        Of what was seen last; −1 for none.
    """

    def __init__(self, table: TagTable, silent_after: float = math.inf) -> None:
        self._table, self._silent_after = table, silent_after
        self._tags: Sequence[Tag] = tuple(table.tags.values())
        layout = table.image.layout
        # As in `ProcessImage.read`, what is told comes before what is written under its name.
        places = {name: place for place, name in reversed([*enumerate(layout.columns)])}
        self._cells = np.array([places[tag.cell] for tag in self._tags], int)
        judges = [table.tags.get(tag.judged_by) for tag in self._tags]
        self._judges = np.array([-1 if tag is None else places[tag.cell] for tag in judges], int)
        self._types = [data_type(tag) for tag in self._tags]
        self._places = {tag.name: place for place, tag in enumerate(self._tags)}
        self._seen = np.full(len(self._tags), math.nan)
        self._good = np.ones(len(self._tags), bool)
        self._told: list[ToldValue | None] = [None] * len(self._tags)
        self._written = np.empty(0)
        self._state: tuple[int, bool] | None = None
        self.sample, self._since = -1, time.monotonic()

    def told(self, name: str) -> ToldValue:
        """Return what was last seen of a tag."""
        found = self._told[self._places[name]]
        if found is None:
            raise KeyError(name)
        return found

    def look(self) -> list[tuple[str, ToldValue]]:
        """Look at all tags, and return those that have changed."""
        return list(self._changed(None))

    def look_at(self, name: str) -> list[tuple[str, ToldValue]]:
        """Look at one tag, and return it where it has changed."""
        return list(self._changed(self._places[name]))

    def _changed(self, one: int | None) -> Iterator[tuple[str, ToldValue]]:
        image = self._table.image
        told = image.published()
        now = time.monotonic()
        if told.sample != self.sample:
            self.sample, self._since = told.sample, now
        written = image.written()
        state = (told.sample, now - self._since > self._silent_after)
        if one is None and state == self._state and np.array_equal(written, self._written):
            return
        row = np.append(np.concatenate([told.values, written]), 1.0)
        cells, good = row[self._cells], row[self._judges] != 0.0
        alike = np.equal(cells, self._seen) | (np.isnan(cells) & np.isnan(self._seen))
        changed = ~alike | (good != self._good)
        if one is None:
            self._written = written
            changed |= self._became(*state)
            places = np.flatnonzero(changed)
        else:
            places = np.flatnonzero(changed[one : one + 1]) + one
        self._seen[places], self._good[places] = cells[places], good[places]
        for place in places.tolist():
            tag = self._tags[place]
            value, status = self._judged(tag, float(cells[place]), bool(good[place]))
            found = ToldValue(self._types[place], value, status, told.time)
            self._told[place] = found
            yield tag.name, found

    def _became(self, sample: int, silent: bool) -> bool:
        """Take what the plant is now, and return whether all its values have another status."""
        before, self._state = self._state, (sample, silent)
        return before is None or before[1] != silent or (before[0] < 0) != (sample < 0)

    def _judged(self, tag: Tag, cell: float, good: bool) -> tuple[float | None, int]:
        """Return the value that is told, none where the status is bad (OPC 10000-4 1.05, 7.11)."""
        codes = ua.StatusCodes
        sample, silent = self._state or (-1, False)
        if sample < 0:
            return None, codes.BadWaitingForInitialData
        if silent:
            return None, codes.BadNoCommunication
        value = tag.on_wire(cell)
        if not good or not math.isfinite(value):
            return None, codes.BadSensorFailure
        signal = tag.signal
        if signal.kind == "integer" and not 0.0 <= value <= signal.high:
            return None, codes.BadOutOfRange
        if signal.kind == "real" and signal.has_range:
            beyond = max(signal.low - value, value - signal.high)
            if beyond > _ROUNDING * signal.span:
                return value, codes.UncertainEngineeringUnitsExceeded
        return value, GOOD
