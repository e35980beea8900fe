"""A control scheme of a study file → its step law, its numbers, and a controller."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import check_parameters
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.placed import placed
from clepsydra.studies.file.rest_check import first_samples
from clepsydra.studies.file.scheme_blocks import SchemeBlocks
from clepsydra.studies.file.scheme_parts import read_parts
from clepsydra.studies.file.scheme_wiring import Wiring

SCHEME_KEYS = ("loops", "selectors", "split_ranges", "ratios", "feedforward", "outputs")
FAMILY = "control scheme"


@dataclass(frozen=True, eq=False)
class Scheme:
    """A control scheme whose law and numbers are known, but for the operating point.

    Parameters
    ----------
    name : str
    law : StepLaw
    values : dict
        Parameter of the law to its value.
    at_point : dict
        Parameter whose value is that of a signal at the operating point.
    fixed : dict
        Input of the law that the operator does not move, to its value at rest.
    follows : dict
        Input of the law that stands at a signal's value at rest.
    measurements, setpoints, manipulated : tuple of str
    design : str
    notes : tuple of str

    Examples
    --------
    See `read_scheme`.
    """

    name: str
    law: StepLaw
    values: dict[str, float]
    at_point: dict[str, str]
    fixed: dict[str, float]
    follows: dict[str, str]
    measurements: tuple[str, ...]
    setpoints: tuple[str, ...]
    manipulated: tuple[str, ...]
    design: str = ""
    notes: tuple[str, ...] = ()

    def controller(self, point: OperatingPoint) -> Controller:
        """Return the controller, at rest at an operating point as far as its setpoints allow."""
        at = point.as_dict()
        values = self.values | {name: at[signal] for name, signal in self.at_point.items()}
        free = self.fixed | {name: at[signal] for name, signal in self.follows.items()}
        inputs = dict(free)
        inputs |= {path(name, "sp"): at[name] for name in self.setpoints}
        inputs |= {path(name, "pv"): at[name] for name in self.measurements}
        inputs |= {path(name, "tracking"): at[name] for name in self.manipulated}
        state = state_at_rest(self.law, values, inputs)
        signals = [point.process.signal(name) for name in self.manipulated]
        begins = first_samples(
            self.law, values, state, inputs, signals, point.process.sampling_period
        )
        return Controller(
            name=self.name,
            family=FAMILY,
            design=self.design,
            law=self.law,
            values=values,
            initial_state=begins.state,
            measurements=self.measurements,
            setpoints=self.setpoints,
            manipulated=self.manipulated,
            notes=(*self.notes, *begins.notes),
            free_inputs=free,
        )


def read_scheme(table: TableReader, name: str, process: Process) -> Scheme:
    """Read a control scheme that is written out loop by loop.

    Parameters
    ----------
    table : TableReader
        Of the controller.
    name : str
        Of the controller.
    process : Process

    Raises
    ------
    InputError
        A part is wrong by itself, or the parts do not fit together.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b'''[loops.level]
    ... measurement = "level"
    ... output = "outflow"
    ... actions = "P"
    ... action = "direct"
    ... gain = "2 %/%"
    ... '''
    >>> process = load_process("equalisation-tank")
    >>> table = TableReader(parse(text, "study.toml"), (), None)
    >>> controller = read_scheme(table, "by hand", process).controller(find_equilibrium(process))
    >>> controller.values["level.proportional_gain"], controller.manipulated
    (-2.0, ('outflow',))
    """
    parts = read_parts(table, process)
    wiring = Wiring(parts)
    blocks = SchemeBlocks(parts, wiring)
    with placed(table, blocks.places):
        law = blocks.law(name)
    values = {parameter.name: parameter.initial for parameter in law.parameters} | blocks.values
    with placed(table, blocks.places):
        check_parameters(law, values, name)
    notes = []
    if blocks.assumed:
        notes.append(f"Not written, and taken as usual: {'; '.join(blocks.assumed)}.")
    still = [u.name for u in process.inputs if u.name not in wiring.outputs]
    if still:
        notes.append(f"It does not move {', '.join(still)}, which stays where it was.")
    return Scheme(
        name=name,
        law=law,
        values=values,
        at_point=blocks.at_point,
        fixed=blocks.fixed,
        follows=blocks.follows,
        measurements=blocks.measurements,
        setpoints=blocks.setpoints,
        manipulated=tuple(wiring.outputs),
        design=f"Written out, {'; '.join(blocks.words)}.",
        notes=tuple(notes),
    )
