"""What an FMU is made of, whatever version of the interface: variables, programs, C of its own."""

from __future__ import annotations

import hashlib
import math
import re
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from clepsydra import __version__
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.program import Block, Program, read_by, written_by

Causality = Literal["input", "parameter", "output", "local"]
Variability = Literal["continuous", "discrete", "tunable"]
_WORD = r"[A-Za-z_]\w*(\[\d+\])*"
#: A name in the structured convention: words of letters, digits and underscores, joined by dots,
#: each with the place of an element behind it where it has any.
_STRUCTURED = re.compile(rf"{_WORD}(\.{_WORD})*|der\(({_WORD}\.)*{_WORD}\)", re.ASCII)
_PLACE = re.compile(r"\.(\d+)(?=\.|\)|$)")
_DIGIT_FIRST = re.compile(r"(?<=\.)(?=\d)")
#: Namespace of the tokens that identify a model.
_NAMESPACE = uuid.uuid5(uuid.NAMESPACE_DNS, "clepsydra.functional-mock-up-unit")


@dataclass(frozen=True)
class FmuVariable:
    """A variable of the model description.

    Parameters
    ----------
    signal : Signal
        Name, unit, range, start value and type.
    member : str
        Where it is in the memory of the model, as C writes it: "inputs.level_1".
    causality, variability : str
        As the standard defines them.
    depends_on : tuple of str or None
        Of what nobody sets: the variables that it is computed from at the start.
    derivative_of : str
        Of a derivative: the continuous state.
    """

    signal: Signal
    member: str
    causality: Causality
    variability: Variability
    depends_on: tuple[str, ...] | None = None
    derivative_of: str = ""

    @property
    def name(self) -> str:
        """The name in the FMU, with dots between words and brackets round the place of an element.

        No word begins with a digit there: an underscore stands before it.

        >>> names = "level_8.model_share.2", "feed.40_s_before"
        >>> [FmuVariable(Signal(name), "", "parameter", "tunable").name for name in names]
        ['level_8.model_share[2]', 'feed._40_s_before']
        """
        return _DIGIT_FIRST.sub("_", _PLACE.sub(r"[\1]", self.signal.name))

    @property
    def settable(self) -> bool:
        """Whether it has a start value that the importer may change."""
        return self.depends_on is None

    @property
    def nominal(self) -> float:
        """The size of a state [its unit], which an importer's tolerances are relative to.

        >>> level = Signal("tank_1.level", "m", low=0.0, high=0.2)
        >>> FmuVariable(level, "inputs.level", "local", "continuous").nominal
        0.2
        """
        ends = (abs(self.signal.low), abs(self.signal.high))
        sizes = [end for end in ends if math.isfinite(end) and end != 0.0]
        return max(sizes) if sizes else abs(self.signal.initial) or 1.0


@dataclass(frozen=True)
class FmuModel:
    """A controller or a process, ready to be written as an FMU.

    Parameters
    ----------
    programs : tuple of Program
        What the sources are printed from; the first one has parameters, inputs, state and
        outputs of the model.
    variables : tuple of FmuVariable
        The first one has value reference 1, for 0 is that of time.
    functions : str
        C of ``model_show`` and ``model_advance``, of ``model_part`` and ``model_complete`` for
        parts of a step, or of ``model_switch`` and ``model_update``.
    step : float
        Length of a model step [s]; 0 for model exchange.
    scans : bool
        Whether the model steps at the start of each sampling period, as a controller does.
    title : str
        One line for the reader.
    origin : Origin
    indicators : tuple of str
        The variables that are event indicators.
    followed : tuple of str
        The memories that follow the motion at the end of every integrator step.
    kept : tuple of str
        The numbers that the memory has for parts of a step, see `fmi/part_of_step.py`.

    Raises
    ------
    InputError
        Two variables have one name, or a name is none of the structured naming convention.
    """

    programs: tuple[Program, ...]
    variables: tuple[FmuVariable, ...]
    functions: str
    step: float
    scans: bool
    title: str
    origin: Origin
    indicators: tuple[str, ...] = ()
    followed: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        # The independent variable of the standard has a name too.
        names = ["time", *(variable.name for variable in self.variables)]
        for name in names:
            expected = ""
            if not _STRUCTURED.fullmatch(name):
                expected = (
                    "a name that an FMU can have: letters from A to Z, digits and underscores, a "
                    "letter first, and dots between words"
                )
            elif names.count(name) > 1:
                expected = "a name of its own in the FMU"
            if expected:
                remedy = "rename the input, output, parameter or state"
                raise InputError(f"program {self.name}, {name}", name, expected, remedy)

    @property
    def name(self) -> str:
        """The model identifier, from which the binary gets its name."""
        return self.programs[0].name

    @property
    def exchange(self) -> bool:
        """Whether the importer integrates it."""
        return self.step == 0.0

    @property
    def digest(self) -> str:
        """The digest of its program, as it stands in the heads of the printed texts."""
        return digest(self.programs[0])

    def token(self, version: str) -> str:
        """Return what ties the binary to the model description of a version of the interface."""
        parts = [digest(program) for program in self.programs]
        parts += [self.functions, repr((self.step, self.scans, __version__))]
        whole = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]
        return f"{{{uuid.uuid5(_NAMESPACE, f'{whole} {version}')}}}"

    def reference(self, name: str) -> int:
        """Return the value reference of the variable of a signal's name."""
        return 1 + [variable.signal.name for variable in self.variables].index(name)

    @property
    def derivatives(self) -> tuple[FmuVariable, ...]:
        """The derivatives of the continuous states, in order."""
        return tuple(variable for variable in self.variables if variable.derivative_of)

    @property
    def states(self) -> tuple[FmuVariable, ...]:
        """The continuous states, in order."""
        return tuple(self.variable(each.derivative_of) for each in self.derivatives)

    @property
    def outputs(self) -> tuple[FmuVariable, ...]:
        """The outputs, in order."""
        return tuple(v for v in self.variables if v.causality == "output")

    def variable(self, name: str) -> FmuVariable:
        """Return the variable of a signal's name."""
        return self.variables[self.reference(name) - 1]

    def known_later(self, variable: FmuVariable) -> tuple[str, ...]:
        """Return on which inputs and continuous states a result depends after the start.

        In co-simulation there are none: between two steps the results hold.
        """
        if not self.exchange:
            return ()
        states = {derivative.derivative_of for derivative in self.derivatives}
        # A state that is an output depends on itself.
        depends_on = (variable.signal.name,) if variable.depends_on is None else variable.depends_on
        return tuple(
            name
            for name in depends_on
            if name in states or self.variable(name).causality == "input"
        )


def variables_of(
    signals: Sequence[Signal],
    where: str,
    causality: Causality,
    variability: Variability,
    depends_on: Sequence[tuple[str, ...]] | None = None,
) -> list[FmuVariable]:
    """Return the variables of a group; what is no real number is discrete unless it is tuned."""
    return [
        FmuVariable(
            signal,
            f"{where}.{signal.identifier}",
            causality,
            "discrete" if signal.kind != "real" and variability == "continuous" else variability,
            None if depends_on is None else depends_on[place],
        )
        for place, signal in enumerate(signals)
    ]


def output_dependencies(program: Program) -> list[tuple[str, ...]]:
    """Return for each output the states, inputs and parameters that it is computed from.

    What a loop or a conditional carries is taken to depend on everything that it reads.
    """
    names = [s.name for s in (*program.state, *program.inputs, *program.parameters)]
    found = _arguments_of_results(program.block)[len(program.state) :]
    return [tuple(names[value] for value in sorted(each)) for each in found]


def _arguments_of_results(block: Block) -> list[frozenset[int]]:
    known = {value: frozenset((value,)) for value in range(block.arguments)}
    for statement in block.statements:
        depends = frozenset().union(*(known[value] for value in read_by(statement)))
        known |= dict.fromkeys(written_by(statement), depends)
    return [known[value] for value in block.results]
