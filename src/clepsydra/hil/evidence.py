"""All that a run of a soft PLC on wires shows of it, in one place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.proof.comparison import Difference, double_bound, is_exact, verdict
from clepsydra.deploy.proof.interpreted_text import SINGLE_LIBRARY_BOUND
from clepsydra.hil.ideal import Deviation, as_operated, deviations, ideal_run
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.replay import replay_law, replay_plant
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.scanner import Wiring
from clepsydra.hil.wire_check import WireCheck, check_wires
from clepsydra.hil.wires import Wires
from clepsydra.program.precision import Precision
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.tag import Tag

#: Share of a sampling period by which a scan is off before its status says so.
_OFF = 0.1


@dataclass(frozen=True)
class Evidence:
    """What a run of a soft PLC on wires shows.

    Parameters
    ----------
    law : Difference
        Of the outputs of the PLC from those of the simulated law on what it read.
    bound : float
        How large that may be: 0, but for laws with functions such as exp.
    plant : Difference
        Of what the plant showed from the simulated process with what it applied.
    wires : WireCheck
    deviations : tuple of Deviation
        Of the loop from its simulation.
    steps : tuple of float
        Of the wires, for each deviation, in its unit.
    scans : int
    off : int
        Scans whose time step was off by more than a tenth of the sampling period.
    left_out : int
        Scans that were left out since the one before took too long.
    unseen : int
        Samples of the plant that no scan has read.
    lost : (int, int)
        Scans whose inputs, and whose outputs, did not get through.
    lateness, took : (float, float, float)
        Behind the deadlines, and of a scan: median, 99th percentile and largest [s].
    """

    law: Difference
    bound: float
    plant: Difference
    wires: WireCheck
    deviations: tuple[Deviation, ...]
    steps: tuple[float, ...]
    scans: int
    off: int
    left_out: int
    unseen: int
    lost: tuple[int, int]
    lateness: tuple[float, float, float]
    took: tuple[float, float, float]

    @property
    def is_law(self) -> bool:
        """Whether the PLC put out what the simulated law does."""
        return verdict(self.law, self.bound) in ("equal", "within the bound")

    @property
    def is_plant(self) -> bool:
        """Whether the rig showed what the simulated process does, in every bit."""
        return self.plant.differing == 0

    @property
    def is_carried(self) -> bool:
        """Whether the wires made of every value what they have to."""
        return self.wires.misread == self.wires.foreign == 0

    @property
    def holds(self) -> bool:
        """Whether law, process and wires are what was simulated, whatever real time did."""
        return self.is_law and self.is_plant and self.is_carried


def evidence_of(
    ready: Exportable,
    precision: Precision,
    settings: PlantSettings,
    log: ScanLog,
    wiring: Wiring,
    rows: PlantRows,
    tags: Sequence[Tag],
    wires: Wires,
    until: int | None = None,
) -> Evidence:
    """Compute a run of a soft PLC again, and compare it with the simulation of its loop.

    Parameters
    ----------
    ready : Exportable
    precision : {"double", "single"}
        Of the PLC's program.
    settings : PlantSettings
        Of the plant.
    log : ScanLog
    wiring : Wiring
    rows : PlantRows
        From the plant's first sample on.
    tags : sequence of Tag
    wires : Wires
    until : int, optional
        The sample before which the loop is compared with its simulation, which knows nothing of
        scans that were stopped or left out; all samples if left out.
    """
    program, period = ready.program, ready.process.sampling_period
    exact = 0.0 if is_exact(program) else SINGLE_LIBRARY_BOUND
    given = as_operated(settings, ready, log, wiring, rows, tags)
    ideal = ideal_run(settings, ready, rows.last + 1, given)
    away = deviations(ideal, rows, tags, until)
    steps = log.given()["time_step"]
    return Evidence(
        law=replay_law(program, log, precision),
        bound=exact if precision == "single" else double_bound(program),
        plant=replay_plant(settings, rows),
        wires=check_wires(settings, log, wiring, rows, tags, wires.through),
        deviations=away,
        steps=tuple(wires.step(each.tag) for each in away),
        scans=len(log),
        off=int((np.abs(steps - period) > _OFF * period).sum()),
        left_out=log.left_out,
        unseen=log.unseen,
        lost=log.lost,
        lateness=_spread(log.column("lateness")),
        took=_spread(log.column("took")),
    )


def _spread(times: np.ndarray) -> tuple[float, float, float]:
    median, late, largest = np.percentile(times, [50.0, 99.0, 100.0]).tolist()
    return median, late, largest
