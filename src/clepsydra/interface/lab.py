"""`cl.lab`: a process under its controllers, moved by hand in a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.laboratory.rig import Rig


@keywords_checked()
def lab(
    plant: Subject,
    controllers: AnyController | Sequence[AnyController],
    path: str | Path | None = None,
) -> Path:
    """Write a page in which a process under its controllers is moved by hand.

    It is one file that works without a network: the drawing of the process lives, each loop has a
    faceplate, and the rig goes from one controller to another without a bump. What was done is
    saved there as a session, which `cl.replay` runs again with the same bits.

    Parameters
    ----------
    plant : Plant, str or Path
    controllers : Controller, or sequence of Controller
        The first has the rig when the page opens.
    path : str or Path, optional
        NAME-lab.html, after the process, if left out.

    Returns
    -------
    Path
        Of the page.

    Raises
    ------
    InputError
        There is no controller, it is none of this plant, or a function in Python; or the script
        of the page was not built with this installation.

    Examples
    --------
    >>> import tempfile
    >>> import clepsydra as cl
    >>> from clepsydra.report.page import lab_assets
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     if lab_assets():
    ...         page = lab(plant, [cl.design.simc(plant)], f"{folder}/tanks.html")
    """
    from clepsydra.laboratory.page import lab_text
    from clepsydra.report.page import write_page

    rig = rig_of(plant, controllers)
    target = Path(f"{rig.process.file_stem}-lab.html") if path is None else Path(path)
    write_page(lab_text(rig), target)
    return target


def rig_of(plant: Subject, controllers: AnyController | Sequence[AnyController]) -> Rig:
    """Return a plant under its controllers, as a laboratory and its sessions have it."""
    from clepsydra.laboratory.rig import Rig

    own = plant_of(plant)
    given = controllers if isinstance(controllers, Sequence) else (controllers,)
    return Rig(own.linear, [of_plant(each, own) for each in given])
