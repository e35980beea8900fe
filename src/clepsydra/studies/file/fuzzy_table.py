"""A fuzzy controller whose sets and rules stand in a file of their own."""

from __future__ import annotations

from pathlib import Path

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.wired import WiredFuzzy
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process import told
from clepsydra.process.errors_at import errors_at
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.request import WrittenMaker

FUZZY = told.table({"fuzzy": told.text("a file of sets and rules")}, ("fuzzy",))


def read_fuzzy(table: TableReader, name: str, process: Process, folder: Path) -> WrittenMaker:
    """Read the file of sets and rules that a controller names.

    Its outputs start at the operating point.

    Parameters
    ----------
    table : TableReader
        With the keys of `FUZZY`.
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
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from clepsydra.process.document import parse
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
    ...     make = read_fuzzy(table, "two rules", plant.process, Path(folder))
    >>> make(plant.linear).initial_state["pump_1.last_output"]
    3.0
    """
    expected, remedy = "the name of a file of sets and rules", 'write as in fuzzy = "rules.toml"'
    written = table.text("fuzzy", expected, remedy)
    if not (folder / written).is_file():
        raise table.refused(
            "fuzzy", written[:60], f"{expected} that exists, from {folder}/", remedy
        )
    wired = WiredFuzzy(load_fuzzy(folder / written), process)

    def make(model: LinearModel) -> Controller:
        with errors_at(table):
            return wired.controller(operating_point_of(model), name)

    return make
