"""Variable-structure PI and PID: any PID settings, and a rate that keeps them from winding up."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

from clepsydra.base.arguments import sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.variable_structure_pid import (
    family,
    variable_structure_form,
    variable_structure_pid_law,
)
from clepsydra.designs.arguments.numbers import ALPHA
from clepsydra.designs.design import Studied, design
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.loops.multiloop import MultiloopPid, checked_form
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.sampled.setpoint_response import settling_times
from clepsydra.designs.saturation_rate import rates_in_words, saturation_rates
from clepsydra.designs.simc import design_simc
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

METHOD = "variable-structure PID"


@design(
    "variable_structure_pid",
    "PI or PID with variable structure",
    Studied(100, "PI, variable structure"),
    keys=(ALPHA,),
    method=METHOD,
)
def design_variable_structure_pid(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    settings: Sequence[PidSettings] | None = None,
    alpha: float | Sequence[float] | None = None,
) -> Controller:
    """Design variable-structure PI or PID control for each pair.

    The settings are those of SIMC, or the user's. α follows from the loops as designed: while
    an integral saturates it settles three times faster than its loop, and no α is taken that
    would settle less than two or more than five times faster (`designs.saturation_rate`).

    Parameters
    ----------
    form : PidForm, optional
        PI in ISA form if left out; its anti-windup does not count.
    settings : sequence of PidSettings, optional
        One for each pair; by SIMC if left out.
    alpha : float or sequence of float, optional
        α of all loops or of each [1/s].

    Raises
    ------
    NotApplicable
        SIMC has no settings, the loops are unstable together or do not settle.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form has
        no integral, the settings are not one for each pair or have an integral gain that is not
        above zero in the direction of its pair, or α is outside of its rule.

    References
    ----------
    A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent integrator windup,
    IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451, doi 10.1109/41.915424.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> controller = design_variable_structure_pid(analysis.model, analysis.pairing)
    >>> controller.name, round(controller.values["level_1.saturation_rate"], 3)
    ('PI, variable structure', 0.245)
    """
    chosen, _ = checked_form(form)
    plain = PidForm(**vars(variable_structure_form(chosen)))
    if settings is None:
        base = design_simc(model, pairing, form=plain)
    else:
        base = _as_given(model, pairing, plain, settings)
    settling = settling_times(base, model)
    rates = saturation_rates(settling, base.setpoints, alpha)
    found = with_variable_structure(base, plain, rates, model)
    words = rates_in_words(rates, settling, base.setpoints)
    return dataclasses.replace(found, design=f"{base.design} α {words}.")


def with_variable_structure(
    base: Controller, form: PidForm, rates: Sequence[float], model: LinearModel
) -> Controller:
    """Return a multiloop PID controller with the variable structure, α not judged by any rule.

    Parameters
    ----------
    base : Controller
        Multiloop PID without anti-windup.
    form : PidForm
        Its form.
    rates : sequence of float
        α of each loop [1/s].

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> form = PidForm(anti_windup="none")
    >>> base = design_simc(analysis.model, analysis.pairing, form=form)
    >>> with_variable_structure(base, form, [0.1, 0.1], analysis.model).family
    'variable-structure PI'
    """
    process = operating_point_of(model).process
    law = variable_structure_pid_law(
        [process.signal(name) for name in base.measurements],
        [process.signal(name) for name in base.manipulated],
        form,
    )
    values = base.values | {
        path(measured, "saturation_rate"): float(rate)
        for measured, rate in zip(base.measurements, rates, strict=True)
    }
    values = designed_values(law, values, operating_point_of(model))
    return dataclasses.replace(
        base,
        name=f"{form.actions}, variable structure",
        family=family(form),
        structure=Complexity.ADVANCED_LOOPS,
        law=law,
        values=values,
    )


def _as_given(
    model: LinearModel, pairing: Pairing | None, form: PidForm, settings: Sequence[PidSettings]
) -> Controller:
    together = MultiloopPid(model, pairing, form, METHOD)
    example = "write as in [PidSettings(3.0, 30.0)]"
    settings = sequence_of(settings, PidSettings, "settings", "a list of PidSettings", example)
    count = len(together.loops)
    if len(settings) != count:
        raise InputError("settings", len(settings), f"{count} settings", "give one for each pair")
    for loop, setting in zip(together.loops, settings, strict=True):
        integral_gain = setting.gain / (setting.integral_time or math.nan)
        sign = loop.element.sign
        if not integral_gain * sign > 0.0:
            expected = (
                f"a number {'above' if sign > 0.0 else 'below'} zero, the direction in which "
                f"{loop.input.name} moves {loop.output.name}"
            )
            place = f"integral gain K/Ti of {loop.pair}"
            raise InputError(place, integral_gain, expected, "give K that sign and a finite Ti")
    found = together.as_given(settings, "these settings")
    return together.controller(found, "Settings as given", ())
