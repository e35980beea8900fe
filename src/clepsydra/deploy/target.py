"""A target of an export: what a controller or a process is printed as, and how that is proved."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from clepsydra.base.errors import InputError
from clepsydra.base.registry import Registry
from clepsydra.base.suggestion import suggestion

if TYPE_CHECKING:
    from clepsydra.base.section import Section
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.plant_shell.settings import PlantShell
    from clepsydra.deploy.compiler import Compiler
    from clepsydra.deploy.exportable import Exportable
    from clepsydra.deploy.proof.run import Run
    from clepsydra.linear.operating_point import OperatingPoint
    from clepsydra.loop.scenario import Scenario

#: Option of a target to its value, one of those that the target declares.
Options = dict[str, Any]


@dataclass(frozen=True)
class ExportedFiles:
    """What an export consists of.

    Parameters
    ----------
    files : mapping
        Name to content.
    facts : mapping
        For JSON: name and digest of the program, and what else belongs to the target.
    next_step : str
        What the engineer does with them.
    then : tuple of str
        What follows, a step each.
    answer : Section, optional
        What is shown of them on a terminal; without one what they are, by the target's words.
    """

    files: Mapping[str, bytes]
    facts: Mapping[str, Any]
    next_step: str
    then: tuple[str, ...] = ()
    answer: Section | None = None


@dataclass(frozen=True)
class Delivery:
    """A controller that is to be exported.

    Parameters
    ----------
    controller : Controller
        As it was designed or tuned, without a shell.
    point : OperatingPoint
        Where it starts.
    scenario : callable
        Returns the scenario in which a target simulates what it writes.
    shell : PlantShell, optional
    """

    controller: Controller
    point: OperatingPoint
    scenario: Callable[[], Scenario]
    shell: PlantShell | None = None

    @cached_property
    def ready(self) -> Exportable:
        """The controller in its plant shell, with names and sources."""
        from clepsydra.deploy.exportable import exportable

        return exportable(self.controller, self.point, self.shell)


@dataclass(frozen=True)
class Target:
    """One target; its file in `clepsydra.deploy.targets` adds it to `TARGETS`.

    Parameters
    ----------
    place : int
        Among the others, where they are listed.
    words : str
        What is written.
    controller : callable
        Takes a `Delivery` and the options, and returns `ExportedFiles`.
    options : mapping
        Name to the values that it may have, the first where none is given.
    process : callable, optional
        Takes an operating point and the options; left out where only controllers are exported.
    runs : callable, optional
        Takes "controller" or "process" and a compiler, and returns what a proof runs; left out
        where nothing runs.
    shelled : bool
        Whether the controller is exported in its plant shell.

    Examples
    --------
    >>> list(TARGETS), TARGETS["st"].options["dialect"]
    (['c', 'st', 'fmu', 'wasm', 'tuning', 'signals'], ('codesys', 'matiec', 'scl'))
    """

    place: int
    words: str
    controller: Callable[[Delivery, Options], ExportedFiles]
    options: Mapping[str, Sequence[str]] = field(default_factory=dict)
    process: Callable[[OperatingPoint, Options], ExportedFiles] | None = None
    runs: Callable[[str, Compiler], list[Run]] | None = None
    shelled: bool = True


TARGETS = Registry[Target]("clepsydra.deploy.targets", order=lambda target: target.place)


def targets_of(
    names: Sequence[str],
    given: Mapping[str, str | None],
    *,
    shell: bool = False,
    process: bool = False,
) -> list[tuple[Target, dict[str, str]]]:
    """Return several targets of one export, each with those of the options that it has.

    Parameters
    ----------
    names : sequence of str
    given, shell, process
        See `target_of`; an option is given for every target that has it.

    Raises
    ------
    InputError
        As `target_of`; a name comes twice, or no target has an option.

    Examples
    --------
    >>> found = targets_of(["st", "c"], {"dialect": "scl", "precision": None})
    >>> [options for _, options in found]
    [{'precision': 'double', 'dialect': 'scl'}, {'precision': 'double'}]
    """
    for place, name in enumerate(names):
        if name in names[:place]:
            raise InputError("export, to", name, "each target once", "leave one of them out")
    known = {option for name in names if name in TARGETS for option in TARGETS[name].options}
    return [
        target_of(
            name,
            {
                option: value
                for option, value in given.items()
                if name not in TARGETS or option in TARGETS[name].options or option not in known
            },
            shell=shell,
            process=process,
        )
        for name in names
    ]


def target_of(
    name: str, given: Mapping[str, str | None], *, shell: bool = False, process: bool = False
) -> tuple[Target, dict[str, str]]:
    """Return a target and its options, those that are not given by their first values.

    Parameters
    ----------
    name : str
    given : mapping
        Option to its value, None where it is left out.
    shell : bool
        Whether the plant shell has settings.
    process : bool
        Whether the process itself is to be exported.

    Raises
    ------
    InputError
        There is no such target, or it has no such option, no such value of an option, or no
        plant shell.

    Examples
    --------
    >>> target_of("st", {"dialect": "scl", "fmi": None})[1]
    {'precision': 'double', 'dialect': 'scl'}
    """
    if name not in TARGETS:
        remedy = suggestion(name, TARGETS, "choose one of them")
        raise InputError("export, to", name, f"one of {', '.join(TARGETS)}", remedy)
    target = TARGETS[name]
    if shell and (process or not target.shelled):
        raise InputError(
            "plant options",
            "given",
            "such an option with a controller in a plant shell only",
            "leave it out",
        )
    for option, value in given.items():
        place = f"export, {option}"
        if value is None:
            continue
        if option not in target.options:
            users = [f'to="{to}"' for to, each in TARGETS.items() if option in each.options]
            expected = f"such an option with {' or '.join(users)} only"
            raise InputError(place, value, expected, "leave it out")
        allowed = target.options[option]
        if value not in allowed:
            remedy = suggestion(value, allowed, "choose one of them")
            raise InputError(place, value, f"one of {', '.join(allowed)}", remedy)
    return target, {
        option: given.get(option) or allowed[0] for option, allowed in target.options.items()
    }
