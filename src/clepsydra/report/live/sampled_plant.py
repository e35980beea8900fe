"""The sampled linear model of a process as a page holds it, from which margins follow."""

from __future__ import annotations

from typing import Any

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.inner_setpoints import inner_loops
from clepsydra.report.live.packed import packed_numbers


def sampled_plant(controller: Controller, model: LinearModel) -> dict[str, Any]:
    """Return what `clepsydra.designs.sampled.sampled_loop` makes a loop of, but for the law."""
    loops = SampledLoops(controller, model)
    process = operating_point_of(model).process
    spans = np.array([process.signal(name).span for name in controller.manipulated])
    controlled = tuple(dict.fromkeys(controller.setpoints))
    matrices = (
        loops.held, loops.moved, loops.measured, loops.controlled, loops.enters, loops.sizes,
        np.where(np.isfinite(spans), spans, 1.0),
    )  # fmt: skip
    return {
        "states": len(loops.held),
        "packed": packed_numbers(matrices),
        "measurements": controller.measurements,
        "controlled": controlled,
        "manipulated": controller.manipulated,
        "inner": list(dict.fromkeys(name for _, name in inner_loops(controller))),
    }
