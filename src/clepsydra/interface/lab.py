"""`cl.lab`: a process under its controllers, moved by hand in a page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.controller import AnyController, of_plant
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.laboratory.rig import Rig


class Laboratory(os.PathLike[str]):
    """The page of a laboratory, which a notebook shows.

    Parameters
    ----------
    path : Path
        Of its file.
    title : str
    """

    def __init__(self, path: Path, title: str) -> None:
        self.path, self.title = path, title

    def __fspath__(self) -> str:
        """Return the path of its file."""
        return str(self.path)

    def __repr__(self) -> str:
        return f"Laboratory({str(self.path)!r})"

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the page, in which the rig runs."""
        from clepsydra.report.page import framed

        return framed(self.path.read_text(encoding="utf-8"), self.title, saves=True)


@keywords_checked()
def lab(
    plant: Subject,
    controllers: AnyController | Sequence[AnyController],
    path: str | Path | None = None,
    *,
    regulators: str | Path | Sequence[str | Path] = (),
) -> Laboratory:
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
    regulators : str or Path, or sequence of them
        MAT files that the page brings along: it asks for units and sign of each before it is
        switched on. A regulator whose units are known is one of the controllers.

    Returns
    -------
    Laboratory
        Its `path`; as the result of a cell it is the page itself.

    Raises
    ------
    InputError
        There is no controller, it is none of this plant, or a function in Python; a file of a
        regulator is none, or has more states than a page has room for; or the script of the page
        was not built with this installation.

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
    from clepsydra.laboratory.regulator_files import regulator_files
    from clepsydra.report.page import write_page

    rig = rig_of(plant, controllers)
    target = Path(f"{rig.process.file_stem}-lab.html") if path is None else Path(path)
    files = [regulators] if isinstance(regulators, (str, Path)) else regulators
    write_page(lab_text(rig, files=regulator_files(files)), target)
    return Laboratory(target, f"Laboratory of {rig.process.title}")


def rig_of(
    plant: Subject,
    controllers: AnyController | Sequence[AnyController],
    page: str | Path | None = None,
) -> Rig:
    """Return a plant under its controllers, as a laboratory and its sessions have it.

    Parameters
    ----------
    page : str or Path, optional
        A page of them, of which their numbers are.
    """
    from clepsydra.laboratory.page_file import numbers_of_page
    from clepsydra.laboratory.rig import Rig

    own = plant_of(plant)
    given = controllers if isinstance(controllers, Sequence) else (controllers,)
    numbers = {} if page is None else numbers_of_page(page)
    return Rig(own.linear, [of_plant(each, own) for each in given], numbers)
