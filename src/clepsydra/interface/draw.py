"""`cl.draw`: the picture of a process."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.files import whole_file
from clepsydra.base.keywords import keywords_checked
from clepsydra.controllers.wiring import check_signals
from clepsydra.interface.controller import AnyController, required
from clepsydra.interface.subject import Subject, plant_of
from clepsydra.linear.equilibrium import NoEquilibrium


@keywords_checked()
def draw(
    plant: Subject, path: str | Path | None = None, controller: AnyController | None = None
) -> NoEquilibrium | None:
    """Draw a process with the values of its operating point, as SVG.

    Parameters
    ----------
    plant : Plant, str or Path
    path : str or Path, optional
        NAME.svg, after the process, if left out.
    controller : Controller, optional
        Whose loops are drawn; without one there are transmitters alone.

    Returns
    -------
    NoEquilibrium or None
        Why it is drawn without values, where it never rests.

    Raises
    ------
    InputError
        It is no controller, or it is wired to signals that the plant does not have.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     draw("three-tanks", f"{folder}/tanks.svg")
    """
    from clepsydra.report.drawing.plant import process_drawing

    plant, reason = plant_of(plant), None
    if controller is not None:
        controller = required(controller)
        wires = controller.measurements, controller.setpoints, controller.manipulated
        check_signals(*wires, controller.name, plant.process)
    try:
        point = plant.equilibrium()
    except NoEquilibrium as error:
        point, reason = None, error
    picture = process_drawing(plant.process, point, controller)
    with whole_file(Path(f"{plant.file_stem}.svg" if path is None else path)) as part:
        part.write_text(picture, encoding="utf-8")
    return reason
