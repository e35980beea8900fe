# Written by .ci/design_stub.py from the designs themselves.

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.decoupling import Decoupling
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.designs.loop_shaping.precompensator import Precompensator
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.operating_plan import Follows
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.regulator import ActsOn, RegulatorAntiWindup
from clepsydra.designs.smith_predictor import Primary
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.designs.virtual_settings import VirtualSettings
from clepsydra.designs.ziegler_nichols import Experiment
from clepsydra.interface.controller import Controller
from clepsydra.interface.quantities import Quantity
from clepsydra.interface.subject import Subject
from clepsydra.program.step_law import StepLaw

def amigo(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    as_published: bool = ...,
) -> Controller:
    """Design a PI or PID controller for each pair by AMIGO."""

def arrest_time(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    arrest_time: Quantity | None = ...,
    deviation: Quantity | None = ...,
    damping: Quantity = ...,
) -> Controller:
    """Design PI controllers that let levels move, so that the flows behind them hardly do."""

def disturbance_rejection(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    closed_loop_time_constant: Quantity | None = ...,
    observer_ratio: Quantity = ...,
) -> Controller:
    """Design a loop of active disturbance rejection for each pair."""

def feedback_linearisation(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    closed_loop_time_constant: Quantity | None = ...,
    settings: Sequence[VirtualSettings] | None = ...,
    anti_windup: VirtualAntiWindup = ...,
    alpha: Quantity | Sequence[Quantity] | None = ...,
    alpha_on: AlphaOn = ...,
    despite_unstable_internal_dynamics: bool = ...,
) -> Controller:
    """Design feedback linearisation of a process, with a PI controller for each output."""

def fuzzy(
    plant: Subject,
    path: str | Path,
    *,
    name: str = ...,
) -> Controller:
    """Return the controller of a fuzzy file, which docs/fuzzy-files.md describes."""

def fuzzy_pi(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    largest_error: Quantity = ...,
    closed_loop_time_constant: Quantity | None = ...,
) -> Controller:
    """Design an incremental fuzzy PI controller for each pair, from SIMC's linear one."""

def gain_scheduled_lqi(
    plant: Subject,
    *,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    anti_windup: AntiWindup = ...,
    over: str | None = ...,
    follows: Follows = ...,
    points: Sequence[Quantity] | None = ...,
) -> Controller:
    """Design LQI by Bryson's rule at several operating points, and schedule the gains."""

def gain_scheduled_pid(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    over: str | None = ...,
    follows: Follows = ...,
    points: Sequence[Quantity] | None = ...,
) -> Controller:
    """Design PI or PID controllers by SIMC at several operating points, and schedule them."""

def glover_mcfarlane(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    precompensator: Controller | Precompensator | None = ...,
    relaxation: Quantity = ...,
    order: int | None = ...,
) -> Controller:
    """Design the most robust controller of a loop that a pre-compensator has shaped."""

def inverse(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    observer_time: Quantity | None = ...,
) -> Controller:
    """Design the one-step inverse of a process, with an observer of what its model lacks."""

def lambda_(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    closed_loop_time_constant: Quantity | None = ...,
) -> Controller:
    """Design a PI controller for each pair by lambda tuning."""

def lqi(
    plant: Subject,
    *,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    anti_windup: AntiWindup = ...,
) -> Controller:
    """Design LQI control with weights by Bryson's rule."""

def lqi_by_weights(
    plant: Subject,
    weights: Mapping[str, Mapping[str, float]] | QuadraticWeights,
    *,
    anti_windup: AntiWindup = ...,
) -> Controller:
    """Design LQI control with given weights."""

def lqi_extended_kalman(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    anti_windup: AntiWindup = ...,
) -> Controller:
    """Design LQI control of states that an extended Kalman filter estimates."""

def lqi_kalman(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    anti_windup: AntiWindup = ...,
) -> Controller:
    """Design LQI control of states that a Kalman filter estimates."""

def lqr(
    plant: Subject,
    *,
    weights: Mapping[str, Mapping[str, float]] | QuadraticWeights | None = ...,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
) -> Controller:
    """Design a linear-quadratic regulator with a precompensator for the setpoints."""

def mpc(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    horizon: Quantity | None = ...,
    moves: int | None = ...,
) -> Controller:
    """Design model predictive control with a linear model."""

def nonlinear_mpc(
    plant: Subject,
    *,
    horizon: Quantity | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    move_weight: Quantity = ...,
) -> Controller:
    """Design nonlinear model predictive control: in every sample it looks for the best inputs."""

def own(
    plant: Subject,
    law: StepLaw,
    *,
    measurements: Sequence[str],
    setpoints: Sequence[str],
    manipulated: Sequence[str],
    values: Mapping[str, float] | None = ...,
    initial_state: Mapping[str, float] | None = ...,
    free_inputs: Mapping[str, float] | None = ...,
    name: str = ...,
) -> Controller:
    """Return a controller with an own law, whose outputs start at the operating point."""

def phase_margin(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    phase_margin: Quantity = ...,
    crossover: Quantity | None = ...,
) -> Controller:
    """Design a PI or PID controller for each pair from its phase margin."""

def pole_placement(
    plant: Subject,
    *,
    poles: Sequence[complex] | None = ...,
    bandwidth: Quantity | None = ...,
    observer_poles: Sequence[complex] | None = ...,
    measurements: Sequence[str] | None = ...,
) -> Controller:
    """Design state feedback with a precompensator by placing the poles of the sampled loop."""

def polynomial(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    penalty: Quantity | None = ...,
    assigned_poles: Sequence[float] | None = ...,
    models: Sequence[SampledModel] | None = ...,
) -> Controller:
    """Design a polynomial controller of two degrees of freedom for each pair."""

def recomputed_lqi(
    plant: Subject,
    *,
    measurements: Sequence[str] | None = ...,
    maximum_errors: Mapping[str, Quantity] | None = ...,
    maximum_moves: Mapping[str, Quantity] | None = ...,
    anti_windup: AntiWindup = ...,
    steps: int = ...,
) -> Controller:
    """Design LQI control whose gains follow the operating point without a table."""

def regulator(
    plant: Subject,
    regulator: Any,
    *,
    sampling_period: Quantity | None = ...,
    measurements: Sequence[str] | None = ...,
    manipulated: Sequence[str] | None = ...,
    units: Mapping[str, str] | None = ...,
    acts_on: ActsOn = ...,
    anti_windup: RegulatorAntiWindup = ...,
    name: str = ...,
) -> Controller:
    """Return a controller with the matrices of a regulator, at rest at the operating point."""

def simc(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    closed_loop_time_constant: Quantity | None = ...,
    decoupling: Decoupling | None = ...,
) -> Controller:
    """Design a PI or PID controller for each pair by SIMC."""

def smith_predictor(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    primary: Primary = ...,
    penalty: Quantity | None = ...,
    assigned_poles: Sequence[float] | None = ...,
    closed_loop_time_constant: Quantity | None = ...,
    models: Sequence[SampledModel] | None = ...,
) -> Controller:
    """Design a digital Smith predictor for each pair."""

def start_stop_levels(
    plant: Subject,
    *,
    starts_per_hour: Quantity = ...,
) -> Controller:
    """Return levels at which pumps start and stop, with duty and standby."""

def tyreus_luyben(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    as_published: bool = ...,
) -> Controller:
    """Design a PI or PID controller for each pair by the rules of Tyreus and Luyben."""

def variable_structure_pid(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    settings: Sequence[PidSettings] | None = ...,
    alpha: Quantity | Sequence[Quantity] | None = ...,
) -> Controller:
    """Design variable-structure PI or PID control for each pair."""

def ziegler_nichols(
    plant: Subject,
    pairing: Pairing | None = ...,
    *,
    form: PidForm | None = ...,
    experiment: Experiment = ...,
    as_published: bool = ...,
) -> Controller:
    """Design a PI or PID controller for each pair by the rules of Ziegler and Nichols."""
