"""A step of a task: what has to hold, all at once, and for how long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from clepsydra.base.arguments import require_known
from clepsydra.base.quantity import quantity
from clepsydra.laboratory.lessons.bands import Band, read_bands
from clepsydra.laboratory.lessons.told_text import line
from clepsydra.process import told
from clepsydra.process.declared import keys_of, part, read_fields
from clepsydra.process.table_reader import TableReader


def controller_field(words: str) -> Any:
    """Return the field of the name of a controller of the lesson; empty where it is left out."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
        if not table.has(key):
            return ""
        names = [each.name for each in known["controllers"]]
        name = table.text(key, "the name of a controller", f'write as in {key} = "{names[0]}"')
        require_known(table.place(key), name, names, "a controller of this lesson")
        return name

    return part(read, **told.text(words))


@dataclass(frozen=True, kw_only=True)
class Reach:
    """What has to hold in a step.

    Parameters
    ----------
    words : str
    bands : mapping
        Signal, mode of an input, or parameter to its band [SI].
    controller : str
        Who has the rig; empty for anyone.
    hold : float
        For how long [s]; 0 for one sample.
    """

    words: str = line("what the reader is told to reach")
    bands: dict[str, Band] = part(
        lambda table, key, known: read_bands(table, "where", known["process"]),
        {
            "where": told.by_name(
                'what has to hold: a signal or a parameter, `level_1 = ["58 %", "62 %"]`, an exact '
                'value, `"outlet_1.area" = "0 cm^2"`, or a mode, `"pump_1.mode" = "manual"`',
                {"type": ["string", "number", "array"]},
            )
        },
    )
    controller: str = controller_field("who has the rig; anyone if left out")
    hold: float = quantity(
        "s",
        "a time",
        at_least=0.0,
        default=0.0,
        remedy="leave it out where one sample is enough",
    )


def read_reach(table: TableReader, **known: Any) -> tuple[Reach, ...]:
    """Read the steps of a task in their order.

    Raises
    ------
    InputError
        One asks for nothing, or something in it is wrong.
    """
    rows = table.tables(
        "reach", "what to reach, a table each", "write [[tasks.reach]]", keys_of(Reach)
    )
    found = []
    for row in rows:
        reach = Reach(**read_fields(Reach, row, **known))
        if not reach.bands and not reach.controller:
            raise row.wrong("where", "what has to hold", "write where, controller, or both")
        found.append(reach)
    return tuple(found)
