"""``python -m benchmarks.ratios``: what a thing costs beside what it belongs to.

A ratio within one round says the same on a busy machine as on an idle one, as no number of seconds
does.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable
from dataclasses import dataclass

import clepsydra as cl
from benchmarks.experiments import FULL, QUICK
from benchmarks.measure import Spread, Way, interleave
from benchmarks.pumped_valves import ALONE, BEFORE_A_VALVE, batch
from clepsydra.base.errors import InputError
from clepsydra.base.units import to_si
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.profile import Change, profiles_of
from clepsydra.studies.trial import scores_of
from clepsydra.studies.warnings.before import warnings_before

#: Brackets that nothing closes, and more than any unit has.
_HOSTILE = "5 " + "(" * 1_000_000


@dataclass(frozen=True)
class Ratio:
    """What one call costs over another.

    Parameters
    ----------
    name, beside : str
        What is judged, and what it is divided by.
    wanted : float
        The largest ratio at which nobody has to look for the reason.
    seen : Spread
    """

    name: str
    beside: str
    wanted: float
    seen: Spread

    def row(self) -> str:
        """Return a line of a table."""
        met = "yes" if self.seen.median <= self.wanted else "no"
        return (
            f"| {self.name} | {self.beside} | {self.wanted:g} "
            f"| {self.seen.median:.3g} [{self.seen.low:.3g}, {self.seen.high:.3g}] | {met} |"
        )


def measure(rounds: int) -> list[Ratio]:
    """Measure every ratio."""
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    run, model = cl.simulate(plant, controller), plant.linear
    scenario = default_scenario(model)
    alone = batch(ALONE)
    changes = [Change("pump_1", float(k % 3), float(k), float(k)) for k in range(100_000)]
    return [
        _ratio(
            ("the scores of a run", lambda: scores_of(run)),
            ("design and simulation", lambda: cl.simulate(plant, cl.design.simc(plant))),
            1.0,
            rounds,
        ),
        _ratio(
            ("all warnings before a run", lambda: warnings_before(model, controller, scenario)),
            ("design and simulation", lambda: cl.simulate(plant, cl.design.simc(plant))),
            1.0,
            rounds,
        ),
        _ratio(
            ("100,000 changes of an input", lambda: _written(changes)),
            ("10,000 of them", lambda: _written(changes[:10_000])),
            30.0,  # 10 in proportion, about 100 were each change written to the end
            rounds,
        ),
        _ratio(
            ("a million brackets for a unit", lambda: _read(_HOSTILE)),
            ("a hundred quantities", lambda: [_read("5 cm^2/min") for _ in range(100)]),
            10.0,
            rounds,
        ),
        *(
            _ratio((f"a batch of {name}", batch(inlet)), ("of a pump alone", alone), 1.5, rounds)
            for name, inlet in BEFORE_A_VALVE.items()
        ),
    ]


def _ratio(
    judged: tuple[str, Callable[[], object]],
    beside: tuple[str, Callable[[], object]],
    wanted: float,
    rounds: int,
) -> Ratio:
    timings = interleave([Way(*judged), Way(*beside)], rounds)
    return Ratio(judged[0], beside[0], wanted, timings.ratio(judged[0], beside[0]))


def _written(changes: list[Change]) -> None:
    profiles_of(changes, {"pump_1": 3.0}, 1.0, len(changes))


def _read(text: str) -> None:
    with contextlib.suppress(InputError):
        to_si(text, "m^2/s", "here")


def main() -> int:
    """Print the ratios; the exit status is 1 where one is above what is wanted."""
    found = measure((QUICK if "--quick" in sys.argv[1:] else FULL).rounds)
    print("| what | beside | wanted, at most | measured | met |", "|---|---|---|---|---|", sep="\n")
    print("\n".join(each.row() for each in found))
    return int(any(each.seen.median > each.wanted for each in found))


if __name__ == "__main__":
    sys.exit(main())
