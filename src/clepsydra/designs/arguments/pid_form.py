"""The form of PID controller as the argument of a design, which several keys make."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.base.quantity import declared
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.arguments.argument import Argument
from clepsydra.process.declared import read_fields
from clepsydra.process.errors_at import errors_at

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

#: What the design itself decides of the form.
_DECIDED = ("error", "setpoint_ramp", "remote_setpoint")


def _form(table: TableReader, key: str, process: Process) -> PidForm:
    with errors_at(table):
        return PidForm(**read_fields(PidForm, table))


FORM = Argument(
    "form",
    _form,
    {key: each.schema for key, each in declared(PidForm).items() if key not in _DECIDED},
)
