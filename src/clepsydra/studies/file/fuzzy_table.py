"""A fuzzy controller whose sets and rules stand in a file of their own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.wired import WiredFuzzy
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.placed import placed

FUZZY_KEYS = ("fuzzy",)


@dataclass(frozen=True, eq=False)
class FuzzyTable:
    """A fuzzy controller of a study file.

    Parameters
    ----------
    table : TableReader
    name : str
        Of the controller.
    wired : WiredFuzzy

    Examples
    --------
    See `read_fuzzy_table`.
    """

    table: TableReader
    name: str
    wired: WiredFuzzy

    def controller(self, point: OperatingPoint) -> Controller:
        """Return the controller, whose outputs start at the operating point."""
        with placed(self.table):
            return self.wired.controller(point, self.name)


def read_fuzzy_table(table: TableReader, name: str, process: Process, folder: Path) -> FuzzyTable:
    """Read the file of sets and rules that a controller names.

    Parameters
    ----------
    table : TableReader
        With `FUZZY_KEYS`.
    name : str
        Of the controller.
    process : Process
    folder : Path
        Of the study file, where the path of the other file starts.

    Raises
    ------
    InputError
        There is no such file, or something in it is wrong; then the place is in that file.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> rules = '''
    ... [inputs.e]
    ... of = "level_1"
    ... unit = "V"
    ... [inputs.e.sets]
    ... N = { left_shoulder = [-1, 1] }
    ... P = { right_shoulder = [-1, 1] }
    ... [outputs.u]
    ... moves = "pump_1"
    ... unit = "V/s"
    ... action = "increment"
    ... range = [-1, 1]
    ... [outputs.u.sets]
    ... S = { left_shoulder = [-1, 1] }
    ... L = { right_shoulder = [-1, 1] }
    ... [rules]
    ... R1 = "if e is N then u is S"
    ... R2 = "if e is P then u is L"
    ... '''
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "halves.toml").write_text(rules)
    ...     table = TableReader(parse(b'fuzzy = "halves.toml"', "study.toml"), (), FUZZY_KEYS)
    ...     found = read_fuzzy_table(table, "two rules", point.process, Path(folder))
    >>> found.controller(point).initial_state["pump_1.last_output"]
    3.0
    """
    expected, remedy = "the name of a file of sets and rules", 'write as in fuzzy = "rules.toml"'
    written = table.text("fuzzy", expected, remedy)
    if not (folder / written).is_file():
        raise table.refused(
            "fuzzy", written[:60], f"{expected} that exists, from {folder}/", remedy
        )
    return FuzzyTable(table, name, WiredFuzzy(load_fuzzy(folder / written), process))
