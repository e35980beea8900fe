"""A study file to begin with, made for one process."""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections.abc import Iterable, Iterator
from contextlib import suppress
from string import Template
from typing import Any

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.signal import path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.design import DESIGNS
from clepsydra.designs.gain_units import percent_gain
from clepsydra.designs.request import in_shown_unit
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Scenario
from clepsydra.process.declared import table_schema
from clepsydra.process.process import Process
from clepsydra.studies.file.reader import StudyTable
from clepsydra.studies.file.scenario_reader import ScenarioTable
from clepsydra.studies.file.tuning_reader import Tuning
from clepsydra.studies.judge import of_averaging
from clepsydra.studies.usual_goal import DAMPING

#: Designs of single loops, from the one that is preferred; what the reader calls each.
_LOOPS = {
    "simc": "PI, SIMC",
    "lambda": "PI, lambda",
    "phase_margin": "PI, phase margin",
    "amigo": "PI, AMIGO",
    "arrest_time": "PI, arrest time",
}
#: The second design, from the one that is preferred.
_OTHERS = {"lqi": "LQI", "lqi_kalman": "LQI, Kalman", "lqr": "LQR", **_LOOPS}
#: How high the setpoints of another operating point are, as shares of those at rest.
_ELSEWHERE = (0.8, 0.9, 1.1, 1.2, 1.0)
#: How far the bounds that are shown lie from the design, up and down.
_WIDTH = 5.0
#: Lines for the first design where it takes a closed-loop time constant.
_FASTER = """$of_closed_loop_time_constant
# Left out, as fast as is robust.
# closed_loop_time_constant = "5 min"
"""
#: How long a line of a comment is at most.
_LINE = 100


def new_study(process: Process, named: str, template: str) -> str:
    """Return a commented study file for a process that works as it stands.

    Parameters
    ----------
    named : str
        What the file calls the process.
    template : str
        The file with places such as $process.

    Raises
    ------
    InputError
        No design of single loops applies to the process.
    NoEquilibrium
        It has no operating point.
    """
    analysis = analyse(process)
    scenario = default_scenario(analysis.model)
    first, designed = _first(analysis)
    second = _second(analysis, first)
    pairs = zip(designed.setpoints, designed.manipulated, strict=True)
    pairing = ", ".join(f'{output} = "{moved}"' for output, moved in pairs)
    return Template(template.replace("$more", _more(first))).substitute(
        process=_quoted(named),
        title=_quoted(f"Controllers for {process.title}"),
        duration=time_text(scenario.duration, 4),
        noise=time_text(max(s.start for s in scenario.segments if s.kind == "noise"), 4),
        steps=_steps(process, scenario),
        output=process.controlled[0],
        moved=json.dumps(designed.manipulated[0]),
        first=first,
        first_name=_LOOPS[first],
        second=second,
        second_name=_OTHERS[second],
        pairing=f"{{ {pairing} }}",
        objective=_objective(process),
        damping=f"{DAMPING:g}",
        loops=_written_out(process, designed),
        elsewhere=_elsewhere(analysis),
        **_bounds(process, designed),
        **_comments(first),
    )


def _more(first: str) -> str:
    return _FASTER if "closed_loop_time_constant" in DESIGNS[first].file_keys else ""


def _comments(first: str) -> dict[str, str]:
    """Return what is said of each key where it is declared, as a comment above it."""
    known: dict[str, Any] = {
        **table_schema(StudyTable)["properties"],
        **table_schema(ScenarioTable)["properties"],
        **table_schema(Tuning)["properties"],
    }
    for argument in DESIGNS[first].declared.values():
        known |= argument.properties
    return {f"of_{key}": _comment(schema["description"]) for key, schema in known.items()}


def _comment(words: str) -> str:
    """Return words as a comment: without marks of a page, and in lines that fit.

    >>> _comment("table of what counts, see [Ranking](#ranking)")
    '# Table of what counts, see Ranking.'
    """
    plain = re.sub(r"\[([A-Z]\w+)\]\(#\w+\)", r"\1", words).replace("`", "")
    lines = textwrap.wrap(f"{plain[0].upper()}{plain[1:]}.", _LINE - 2)
    return "\n".join(f"# {line}" for line in lines)


def _first(analysis: Analysis) -> tuple[str, Controller]:
    """Return a design of single loops that applies, and its controller."""
    process, reasons = analysis.operating_point.process, list[str]()
    averages = bool(process.averaging)
    names = sorted(_LOOPS, key=lambda name: averages and name != "arrest_time")
    found = next(_applicable(analysis, names, reasons), None)
    if found is not None:
        return found
    raise InputError(
        "--process",
        process.name,
        "a process to which a design of single loops applies",
        f"write the study file by hand ({'; '.join(reasons)[:300]})",
    )


def _second(analysis: Analysis, first: str) -> str:
    names = [name for name in _OTHERS if name != first]
    found = (name for name, _ in _applicable(analysis, names, []))
    return next(found, next(name for name in _LOOPS if name != first))


def _applicable(
    analysis: Analysis, names: Iterable[str], reasons: list[str]
) -> Iterator[tuple[str, Controller]]:
    """Yield the designs that apply, with their controllers; the others add their reasons."""
    for name in names:
        try:
            yield name, _designed(name, analysis)
        except NotApplicable as refusal:
            reasons.append(str(refusal).rstrip("."))


def _designed(name: str, analysis: Analysis) -> Controller:
    design = DESIGNS[name].function
    if name not in _LOOPS:
        return design(analysis.model)
    if not analysis.pairing:
        raise NotApplicable("the relative gains suggest no pairing")
    return design(analysis.model, analysis.pairing)


def _objective(process: Process) -> str:
    """Return what a process is tuned for: errors, and the outflow of levels that average."""
    if not process.averaging:
        return '"iae"'
    held = [f"iae[{name}]" for name in process.controlled if name not in process.averaging]
    return json.dumps([score for score, levels in of_averaging(process) if levels] + held)


def _steps(process: Process, scenario: Scenario) -> str:
    lines = []
    for segment in scenario.segments:
        if segment.kind == "noise":
            continue
        signal = process.signal(segment.signal)
        lines += [
            "",
            f"[[scenario.{segment.kind}]]",
            f'signal = "{segment.signal}"',
            f'at = "{time_text(segment.start, 4)}"',
            f'by = "{in_shown_unit(signal, segment.size, digits=6)}"',
        ]
    lines += ["# Or to a value: to = ..., in place of by."]
    return "\n".join(lines) + "\n"


def _elsewhere(analysis: Analysis) -> str:
    """Return setpoints below or above those at rest at which the process rests as well."""
    process, at = analysis.operating_point.process, analysis.operating_point.as_dict()
    for share in _ELSEWHERE:
        outputs = {}
        for signal in map(process.signal, process.controlled):
            low, high = process.bands.get(signal.name, (signal.low, signal.high))
            low = low if math.isfinite(low) else 0.0
            outputs[signal.name] = min(low + share * (at[signal.name] - low), high)
        with suppress(ClepsydraError):
            find_equilibrium(process, outputs=outputs)
            break
    shown = (
        f'{name} = "{in_shown_unit(process.signal(name), value, digits=3)}"'
        for name, value in outputs.items()
    )
    return f"{{ {', '.join(shown)} }}"


def _written_out(process: Process, designed: Controller) -> str:
    pairs = zip(designed.measurements, designed.manipulated, strict=True)
    loops = []
    for output, moved in pairs:
        gain, time = _settings(designed, output)
        shown = percent_gain(gain, process.signal(output), process.signal(moved))
        loops.append(
            f"[controllers.by-hand.loops.{output}]\n"
            f'measurement = "{output}"\n'
            f'output = "{moved}"\n'
            'actions = "PI"\n'
            f'action = "{"reverse" if gain > 0.0 else "direct"}"\n'
            f'gain = "{abs(shown):.4g} %/%"\n'
            f'integral_time = "{time_text(time, 4)}"'
        )
    return "\n\n".join(loops)


def _settings(designed: Controller, output: str) -> tuple[float, float]:
    gain, time = (path(output, part) for part in ("proportional_gain", "integral_time"))
    return designed.values[gain], designed.values[time]


def _bounds(process: Process, designed: Controller) -> dict[str, str]:
    """Return bounds around the settings of the first loop."""
    output, moved = designed.measurements[0], designed.manipulated[0]
    gain, time = _settings(designed, output)
    shown = abs(percent_gain(gain, process.signal(output), process.signal(moved)))
    gains = [f"{shown * factor:.2g} %/%" for factor in (1.0 / _WIDTH, _WIDTH)]
    times = [time_text(time * factor, 4) for factor in (1.0 / _WIDTH, _WIDTH)]
    return {"gain_bounds": json.dumps(gains), "time_bounds": json.dumps(times)}


def _quoted(text: str) -> str:
    """Return a text as TOML writes it."""
    return json.dumps(text, ensure_ascii=False)
