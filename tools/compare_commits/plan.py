"""What is run at a commit: every verb on every process of its catalogue, and exports.

The command line alone says what there is: the processes, the inputs of each, the controllers of
its study. What depends on such an answer is planned when it has come.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

#: Run before everything else, and not recorded: what these import, every command has at hand.
WARM_UP = [
    ["export", "quadruple-tank", "--controller", "PI, SIMC", "--to", "st"],
    ["simulate", "quadruple-tank"],
]
VERBS = (
    "study", "simulate", "analyse", "draw", "processes", "new", "export", "verify", "identify",
    "papers",
)  # fmt: skip
#: The process of what is run for one process only, and a controller of its study.
_ONE, _CONTROLLER = "quadruple-tank", "PI, SIMC"
#: Pages, trajectories and proofs are written here, as by `--json` alone they are not.
_WRITTEN = ("--json", "--output", ".")
#: Of its steps: enough to identify a model of one loop.
_RECORD = ("pump_1=3.3V@60s", "pump_1=2.8V@300s", "pump_1=3.1V@500s", "pump_2=3.2V@200s")
_STEP = 1.05  # of an input, in its value at rest
_SHORT = "10 min"  # of the simulation of a variant
_BETWEEN = 60  # from the step of one input to that of the next [s]


#: To what a controller is exported: target, its options, and how many of sixteen. Whatever the
#: target, the digest of the program is printed with it, so every law is compared and every printer
#: on some. PLCopen XML comes with `st`.
EXPORTS = (
    ("st", ("--to", "st"), 7),
    ("st matiec", ("--to", "st", "--dialect", "matiec"), 1),
    ("st scl", ("--to", "st", "--dialect", "scl"), 1),
    ("st single", ("--to", "st", "--precision", "single"), 1),
    ("c", ("--to", "c"), 3),
    ("c single", ("--to", "c", "--precision", "single"), 1),
    ("fmu", ("--to", "fmu"), 1),
    ("fmu 2.0", ("--to", "fmu", "--fmi", "2.0"), 1),
)
#: And its settings for vendors' blocks, of one controller in so many.
TUNING_OF_ONE_IN = 16
SAMPLED = (
    "Each controller of a process is exported to one target, chosen by its name: of 16 to "
    + ", ".join(f"{name} {of_sixteen}" for name, _, of_sixteen in EXPORTS)
    + f"; 1 in {TUNING_OF_ONE_IN} to tuning as well. A variant that is not in force by itself is "
    "studied with the controllers of a new study file."
)


@dataclass(frozen=True)
class Command:
    """One command line, or several that follow each other in one folder."""

    verb: str
    subject: str
    case: str
    steps: tuple[tuple[str, ...], ...]
    urgency: int = 0  # the longer it takes, the sooner it begins

    @property
    def label(self) -> str:
        """What the command is called, the same at every commit."""
        return " ".join(word for word in (self.verb, self.subject, self.case) if word)


def first_commands() -> list[Command]:
    """Return what can be run before anything is known of the commit."""
    record = [word for step in _RECORD for word in ("--input", step)]
    simulate = ("simulate", _ONE, *record, "--duration", "20 min", "--format", "csv", *_WRITTEN)
    data = f"{_ONE}-simulation.csv"
    loop = ("--manipulated", "pump_1", "--measured", "level_1")
    fit = ("--process", _ONE, "--parameters", "outlet_1.area,pump_1.gain", "--write", "fit.toml")
    proof = ("verify", _ONE, "--controller", _CONTROLLER, *_WRITTEN)
    study = (("new", "mine", "--study"), ("study", "mine.toml", *_WRITTEN))
    return [
        Command("processes", "", "", (("processes", "--json"),), 9),
        Command("papers", "", "", (("papers", "--json"),), 8),
        Command("verify", _ONE, _CONTROLLER, (proof,), 7),
        Command("study of a file", _ONE, "", study, 6),
        Command("new", "", "", (("new", "mine"), ("analyse", "mine.toml", "--json"))),
        Command("identify", _ONE, "model", (simulate, ("identify", data, *loop, *_WRITTEN))),
        Command("identify", _ONE, "parameters", (simulate, ("identify", data, *fit, *_WRITTEN))),
        Command("help", "", "", (("--help",),)),
        *(Command("help", verb, "", ((verb, "--help"),)) for verb in VERBS),
    ]


def following(command: Command, document: Any) -> list[Command]:
    """Return what is to be run after a command, from the document that it printed."""
    if command.verb == "processes":
        return [
            one
            for entry in _entries(document, "processes")
            for subject in _subjects(entry)
            for one in _of_subject(subject)
        ]
    if command.verb == "analyse" and isinstance(document, dict):
        return _simulations(command.subject, document)
    if command.verb == "study":
        names = [str(entry.get("controller")) for entry in _entries(document, "ranking")]
        return _exports(command.subject, names)
    return []


def _subjects(entry: dict[str, Any]) -> list[str]:
    """Return a process as it is, and with each variant that is not in force by itself."""
    name, default = entry["name"], entry.get("default_variants", [])
    return [name, *(f"{name}:{v}" for v in entry.get("variants", {}) if v not in default)]


def _of_subject(subject: str) -> list[Command]:
    new_study = ("new", "mine", "--study", "--process", subject)
    commands = [
        Command("analyse", subject, "", (("analyse", subject, "--json"),), 4),
        Command("draw", subject, "", (("draw", subject),)),
        Command("new", subject, "", (("new", "mine", "--from", subject),)),
    ]
    if ":" in subject:
        study = (new_study, ("study", "mine.toml", *_WRITTEN))
        return [*commands, Command("study of a file", subject, "", study, 5)]
    return [
        *commands,
        Command("study", subject, "", (("study", subject, *_WRITTEN),), 6),
        Command("new study", subject, "", (new_study,)),
        Command("export process", subject, "", (("export", subject, "--to", "fmu", "--json"),)),
    ]


def _simulations(subject: str, document: dict[str, Any]) -> list[Command]:
    """Step every input in turn, and fill the tanks; the unit is the one that is printed.

    A variant is stepped for a short time only, since some take weeks to come to rest.
    """
    point, units = document.get("operating_point", {}), document.get("units", {})
    steps = []
    for number, name in enumerate(document.get("inputs", []), 1):
        value = float(f"{point.get(name, 0.0) * _STEP:.3g}")
        unit = units.get(name, "1").removeprefix("1")
        steps += ["--input", f"{name}={value!r} {unit}@{number * _BETWEEN}s"]
    stepped = ("simulate", subject, *steps, *_WRITTEN)
    if ":" in subject:
        return [Command("simulate", subject, "steps", ((*stepped, "--duration", _SHORT),))]
    empty = ("simulate", subject, "--start", "empty", "--format", "csv", *_WRITTEN)
    solved = Command("simulate", subject, "by CVODES", ((*stepped, "--solver", "reference"),))
    return [
        Command("simulate", subject, "steps", (stepped,)),
        Command("simulate", subject, "from empty", (empty,)),
        *([solved] if subject == _ONE else []),
    ]


def _exports(subject: str, controllers: list[str]) -> list[Command]:
    targets = [(name, options) for name, options, of_sixteen in EXPORTS for _ in range(of_sixteen)]
    commands = []
    for controller in controllers:
        # By a digest of its name, so that one controller more changes nothing for the others.
        digest = hashlib.sha256(f"{subject} {controller}".encode()).digest()
        commands.append(_export(subject, controller, *targets[digest[0] % len(targets)]))
        if digest[1] % TUNING_OF_ONE_IN == 0:
            commands.append(_export(subject, controller, "tuning", ("--to", "tuning")))
    return commands


def _export(subject: str, controller: str, target: str, options: tuple[str, ...]) -> Command:
    words = ("export", subject, "--controller", controller, *options, "--json")
    return Command(f"export {target}", subject, controller, (words,))


def _entries(document: Any, key: str) -> list[dict[str, Any]]:
    """Return the objects that a document lists under a key; none where it is no such document."""
    entries = document.get(key, []) if isinstance(document, dict) else []
    return [entry for entry in entries if isinstance(entry, dict)]
