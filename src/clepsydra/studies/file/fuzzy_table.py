"""A fuzzy controller whose sets and rules stand in a file of their own."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import FuzzyFile, WiredFuzzy, load_fuzzy
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.errors_at import errors_at
from clepsydra.studies.file.fields import file_beside
from clepsydra.studies.file.written import Written, WrittenMaker


@dataclass(frozen=True)
class FuzzyTable(Written):
    """Sets and rules in a file; the outputs start at the operating point.

    Raises
    ------
    InputError
        There is no such file, or something in it is wrong; then the place is in that file.

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from pathlib import Path
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
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
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "halves.toml").write_text(rules)
    ...     table = TableReader(parse(b'fuzzy = "halves.toml"', "study.toml"), (), ["fuzzy"])
    ...     read = FuzzyTable.read(table, "two rules", plant.process, Path(folder))
    ...     make = read.maker()
    >>> make(plant.linear).initial_state["pump_1.last_output"]
    3.0
    """

    fuzzy: FuzzyFile = file_beside(
        "a file of sets and rules",
        "the name of a file of sets and rules",
        'write as in fuzzy = "rules.toml"',
        load_fuzzy,
    )

    def maker(self) -> WrittenMaker:
        """Wire it to the process."""
        wired = WiredFuzzy(self.fuzzy, self.process)

        def make(model: LinearModel) -> Controller:
            with errors_at(self.table):
                return wired.controller(operating_point_of(model), self.name)

        return make
