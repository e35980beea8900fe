"""`cl.identify`: a model from a record."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

from clepsydra.base.errors import InputError
from clepsydra.base.history_reading import is_history
from clepsydra.base.keywords import keywords_checked
from clepsydra.designs.applicability import NotApplicable
from clepsydra.identification import identification as inner
from clepsydra.identification import process_fit
from clepsydra.identification.history_record import read_history
from clepsydra.identification.identification import identify_model
from clepsydra.identification.process_file import write_fitted_process
from clepsydra.identification.record import Record, read_record
from clepsydra.interface.plant import Plant
from clepsydra.interface.quantities import Quantity, read_time
from clepsydra.interface.shown import Answered, lifted
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.base.section import Section
    from clepsydra.process.process import Process


class _Page(Answered):
    def answer(self, *, every: bool = False) -> Section:
        """Return what was found and what to do with it, or every parameter and remark."""
        from clepsydra.report.identification_page import identification_answer

        return identification_answer(self, every=every)  # type: ignore[arg-type]

    def report(self, path: str | Path) -> None:
        """Write a page with measured against simulated."""
        from clepsydra.report.identification_page import identification_text
        from clepsydra.report.page import write_page

        write_page(identification_text(self), path)  # type: ignore[arg-type]


class Identification(_Page, inner.Identification):
    """The models of a record, the one to use first: `best`, `for_control`, `verdict`, `models`."""

    @property
    def settings(self) -> dict[str, str]:
        """The PI or PID settings that follow, by SIMC, as `Controller.with_values` takes a loop's.

        Raises
        ------
        NotApplicable
            No settings follow from these models.

        Examples
        --------
        >>> import clepsydra as cl, tempfile
        >>> plant = cl.load("quadruple-tank")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cl.simulate(plant, None, [cl.step("pump_1", "50 mV")]).save(f"{folder}/step.csv")
        ...     found = identify(f"{folder}/step.csv", "pump_1", "level_1")
        >>> pi = cl.design.simc(plant).with_values({"level_1": found.settings})
        >>> round(pi.values["level_1.integral_time"])  # [s]
        63
        """
        model = self.for_control
        if model is None or model.settings is None:
            raise NotApplicable(self.verdict, "SIMC")
        return model.settings.as_values()


class FittedPlant(_Page, process_fit.ProcessFit):
    """A process with the parameters that explain a record best: `values`, `verdict`, `plant`."""

    @property
    def plant(self) -> Plant:
        """The plant with the fitted parameters."""
        return Plant(self.process)

    def write(self, path: str | Path) -> None:
        """Write the process file with the fitted parameters."""
        path = Path(path)
        if path.suffix.lower() != ".toml":
            raise InputError("path", str(path), "a file that ends in .toml", "rename it")
        write_fitted_process(self, path)


@overload
def identify(
    record: str | Path | Record,
    manipulated: str | None = None,
    measured: str | None = None,
    *,
    last: Quantity | None = None,
) -> Identification: ...
@overload
def identify(
    record: str | Path | Record,
    *,
    plant: Subject,
    parameters: Sequence[str],
    last: Quantity | None = None,
) -> FittedPlant: ...
@keywords_checked()
def identify(
    record: str | Path | Record,
    manipulated: str | None = None,
    measured: str | None = None,
    *,
    plant: Subject | None = None,
    parameters: Sequence[str] | None = None,
    last: Quantity | None = None,
) -> Identification | FittedPlant:
    """Identify a model from a record: ARX, FOPDT, SOPDT, IPDT, or parameters of a plant.

    Parameters
    ----------
    record : str, Path or Record
        A CSV file, sampled regularly, whose head names time and signals with their units,
        "time [s],pump_1 [V]"; or the history of a rig, of which the last run is read.
    manipulated, measured : str, optional
        The column that moves the other, and that other; the record may leave only one choice.
    plant : Plant, str or Path, optional
        Whose parameters are fitted instead, to all of its inputs and measurements in the record.
    parameters : sequence of str, optional
        Those to fit, ["outlet_1.area"].
    last : optional
        Of a history the end that is read, as in "2 h"; the whole run if left out.

    Raises
    ------
    InputError
        The record, a name or a parameter cannot be used, or no model can be fitted.

    Examples
    --------
    >>> import clepsydra as cl, tempfile
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cl.simulate(plant, None, [cl.step("pump_1", "50 mV")]).save(f"{folder}/step.csv")
    ...     found = identify(f"{folder}/step.csv", "pump_1", "level_1")
    >>> gain, time_constant, _ = (estimate.value for estimate in found.models[0].estimates)
    >>> round(gain, 1), round(time_constant)  # [V/V], [s]
    (2.6, 63)
    """
    process = None if plant is None else plant_of(plant).process
    read = record if isinstance(record, Record) else _read(Path(record), process, last)
    if process is None:
        if parameters is not None:
            raise InputError(
                "parameters", str(parameters), "a plant that has them", "name it: plant=plant"
            )
        return lifted(Identification, identify_model(read, manipulated, measured))
    for key, name in (("manipulated", manipulated), ("measured", measured)):
        if name is not None:
            raise InputError(
                key, name, f"no {key} with a plant",
                "leave it out: every input and measurement of the plant that is recorded counts",
            )  # fmt: skip
    fit = process_fit.fit_process(process, read, list(parameters or ()))
    return lifted(FittedPlant, fit)


def _read(path: Path, process: Process | None, last: Quantity | None) -> Record:
    if is_history(path):
        return read_history(
            path, process, None if last is None else read_time("identify", "last", last)
        )
    if last is not None:
        raise InputError(
            "last", last, "the history of a rig, of which it is the end", "leave it out"
        )
    return read_record(path, process)
