"""`cl.analyse`, `cl.zeros`, `cl.poles`, `cl.relative_gains`, `cl.margins`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.plant import Plant
from clepsydra.interface.subject import StudyRequest, Subject, plant_of
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.relative_gain_array import relative_gain_response
from clepsydra.linear.relative_gain_array import relative_gains as relative_gains_of
from clepsydra.linear.roots import roots_of
from clepsydra.report.analysis_tables import margin_table
from clepsydra.studies.warnings.loop_response import loop_response

if TYPE_CHECKING:
    import control
    import pandas

    from clepsydra.interface.analysis import Analysis


def analyse(plant: Subject) -> Analysis:
    """Say what the linear model of a plant means for its control.

    Parameters
    ----------
    plant : Plant, str or Path

    Returns
    -------
    Analysis
        Poles, zeros, static gain, relative gains, pairing and `words`; printed, what matters most.

    Raises
    ------
    NoEquilibrium
        There is no operating point as asked.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analyse(cl.load("quadruple-tank")).pairing[0]
    ('level_1', 'pump_1')
    """
    return plant_of(plant).analysis


def zeros(system: Subject | LinearModel | control.StateSpace) -> np.ndarray:
    """Return the transmission zeros [rad/s], rightmost first.

    Parameters
    ----------
    system : Plant, str, Path, LinearModel or control.StateSpace
        Of a plant from its inputs to its controlled measurements. Every input of a state space of
        python-control counts; `LinearModel.from_control(system, ["inflow"])` tells apart those
        that are disturbances.

    Examples
    --------
    >>> import clepsydra as cl
    >>> zeros(cl.load("quadruple-tank-nonminimum-phase")).round(2)
    array([ 0.01+0.j, -0.06+0.j])
    """
    return roots_of(_linear(system)).zeros


def poles(system: Subject | LinearModel | control.StateSpace) -> np.ndarray:
    """Return the poles [rad/s], rightmost first; see `zeros`."""
    return roots_of(_linear(system)).poles


def relative_gains(
    system: Subject | LinearModel | control.StateSpace, frequency: float = 0.0
) -> pandas.DataFrame:
    """Return the relative gain array, a row for each output and a column for each input.

    Parameters
    ----------
    system : Plant, str, Path, LinearModel or control.StateSpace
    frequency : float
        That of the response there, complex [rad/s]; at rest if left out.

    Examples
    --------
    >>> import clepsydra as cl
    >>> print(relative_gains(cl.load("quadruple-tank")).round(2))
             pump_1  pump_2
    level_1     1.4    -0.4
    level_2    -0.4     1.4
    """
    import pandas

    model = _linear(system)
    found = relative_gain_response(model, frequency)[0] if frequency else relative_gains_of(model)
    return pandas.DataFrame(found, index=list(model.outputs), columns=list(model.inputs))


def margins(controller: AnyController, plant: Subject) -> pandas.DataFrame:
    """Return gain, phase and delay margin and max|S| of each loop, the others closed.

    They are those of the sampled loop, exact, broken at each measurement and at each input.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> margins(cl.design.simc(plant), plant).loc["level_1", "phase margin [deg]"].round(1)
    np.float64(79.2)
    """
    import pandas

    plant = plant_of(plant)
    found = margin_table(loop_response(of_plant(controller, plant), plant.measured))
    return pandas.DataFrame.from_dict(found, orient="index")


def _linear(system: object) -> LinearModel:
    if isinstance(system, (Plant, StudyRequest, str, Path)):
        return plant_of(system).linear
    if isinstance(system, LinearModel):
        return system
    return LinearModel.from_control(system)
