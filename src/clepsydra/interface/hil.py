"""`cl.run_hil`: hardware in the loop, an exported controller in a PLC on the wires of its plant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.hil.hardware_in_the_loop import PLCS, WIRES, Asked, hardware_in_the_loop
from clepsydra.interface.controller import AnyController
from clepsydra.interface.first_design import first_design
from clepsydra.interface.lab import rig_of
from clepsydra.interface.rig import check_speed
from clepsydra.interface.rig_doors import Doors
from clepsydra.interface.shown import Answered
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.rig.doors.packages import require_packages

if TYPE_CHECKING:
    from clepsydra.base.section import Section
    from clepsydra.hil.hardware_in_the_loop import HardwareInTheLoop as Found

#: With which package a controller reads and writes by them.
_CLIENTS = {"modbus": "pymodbus", "opc-ua": "asyncua"}


class HardwareInTheLoop(Answered):
    """What hardware in the loop has shown.

    Parameters
    ----------
    found : clepsydra.hil.hardware_in_the_loop.HardwareInTheLoop
    """

    def __init__(self, found: Found) -> None:
        self.found = found

    @property
    def holds(self) -> bool:
        """Whether all that was tried holds."""
        return self.found.holds

    def answer(self, *, every: bool = False) -> Section:
        """Return what holds and what does not, or every case in words."""
        from clepsydra.hil.answer import hil_answer

        return hil_answer(self.found, every=every)

    def as_dict(self) -> dict[str, Any]:
        """Return all of it as values for JSON."""
        from clepsydra.hil.answer import hil_data

        return hil_data(self.found)


@keywords_checked()
def run_hil(
    plant: Subject,
    controller: AnyController | None = None,
    *,
    plcs: Sequence[str] = tuple(PLCS),
    wires: Sequence[str] = WIRES,
    precision: str = "double",
    encoding: str = "counts-27648",
    speed: float | None = None,
    folder: str | Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> HardwareInTheLoop:
    """Run an exported controller in soft PLCs on the wires of its plant, in all cases.

    Parameters
    ----------
    plant : Plant, str or Path
    controller : Controller, optional
        PI controllers by SIMC, or the first design that applies, if left out.
    plcs : sequence of str
        "st": its Structured Text by matiec; "c": its C by a compiler.
    wires : sequence of str
        "modbus", "opc-ua".
    precision : {"double", "single"}
        Of what is exported.
    encoding : str
        Of values in the registers of Modbus, as of `Doors`.
    speed : float, optional
        Times as fast as real time; the fastest that meets its deadlines if left out.
    folder : str or Path, optional
        Where the histories of its rigs stay; nowhere if left out.
    progress : callable, optional
        Takes what is tried next, in words.

    Raises
    ------
    InputError
        The controller cannot be exported, or nothing of what is asked for can be had here.

    Examples
    --------
    >>> import clepsydra as cl
    >>> if __name__ == "__main__":
    ...     cl.run_hil("quadruple-tank", plcs=["c"], wires=["modbus"]).holds
    """
    from clepsydra.deploy.exportable import exportable
    from clepsydra.rig.assembly import rig_settings

    for place, given, known in (("plcs", plcs, PLCS), ("wires", wires, WIRES)):
        for name in given:
            require_known(f"hil, {place}", name, known)
    for name in wires:
        require_packages("hil, wires", _CLIENTS[name])
    require_known("hil, precision", precision, ["double", "single"])
    own = plant_of(plant)
    if speed is not None:
        check_speed(speed, own.process.sampling_period)
    if "modbus" in wires:
        Doors(encoding=encoding).register_map(())
    bench = rig_of(own, controller or first_design(own))
    ready = exportable(bench.controllers[0], own.point)
    period = None if speed is None else own.process.sampling_period / speed
    with TemporaryDirectory() as elsewhere:
        settings = rig_settings(bench, Path(folder or elsewhere), speed=1.0, fail_safe={})
        asked = Asked(plcs, wires, precision, encoding, period)  # type: ignore[arg-type]
        found = hardware_in_the_loop(settings, ready, asked, progress or (lambda words: None))
    if not found.tried:
        raise InputError(
            "hil, plcs", ", ".join(plcs), "a PLC that can be had here: "
            + "; ".join(words for _, words in found.left_out), "install what is missing",
        )  # fmt: skip
    return HardwareInTheLoop(found)
