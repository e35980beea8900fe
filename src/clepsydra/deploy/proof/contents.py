"""The printed files that a target runs; digests of them and of what they run through."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping

import numpy as np

from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.proof.item import ProofItem

#: Name of a printed file to what is in it.
Contents = Mapping[str, bytes]
_LENGTH = 16


def contents_digest(contents: Contents) -> str:
    """Return a digest of files, names included.

    Examples
    --------
    >>> first, other = contents_digest({"a.c": b"x"}), contents_digest({"a.c": b"y"})
    >>> len(first), first == other
    (16, False)
    """
    return _digest(part for name in sorted(contents) for part in (name.encode(), contents[name]))


def tables_digest(tables: Mapping[str, np.ndarray]) -> str:
    """Return a digest of tables of numbers, their names included.

    Examples
    --------
    >>> tables_digest({"u": np.zeros(2)}) == tables_digest({"u": np.array([0.0, -0.0])})
    False
    """
    return _digest(
        part
        for name in sorted(tables)
        for part in (name.encode(), repr(tables[name].shape).encode(), _bytes(tables[name]))
    )


def loop_digest(item: ProofItem) -> str:
    """Return a digest of the loop in which an item is scored; empty where there is none.

    Of the controller its wires and where it starts, of the process its program and where it
    rests, and the scenario; the controller's own program has a digest of its own.

    Examples
    --------
    >>> loop_digest(ProofItem("own law", 1.0))
    ''
    """
    controller, point, scenario = item.controller, item.point, item.scenario
    if controller is None or point is None:
        return ""
    from clepsydra.deploy.process_program import process_program

    said = [
        controller.input_wires, controller.output_wires, controller.initial_state,
        controller.values, controller.free_inputs, point.as_dict(),
        digest(process_program(point)),
    ]  # fmt: skip
    parts = [repr(each).encode() for each in said]
    if scenario is not None:
        parts.append(repr((scenario.sampling_period, scenario.segments, scenario.seed)).encode())
        parts += [
            part
            for table in (scenario.setpoints, scenario.disturbances, scenario.noise)
            for part in (repr(np.shape(table)).encode(), _bytes(table))
        ]
    return _digest(parts)


def _bytes(table: np.ndarray) -> bytes:
    return np.ascontiguousarray(table, dtype=float).tobytes()


def _digest(parts: Iterable[bytes]) -> str:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(len(part).to_bytes(8, "little"))
        whole.update(part)
    return whole.hexdigest()[:_LENGTH]
