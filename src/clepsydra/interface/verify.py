"""`cl.verify`: the proof that what is exported runs what was simulated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_type
from clepsydra.base.keywords import keywords_checked
from clepsydra.deploy.exported_alarms import alarm_items
from clepsydra.deploy.proof import row as inner_proof
from clepsydra.deploy.proof.item import controller_item, process_item_of
from clepsydra.deploy.proof.proof import ProofProgress, prove
from clepsydra.deploy.proof.scans import FEWEST
from clepsydra.deploy.proof.targets import proved_targets as proved_targets
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.scenario import scenario_of
from clepsydra.interface.shell import Settings, plant_shell
from clepsydra.interface.shown import Answered, lifted, screen
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.loop.scenario import Scenario

if TYPE_CHECKING:
    from rich.console import RenderableType

    from clepsydra.base.section import Section


class Proof(Answered, inner_proof.Proof):
    """Each target compared with the simulation: `holds`, `rows`, `failures`, `refusals`."""

    def answer(self, *, every: bool = False) -> Section:
        """Return a line for each controller and process, and on request every target."""
        from clepsydra.deploy.proof.answer import proof_answer

        return proof_answer(self, every=every)


def so_far(progress: ProofProgress) -> RenderableType:
    """Return what is proved so far, for a terminal.

    Examples
    --------
    >>> so_far(ProofProgress(0, 15, "PI, SIMC: C")).section.parts
    ()
    """
    from clepsydra.deploy.proof.answer import proved_so_far

    return screen(proved_so_far(progress.rows))


@keywords_checked()
def verify(
    controllers: AnyController | Sequence[AnyController],
    plant: Subject,
    *,
    to: str | Sequence[str] | None = None,
    scans: int = FEWEST,
    seed: int = 1,
    fail_safe: Settings = None,
    sensor_delay: Settings = None,
    setpoint_rate: Settings = None,
    rate_limit: Settings = None,
    scenario: Scenario | None = None,
    folder: str | Path | None = None,
    stem: str | None = None,
    progress: Callable[[ProofProgress], None] | None = None,
) -> Proof:
    """Run controllers and process on every target that runs; compare with the simulation.

    Parameters
    ----------
    controllers : Controller or sequence of Controller
    plant : Plant, str or Path
    to : str or sequence of str, optional
        What is run, each in all that it has: dialects, versions, precisions; all if left out.
    scans : int
        Random scans of each, at least 10,000.
    seed : int
        Of the scans.
    fail_safe, sensor_delay, setpoint_rate, rate_limit : mapping, optional
        As in `cl.export`.
    scenario : Scenario, optional
        What the loop goes through where single precision is judged by its scores; the default
        scenario if left out.
    folder : str or Path, optional
        Where the proof is written as JSON and Markdown, row by row, so that a second call goes on.
    stem : str, optional
        Of the names of these files; that of the process if left out.
    progress : callable, optional
        Takes how far the proof is, before each row.

    Returns
    -------
    Proof

    Raises
    ------
    InputError
        What is given is no controller or no plant, there is no compiler or no such export, a
        package of the extra "verify" is missing, or there are too few scans.

    Examples
    --------
    See docs/plc.md.
    """
    plant = plant_of(plant)
    given: Any = controllers
    several = isinstance(given, Iterable) and not isinstance(given, str)
    shell = plant_shell(
        plant,
        fail_safe=fail_safe,
        sensor_delay=sensor_delay,
        setpoint_rate=setpoint_rate,
        rate_limit=rate_limit,
    )
    scenario = scenario_of(plant) if scenario is None else scenario
    require_type(scenario, Scenario, "scenario", "a Scenario", "give one, as that of a study")
    chosen = proved_targets(to)
    part = "" if chosen == proved_targets(None) else f"-{'-'.join(chosen)}"
    items = [
        controller_item(of_plant(each, plant), plant.point, scenario, shell)
        for each in (given if several else [given])
    ]
    found = prove(
        [*items, *alarm_items(plant.point), process_item_of(plant.point)],
        scans=scans,
        seed=seed,
        to=chosen,
        progress=progress,
        folder=None if folder is None else Path(folder),
        stem=f"{stem or plant.file_stem}-proof{part}",
    )
    return lifted(Proof, found)
