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
#: Of its steps: enough to identify a model of one loop.
_RECORD = ("pump_1=3.3V@60s", "pump_1=2.8V@300s", "pump_1=3.1V@500s", "pump_2=3.2V@200s")
_STEP = 1.05  # of an input, in its value at rest
_BETWEEN = 60  # from the step of one input to that of the next [s]


@dataclass(frozen=True)
class Export:
    """A target, and of how many controllers one is exported to it.

    The controllers of a sample are chosen by a digest of process and name, so that one more
    changes nothing for the others.
    """

    name: str
    options: tuple[str, ...]
    one_in: int

    def takes(self, subject: str, controller: str) -> bool:
        """Return whether this controller is in the sample."""
        digest = hashlib.sha256(f"{self.name}|{subject}|{controller}".encode()).digest()
        return int.from_bytes(digest[:4]) % self.one_in == 0


#: For the study of a process as the catalogue has it; PLCopen XML comes with `st`.
EXPORTS = (
    Export("st", ("--to", "st"), 1),
    Export("st matiec", ("--to", "st", "--dialect", "matiec"), 12),
    Export("st scl", ("--to", "st", "--dialect", "scl"), 12),
    Export("st single", ("--to", "st", "--precision", "single"), 12),
    Export("c", ("--to", "c"), 4),
    Export("c single", ("--to", "c", "--precision", "single"), 12),
    Export("tuning", ("--to", "tuning"), 4),
    Export("fmu", ("--to", "fmu"), 12),
    Export("fmu 2.0", ("--to", "fmu", "--fmi", "2.0"), 16),
)
#: For the study of another variant.
EXPORTS_OF_VARIANT = (Export("st", ("--to", "st"), 6),)


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
    simulate = ("simulate", _ONE, *record, "--duration", "20 min", "--format", "csv", "--json")
    data = f"{_ONE}-simulation.csv"
    loop = ("--manipulated", "pump_1", "--measured", "level_1")
    fit = ("--process", _ONE, "--parameters", "outlet_1.area,pump_1.gain", "--write", "fit.toml")
    proof = ("verify", _ONE, "--controller", _CONTROLLER, "--json")
    study = (("new", "mine", "--study"), ("study", "mine.toml", "--json"))
    return [
        Command("processes", "", "", (("processes", "--json"),), 9),
        Command("papers", "", "", (("papers", "--json"),), 8),
        Command("verify", _ONE, _CONTROLLER, (proof,), 7),
        Command("study of a file", _ONE, "", study, 6),
        Command("new", "", "", (("new", "mine"), ("analyse", "mine.toml", "--json"))),
        Command("identify", _ONE, "model", (simulate, ("identify", data, *loop, "--json"))),
        Command("identify", _ONE, "parameters", (simulate, ("identify", data, *fit, "--json"))),
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
    process = Command(
        "export process", subject, "", (("export", subject, "--to", "fmu", "--json"),)
    )
    study = ("new", "mine", "--study", "--process", subject)
    return [
        Command("study", subject, "", (("study", subject, "--json"),), 5),
        Command("analyse", subject, "", (("analyse", subject, "--json"),), 4),
        Command("draw", subject, "", (("draw", subject),)),
        Command("new", subject, "", (("new", "mine", "--from", subject),)),
        Command("new study", subject, "", (study,)),
        *([] if ":" in subject else [process]),
    ]


def _simulations(subject: str, document: dict[str, Any]) -> list[Command]:
    """Step every input in turn, and fill the tanks; the unit is the one that is printed."""
    point, units = document.get("operating_point", {}), document.get("units", {})
    steps = []
    for number, name in enumerate(document.get("inputs", []), 1):
        value = float(f"{point.get(name, 0.0) * _STEP:.3g}")
        steps += ["--input", f"{name}={value!r} {units.get(name, '')}@{number * _BETWEEN}s"]
    stepped = ("simulate", subject, *steps, "--json")
    empty = ("simulate", subject, "--start", "empty", "--format", "csv", "--json")
    solved = Command("simulate", subject, "by CVODES", ((*stepped, "--solver", "reference"),))
    return [
        Command("simulate", subject, "steps", (stepped,)),
        Command("simulate", subject, "from empty", (empty,)),
        *([] if ":" in subject else [solved]),
    ]


def _exports(subject: str, controllers: list[str]) -> list[Command]:
    """Export the controllers of a study; a target takes all or a sample."""
    return [
        Command(
            f"export {target.name}",
            subject,
            controller,
            (("export", subject, "--controller", controller, *target.options, "--json"),),
        )
        for controller in controllers
        for target in (EXPORTS_OF_VARIANT if ":" in subject else EXPORTS)
        if target.takes(subject, controller)
    ]


def _entries(document: Any, key: str) -> list[dict[str, Any]]:
    """Return the objects that a document lists under a key; none where it is no such document."""
    entries = document.get(key, []) if isinstance(document, dict) else []
    return [entry for entry in entries if isinstance(entry, dict)]
