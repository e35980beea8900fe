"""The arguments of a design, read from the keys of a study file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from clepsydra.designs.arguments.weights import OfModel
from clepsydra.designs.design import Design
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader


def read_arguments(table: TableReader, design: Design, process: Process) -> dict[str, Any]:
    """Return the keyword arguments of a design that a table gives.

    Parameters
    ----------
    table : TableReader
        Its keys have been checked against `Design.file_keys`.

    Returns
    -------
    dict
        An argument that needs the model is a function of it, wrapped in `OfModel`.
        A pairing that is left out is that of the analysis, and missing here.

    Raises
    ------
    InputError
        A value is none of its argument, or an argument without a default is missing.

    Examples
    --------
    >>> from clepsydra.designs.design import DESIGNS
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b"closed_loop_time_constant = '5 min'\\nalgorithm = 'series'"
    >>> table = TableReader(parse(text, "study.toml"), (), None)
    >>> found = read_arguments(table, DESIGNS["simc"], load_process("equalisation-tank"))
    >>> found["form"].algorithm, found["closed_loop_time_constant"]
    ('series', 300.0)
    """
    found: dict[str, Any] = {}
    for name, argument in design.declared.items():
        if name in design.required or any(map(table.has, argument.keys)):
            found[name] = argument.read(table, name, process)  # says what is missing
    return found


def with_model(arguments: Mapping[str, Any], model: LinearModel) -> dict[str, Any]:
    """Return the arguments of a design for a model.

    Examples
    --------
    >>> with_model({"arrest_time": 60.0}, None)
    {'arrest_time': 60.0}
    """
    return {
        name: value.of(model) if isinstance(value, OfModel) else value
        for name, value in arguments.items()
    }
