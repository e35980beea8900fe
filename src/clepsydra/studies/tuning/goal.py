"""What candidates of a tuning are judged by: scenarios, an objective, and limits to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.objective import Limits, Objective


@dataclass(frozen=True, eq=False)
class Goal:
    """What is simulated of each candidate, what is to be small in it, and what must hold.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point where the scenarios begin, with every measurement
        that the controller reads.
    scenario : Scenario or sequence of Scenario
        Over several the scores add up, the overshoot is the largest.
    objective : Objective
        `objective.minimax` or `objective.weighted_sum`.
    limits : Limits
        A tank that runs empty or over, a pump that runs dry and a trip are never let pass, unless
        they happen at the start as well, nor under load steps a level that leaves its band.

    Raises
    ------
    InputError
        One of them is something else.
    """

    model: LinearModel
    scenario: Scenario | Sequence[Scenario]
    objective: Objective
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        model_remedy = "take that of an analysis, or make it with linearise"
        require_type(self.model, LinearModel, "model", "a LinearModel", model_remedy)
        sequence_of(
            self.scenarios, Scenario, "tuning, scenario", "a Scenario, or a list of them",
            "make one, as by default_scenario(model)",
        )  # fmt: skip
        require_type(
            self.objective, Objective, "tuning, objective", "an Objective",
            'make one, as by minimax("iae[level]") or weighted_sum({"iae[level]": 1.0})',
        )  # fmt: skip
        require_type(
            self.limits, Limits, "tuning, limits", "Limits",
            "write as in Limits(maximum_sensitivity=2.0)",
        )  # fmt: skip

    @property
    def scenarios(self) -> Sequence[Scenario]:
        """The scenarios, one or several."""
        return [self.scenario] if isinstance(self.scenario, Scenario) else self.scenario
