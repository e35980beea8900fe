"""A controller as a model for co-simulation: one scan at the start of each sampling period."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.deploy.fmi.model import FmuModel, FmuVariable, output_dependencies, variables_of
from clepsydra.deploy.fmi.model_header import call_step
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.inlined import inlined
from clepsydra.program.owned_state import state_names, state_paths, with_owned_state
from clepsydra.program.program import Program


def controller_model(program: Program, origin: Origin) -> FmuModel:
    """Return the model of a controller that is sampled.

    In a communication step from t to t + h the scans that fall due from t on and before t + h
    run with the inputs as they were set, and the outputs hold until the next scan: with the
    sampling period as communication step there is one scan in each, at its start. Before the
    first step the outputs are those of a scan that leaves the state as it is. Inputs start as in
    every other export: behind a plant shell in manual, without a sensor and without a time step,
    until the importer sets them. A state that lives in an instance of a block has the name of that
    instance before its own.

    Parameters
    ----------
    program : Program
        Of the controller, with its numbers: ``controller.program()``.
    origin : Origin
        With the sampling period.

    Raises
    ------
    InputError
        Two variables have one name.

    Examples
    --------
    >>> import clepsydra as cl
    >>> program = cl.design.simc(cl.load("quadruple-tank")).program()
    >>> model = controller_model(program, Origin("PI", "quadruple-tank", "SIMC", 1.0))
    >>> model.variables[0].name, model.outputs[0].name, model.reference("time_step")
    ('level_1.proportional_gain', 'pump_1.out', 25)
    """
    paths, named = state_paths(with_owned_state(program)), state_names(program)
    states = [
        FmuVariable(
            replace(signal_of(entry), name=named[entry.name]),
            f"state.{'.'.join(path)}", "local", "discrete",
        )
        for entry, path in zip(program.state, paths, strict=True)
        if not is_ring(entry)
    ]  # fmt: skip
    rings = {entry.name for entry in program.state if is_ring(entry)}
    depends_on = [
        tuple(named.get(name, name) for name in names if name not in rings)
        for names in output_dependencies(inlined(program))
    ]
    words = "The outputs that a scan with the present inputs would give; the state stays."
    show = call_step("model_show", words, program, keeps_state=True)
    return FmuModel(
        programs=(program,),
        variables=(
            *variables_of(program.parameters, "parameters", "parameter", "tunable"),
            *variables_of(program.inputs, "inputs", "input", "discrete"),
            *states,
            *variables_of(program.outputs, "outputs", "output", "discrete", depends_on),
        ),
        functions="\n".join([show, call_step("model_advance", "One scan.", program)]),
        step=origin.sampling_period,
        scans=True,
        title=f"{origin.subject} for {origin.process}",
        origin=origin,
    )
