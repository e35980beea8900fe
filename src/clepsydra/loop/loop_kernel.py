"""The kernel of a loop, one for all controllers that differ in numbers only."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from clepsydra.controllers.controller import Controller
from clepsydra.engine.kernel import Kernel
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.process.process import Process

if TYPE_CHECKING:
    from clepsydra.loop.running_scores import RunningScores

#: Lanes for the runs of an estimate, of which there are three.
_SIDE_BY_SIDE = 4
#: Kernels that are kept: those of a study's designs.
_KEPT = 32


def loop_kernel(
    process: Process,
    controller: Controller,
    constant: Mapping[str, float],
    substeps: int,
    *,
    adjustable: bool = False,
    scores: RunningScores | None = None,
    individual: tuple[str, ...] = (),
    fuse: bool = True,
) -> Kernel:
    """Return the kernel of `clepsydra.loop.closed_loop.closed_loop`, which takes the same.

    Half of a study's controllers have a law in common, as PI control: what it is wired to and the
    numbers of the process make its program, its own numbers are parameters. With scores it keeps
    the status of each scenario and stores no trajectories, nor alarms. Inputs may be `individual`:
    other ones in each scenario. Without `fuse` no multiply-add is fused.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> simc = cl.design.simc(plant)
    >>> tuned = replace(simc, values={**simc.values, "level_1.proportional_gain": 2.0})
    >>> first, second = (
    ...     loop_kernel(plant.process, each, {}, 1) for each in (simc, tuned))
    >>> first is second
    True
    """
    return _kernel(
        _Form(process, controller, dict(constant), substeps, adjustable, scores, individual, fuse)
    )


@dataclass(frozen=True, eq=False)
class _Form:
    """What makes a kernel; two are equal where process and law are the same objects."""

    process: Process
    controller: Controller
    constant: dict[str, float]
    substeps: int
    adjustable: bool
    scores: RunningScores | None
    individual: tuple[str, ...]
    fuse: bool

    def _compared(self) -> Hashable:
        wired = self.controller
        return (
            id(self.process), id(wired.law), wired.measurements, wired.setpoints,
            wired.manipulated, (*wired.free_inputs.items(),), wired.free_outputs,
            (*self.constant.items(),), self.substeps, self.adjustable,
            self.scores and self.scores.names, self.individual, self.fuse,
        )  # fmt: skip

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Form) and self._compared() == other._compared()

    def __hash__(self) -> int:
        return hash(self._compared())


@lru_cache(maxsize=_KEPT)
def _kernel(form: _Form) -> Kernel:
    program = closed_loop(
        form.process, form.controller, substeps=form.substeps, constant=form.constant,
        adjustable=form.adjustable, scores=form.scores, statuses=form.scores is not None,
        alarms=form.scores is None,
    )  # fmt: skip
    lanes = _SIDE_BY_SIDE if form.adjustable else None
    recorded = form.scores is None
    return Kernel(program, individual=form.individual, record=recorded, lanes=lanes, fuse=form.fuse)
