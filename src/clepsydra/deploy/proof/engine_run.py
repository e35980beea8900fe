"""The engine's kernel over the scans of a proof, with every state to be seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.proof.instance import Array, Scans, scan_count
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program

_KEPT = "kept."


def engine_run(program: Program, inputs: Scans, *, fuse: bool = True) -> Array:
    """Run the kernel over all scans; returns outputs and then states [scans, q + n].

    A state is that after the scan; of a delay ring it is the value that the next scan reads, as
    in `clepsydra.deploy.proof.instance.Instance`.

    Parameters
    ----------
    fuse : bool
        As of `clepsydra.engine.kernel.Kernel`.
    """
    from clepsydra.engine.kernel import Kernel

    shown = tuple(Signal(f"{_KEPT}{entry.name}") for entry in program.state)
    block = program.block
    # A parameter that changes is an input of the kernel.
    tuned = {p.name: np.full(scan_count(inputs), p.initial) for p in program.parameters}
    for name, values in tuned.items():
        if name in inputs:
            tuned[name] = np.where(np.isnan(inputs[name]), values, inputs[name])
    whole = replace(
        program,
        inputs=program.inputs + program.parameters,
        parameters=(),
        outputs=program.outputs + shown,
        block=replace(block, results=block.results + program.next_state),
    )
    run = Kernel(whole, fuse=fuse).run(scan_count(inputs), inputs=dict(inputs) | tuned)
    columns = [run.output(signal.name)[0] for signal in program.outputs]
    for entry in program.state:
        column = run.output(f"{_KEPT}{entry.name}")[0]
        if isinstance(entry, DelayRing):
            # The kernel shows what goes into a ring.
            start = np.full(entry.length - 1, signal_of(entry).initial)
            column = np.concatenate([start, column])[: len(column)]
        columns.append(column)
    return np.column_stack(columns) if columns else np.zeros((scan_count(inputs), 0))
