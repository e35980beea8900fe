"""What a page asks of a law beside its loop: where it rests, and how it answers small changes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import StepLawDerivatives
from clepsydra.designs.sampled.sampled_loop import inputs_at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.law_begin import inputs_in_mode
from clepsydra.loop.loop import Loop
from clepsydra.loop.standing_in_manual import MOST_SAMPLES, ROUNDING, SAMPLES
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.known_routines import without_routines
from clepsydra.program.program import Program
from clepsydra.program.reader import inline, program_of
from clepsydra.report.live.modules import Modules


def resting(loop: Loop, modules: Modules) -> dict[str, Any]:
    """Return a sample of a law, and what it gets in it: a page finds with it where the law rests.

    It does so as `clepsydra.studies.tuning.resting_states` does.
    """
    law, controller = loop.controller.law, loop.controller
    own = program_of(law)
    results = own.block.results[: len(law.state)]
    block = replace(own.block, results=results).without_unread()
    # What a ring holds is the same all along it there.
    alone = replace(own, state=tuple(map(signal_of, law.state)), outputs=(), block=block)
    at_rest = {**loop.at_rest(), **loop.point.as_dict()}
    manual, automatic = (
        inputs_in_mode(loop, at_rest, mode).tolist() for mode in (Mode.MANUAL, Mode.AUTOMATIC)
    )
    return {
        "module": modules.add(alone, record=False),
        "state": [controller.initial_state[entry.name] for entry in law.state],
        "rings": [place for place, each in enumerate(law.state) if isinstance(each, DelayRing)],
        "manual": manual,
        "automatic": automatic,
        "samples": SAMPLES,
        "most": MOST_SAMPLES,
        "rounding": ROUNDING,
    }


def slopes(controller: Controller, model: LinearModel, modules: Modules) -> dict[str, Any] | None:
    """Return the derivatives of a law as a program of its parameters, then of its state at rest.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point.

    Returns
    -------
    dict or None
        None of a law with a loop whose derivative CasADi writes as no program can have it: of
        rules, or of the process's equations in steps.
    """
    law = controller.law
    law = replace(law, function=without_routines(law.function))
    given, state, matrices = StepLawDerivatives(law).expressions(inputs_at_rest(controller, model))
    entries = [
        (number, row, column)
        for number, matrix in enumerate(matrices)
        for row, column in zip(*matrix.sparsity().get_triplet(), strict=True)
    ]
    found = ca.vertcat(*(matrices[number][row, column] for number, row, column in entries))
    function = ca.Function("slopes", [given, state], [ca.densify(found)])
    rest = tuple(Signal(f"rest_{place}") for place in range(len(law.state)))
    parameters = (*law.parameters, *rest)
    builder = BlockBuilder(len(parameters))
    try:
        results = inline(builder, function, range(len(parameters)))
    except ClepsydraError:
        return None
    block = builder.finish(results)
    shown = tuple(Signal(f"slope_{place}") for place in range(len(entries)))
    program = Program(f"{law.name}_slopes", (), (), parameters, shown, block)
    step_x, _, _, output_u = matrices
    setpoints = len(controller.setpoints)
    return {
        "module": modules.add(program),
        "entries": entries,
        "states": step_x.size1(),
        "setpoints": setpoints,
        "measurements": output_u.size2() - setpoints,
        "outputs": output_u.size1(),
        "longer": [
            (place, entry.length - 1) for place, entry in enumerate(law.state) if is_ring(entry)
        ],
    }
