"""The step law of a Mamdani controller."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import casadi as ca

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.sample import Sample, control_law
from clepsydra.controllers.blocks.validity import all_of
from clepsydra.controllers.fuzzy.inference import rule_base
from clepsydra.controllers.fuzzy.system import FuzzySystem
from clepsydra.controllers.fuzzy.variables import FuzzyInput, FuzzyOutput
from clepsydra.program.step_law import StepLaw

FAMILY = "fuzzy"


def fuzzy_law(
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    *,
    loops: Sequence[str] = ("",),
    name: str = "fuzzy",
) -> StepLaw:
    """Write the step law of a Mamdani controller.

    A linguistic input is x = k D(q): q the error r − y, the measurement y or the derivative of
    one of them, D a dead zone, k its gain; the range of its variable clips it. With the centroid
    c of a linguistic output, in automatic::

        u = min(high limit, max(low limit, g c + b))      position
        u = min(high limit, max(low limit, u + Δt g c))      increment, u from the last sample

    and no faster than the rate limit. A position has no integral action. Its b makes a change of
    mode bumpless and fades, b⁺ = b − min(Δt/Tf, 1) b, but not further into saturation. An
    increment moves on from what was applied, in every mode, so it neither bumps nor winds up.

    Where no rule fires the output is held. A fault of a sensor, or a value that is no number,
    holds the outputs whose rules read it; the others go on.

    `inputs`: one for each input of the system, loop by loop; `outputs`: one for each output of the
    system, loop by loop; `loops`: what the linguistic variables belong to, if there are several
    loops by the same rules; `name`: an identifier.

    References
    ----------
    E. H. Mamdani, Application of fuzzy algorithms for control of simple dynamic plant,
    Proceedings of the IEE 121(12), 1974, 1585-1588, doi 10.1049/piee.1974.0328.
    """
    return _written(system, tuple(inputs), tuple(outputs), tuple(loops), name)


@lru_cache(maxsize=16)
def _written(
    system: FuzzySystem,
    inputs: tuple[FuzzyInput, ...],
    outputs: tuple[FuzzyOutput, ...],
    loops: tuple[str, ...],
    name: str,
) -> StepLaw:
    """Return the law; whoever runs a file at several sampling periods asks for it each time."""
    moved = [each.moved for each in outputs]
    measured = {each.measurement.name: each.measurement for each in inputs}
    followed = {each.measurement.name for each in inputs if each.is_of_error}
    owned = [path(loop, v.name) if loop else v.name for loop in loops for v in system.inputs]
    read = list(zip(owned, inputs, strict=True))
    rules = rule_base(system, f"{name}_rules")

    def equations(sample: Sample) -> None:
        following_inputs, following_outputs = iter(read), iter(outputs)
        for loop in loops:
            crisp, sensors = dict[str, dict[str, ca.SX]](), dict[str, ca.SX]()
            for variable, (own, each) in zip(system.inputs, following_inputs, strict=False):
                crisp[variable.name] = each.read(sample, own)
                sensors[variable.name] = sample[path(each.measurement, "good")]
            scaled = {variable: found["scaled"] for variable, found in crisp.items()}
            # Not by the sample: the degrees of sets and rules are no names of the law.
            inferred = rules(path(loop, "rules") if loop else "rules", scaled, {}).outputs
            for variable, output in zip(system.outputs, following_outputs, strict=False):
                used = [each.name for each in system.used_by(variable.name)]
                output.move(
                    sample,
                    centroid=inferred[path(variable.name, "centroid")],
                    fires=inferred[path(variable.name, "fires")],
                    numbers=all_of([crisp[each]["numbers"] for each in used]),
                    sensors=all_of([sensors[each] for each in used]),
                )

    return control_law(
        name,
        equations,
        measured=list(measured.values()),
        controlled=[signal for name, signal in measured.items() if name in followed],
        manipulated=moved,
        description=tuple(f"{rule.name}: {rule}" for rule in system.rules),
    )
