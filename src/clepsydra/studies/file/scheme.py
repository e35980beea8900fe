"""A control scheme of a study file → its step law, its numbers, and a controller."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import first_samples, state_at_rest
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.parameters import check_parameters
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.errors_at import errors_at
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.scheme_blocks import SchemeBlocks
from clepsydra.studies.file.scheme_parts import SchemeParts
from clepsydra.studies.file.scheme_wiring import Wiring
from clepsydra.studies.file.written import WrittenMaker

FAMILY = "control scheme"


@dataclass(frozen=True)
class Scheme(SchemeParts):
    """A control scheme that is written out loop by loop.

    The controller starts at rest at the operating point, as far as its setpoints allow.

    Raises
    ------
    InputError
        A part is wrong by itself, or the parts do not fit together.
    """

    def maker(self) -> WrittenMaker:
        """Wire the parts, and read the numbers of their blocks."""
        process, wiring = self.process, Wiring(self)
        blocks = SchemeBlocks(self, wiring)
        with errors_at(self.table, blocks.places):
            law = blocks.law(self.name)
            values = {parameter.name: parameter.initial for parameter in law.parameters}
            values |= blocks.values
            check_parameters(law, values, self.name)
        notes = []
        if blocks.assumed:
            notes.append(f"Not written, and taken as usual: {'; '.join(blocks.assumed)}.")
        still = [u.name for u in process.inputs if u.name not in wiring.outputs]
        if still:
            notes.append(f"It does not move {', '.join(still)}, which stays where it was.")
        measurements, setpoints = blocks.measurements, blocks.setpoints
        manipulated = tuple(wiring.outputs)

        def make(model: LinearModel) -> Controller:
            point = operating_point_of(model)
            at = point.as_dict()
            own = values | {parameter: at[signal] for parameter, signal in blocks.at_point.items()}
            free = blocks.fixed | {name: at[signal] for name, signal in blocks.follows.items()}
            inputs = free | {path(name, "sp"): at[name] for name in setpoints}
            inputs |= {path(name, "pv"): at[name] for name in measurements}
            inputs |= {path(name, "tracking"): at[name] for name in manipulated}
            begins, moving = first_samples(
                law,
                own,
                state_at_rest(law, own, inputs),
                inputs,
                [process.signal(name) for name in manipulated],
                process.sampling_period,
            )
            return Controller(
                name=self.name,
                family=FAMILY,
                structure=_structure(law),
                design=f"Written out, {'; '.join(blocks.words)}.",
                law=law,
                values=own,
                initial_state=begins,
                measurements=measurements,
                setpoints=setpoints,
                manipulated=manipulated,
                notes=(*notes, *moving),
                free_inputs=free,
            )

        return make


def _structure(law: StepLaw) -> Complexity:
    """Return whether a scheme is more than loops that each move an output."""
    plain = all(
        isinstance(block, OutputBlock) or (isinstance(block, PidBlock) and block.direct)
        for block in law.blocks
    )
    return Complexity.LOOPS if plain else Complexity.ADVANCED_LOOPS
