"""LQI with a Kalman filter: for states that no sensor shows, and for dead time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.design import Studied, design
from clepsydra.designs.kalman import kalman_gain, process_noise
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.linear_quadratic import ANTI_WINDUP
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.robust_lqi import StateLqi, check_lqi
from clepsydra.linear.linear_model import LinearModel

NAME = "LQI with Kalman filter"


@design(
    "lqi_kalman",
    "LQI with a Kalman filter",
    Studied(170, "LQI with Kalman filter"),
    keys=(MEASUREMENTS, *DEVIATIONS, ANTI_WINDUP),
)
def design_lqi_kalman(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control of states that a Kalman filter estimates.

    The regulator is that of `designs.lqi.design_lqi`, the filter follows from the noise of
    `designs.kalman.process_noise`. The filter estimates the states only: under a constant load
    its estimate has a bias, which the integrators take up, since they integrate the measured
    errors. A load estimated in addition would be a second integrator for the same purpose.
    With dead time what is on its way is estimated too, so that the law predicts what a change
    will do before it shows.

    With an observer the margins of the regulator are lost (Doyle 1978), so that the regulator
    is slowed down by one factor until the sensitivity peak of the whole sampled loop is 2.

    Parameters
    ----------
    measurements : sequence of str, optional
        What the filter reads, with the controlled outputs among them; default the controlled
        outputs alone where sensors show every state, else all sensors of use
        (`designs.states.observed_process`).
    maximum_errors, maximum_moves, anti_windup
        As for `designs.lqi.design_lqi`.

    Raises
    ------
    NotApplicable
        The measurements do not show what has to be known, too much would have to be estimated,
        there are no stabilising gains, or no slowing down makes the loop robust.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, or
        the anti-windup is unknown.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 11.

    Examples
    --------
    The last of eight tanks is measured and seven are estimated:

    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> controller = design_lqi_kalman(model, measurements=["level_3"])
    >>> states = [name for name in controller.initial_state if name.endswith(".estimate")]
    >>> controller.measurements, len(states)
    (('level_3',), 3)
    """
    check_lqi(model)
    observed = observed_process(model, measurements)
    seen = observed.model
    deviations = acceptable_deviations(seen, maximum_errors, maximum_moves)
    noise = process_noise(observed, deviations.horizon)
    estimation = Estimation.of(observed, kalman_gain(observed.held, observed.shown, noise).gain)
    lqi = StateLqi(NAME, seen, deviations, observed.measurements, anti_windup, estimation)
    found = lqi.robust(model)
    how = f"; Kalman filter for {estimation.names}, {noise.words}"
    return lqi.described(found, found.design.controller, how, of_filter=True)
