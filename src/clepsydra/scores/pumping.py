"""What pumping costs, and what is spilt: starts, volumes and energy.

A flow is held during each sample, as the signal of its pump is. The energy is what reaches the
liquid, J. F. Gülich, Centrifugal Pumps, 3rd edition, 2014, chapter 2, doi
10.1007/978-3-642-40114-5: that drawn from the mains is this over the efficiency of pump, motor and
converter.
"""

from __future__ import annotations

from clepsydra.scores.sample import Expression, Fold, Sample
from clepsydra.scores.score import Of, Score

_HOUR = 3600.0
_KILOWATT_HOUR = 3.6e6
#: Density of water [kg/m³].
WATER = 1000.0


def starts(sample: Sample) -> tuple[Expression, ...]:
    """Return whether the pump starts now, and how long it will be as it is [s].

    A start is a sample at which it runs after one at which it did not; that it runs at the
    beginning is none.
    """
    return (sample.running.now > 0.5) * (sample.running.before <= 0.5), sample.held


def energy(sample: Sample) -> Expression:
    """Return what the liquid is given in the sample that begins now, ρ g H q Δt [kWh]."""
    return WATER * sample.lift * sample.now * sample.held / _KILOWATT_HOUR


Score(
    "starts_per_hour",
    "Starts",
    "How often the pump starts to run, per hour of the run.",
    Of.PUMP,
    unit="1/h",
    integrand=starts,
    fold=Fold.SUM,
    finish=lambda number, lasted: number * _HOUR / lasted,
).registered()
Score(
    "volume_pumped",
    "Volume pumped",
    "What the pump delivers in the run.",
    Of.PUMP,
    unit="m³",
    integrand=lambda sample: sample.now * sample.held,
    fold=Fold.SUM,
).registered()
Score(
    "energy",
    "Energy to the liquid",
    "What the pump gives to the liquid, flow times head, taken as water of 1000 kg/m³; what it "
    "draws is more by the losses of pump, motor and converter.",
    Of.PUMP,
    unit="kWh",
    wants="head",
    integrand=energy,
    fold=Fold.SUM,
).registered()
Score(
    "volume_spilt",
    "Volume spilt",
    "What is lost over the rim of the tank in the run.",
    Of.TANK,
    unit="m³",
    integrand=lambda sample: sample.move,
    fold=Fold.SUM,
).registered()
