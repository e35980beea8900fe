"""``python -m benchmarks.exported.library``: write what the pages of the block library show.

Everything comes from the programs that are printed: the parts of the pages between the marks
`<!-- blocks: NAME … -->` and `<!-- end of blocks -->`, and docs/blocks/*.svg. A test holds that
they agree with the code.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from benchmarks.exported.families import FAMILIES, ready_for_export
from clepsydra.base.signal import Signal
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.exported_alarms import exportable_alarms
from clepsydra.deploy.structured_text.function_block import block_type
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.process.reader import load_process
from clepsydra.program.called_blocks import called_blocks, without_untold
from clepsydra.program.entries import signal_of
from clepsydra.program.owned_state import own_state, with_owned_state
from clepsydra.program.program import Program
from clepsydra.report.drawing.block_picture import block_svg, program_svg
from clepsydra.studies.designs import DESIGNS

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = tuple(DOCS / f"block-library{what}.md" for what in ("", "-loops", "-laws", "-alarms"))
PICTURES = DOCS / "blocks"
MARKED = re.compile(r"(<!-- blocks: (.+?) -->\n).*?(<!-- end of blocks -->)", re.DOTALL)
#: Diagrams, and the controllers that they are of.
WIRED = {
    "two-pi-loops": "PI, SIMC",
    "cascade": "Cascade with feedforward",
    "lqi-kalman": "LQI with Kalman filter",
}
#: A block with more inputs has only those shown that are no parameters of the controller.
_MOST_INPUTS = 24
#: Pixels to the point of a picture.
_SCALE = 1.5
#: A process with an alarm of every kind.
_ALARMED = Path(__file__).with_name("every_alarm.toml")


@cache
def program_of(family: str) -> Program:
    """Return the program of a controller in its plant shell; its blocks with all their ports."""
    return with_owned_state(ready_for_export(family).program)


@cache
def alarms_program() -> Program:
    """Return the program of the alarms of a process that has every one."""
    return with_owned_state(exportable_alarms(_alarmed().operating_point).program)


@cache
def interlocked_program() -> Program:
    """Return the program of a controller whose output they hold."""
    analysis = _alarmed()
    controller = DESIGNS["PI, SIMC"](analysis)
    return with_owned_state(exportable(controller, analysis.operating_point).program)


@cache
def _alarmed() -> Analysis:
    return analyse(load_process(_ALARMED))


@cache
def library() -> dict[str, tuple[Program, frozenset[str]]]:
    """Return every block by name, with its inputs that are only counted."""
    found = {}
    for program in (*map(program_of, FAMILIES), alarms_program(), interlocked_program()):
        parameters = frozenset(signal.name for signal in program.parameters)
        for block in called_blocks(program):
            inputs = frozenset(signal.name for signal in block.inputs)
            counted = parameters & inputs if len(inputs) > _MOST_INPUTS else frozenset()
            found.setdefault(block.name, (block, counted))
    return found


def pictures() -> dict[str, str]:
    """Return every picture by the name of its file."""
    found = {
        name: block_svg(block, f"{block_type(block)} and its ports", counted)
        for name, (block, counted) in library().items()
    }
    for name, family in WIRED.items():
        program = without_untold(program_of(family))
        found[name] = program_svg(program, f"{family}, in its plant shell")
    program = without_untold(program_of(WIRED["lqi-kalman"]))
    law = next(call.program for call in program.calls if call.instance == "law")
    settings = {signal.name for signal in program.parameters} & {s.name for s in law.inputs}
    found["lqi-kalman-law"] = program_svg(law, "LQI with Kalman filter", settings)
    return {f"{name}.svg": standing_alone(svg) for name, svg in found.items()}


def standing_alone(svg: str) -> str:
    """Return a picture of a report as a file: with a size of its own."""
    width, height = (float(n) * _SCALE for n in re.findall(r'viewBox="0 0 (\S+) (\S+)"', svg)[0])
    return svg.replace("<svg ", f'<svg width="{width:.0f}" height="{height:.0f}" ', 1) + "\n"


def part(names: Iterable[str]) -> str:
    """Return what a page shows of some blocks."""
    return "\n".join(_shown(*library()[name]) for name in names)


def _shown(block: Program, counted: frozenset[str]) -> str:
    kind = block_type(block)
    words = " ".join(block.description) if len(block.description) <= 3 else ""
    given = [_port(signal) for signal in block.inputs if signal.name not in counted]
    if counted:
        given.append(f"{len(counted)} parameters of the controller")
    rows = (
        ("in", given),
        ("out", map(_port, block.outputs)),
        ("keeps", [_port(signal_of(entry)) for entry in own_state(block)]),
        ("calls", [f"`{block_type(called)}`" for called in called_blocks(block)]),
    )
    lines = [f"**`{kind}`**" + (f" {words}" if words else ""), ""]
    lines += [f"![{kind} and its ports](blocks/{block.name}.svg)", "", "| | |", "|---|---|"]
    lines += [f"| {what} | {said} |" for what, ports in rows if (said := "<br>".join(ports))]
    return "\n".join([*lines, ""])


def _port(signal: Signal) -> str:
    unit = f" [{signal.unit}]" if signal.unit != "1" else ""
    words = f" {signal.description}" if signal.description else ""
    return f"`{signal.identifier}`{unit}{words}".replace("|", "\\|")


def filled(page: Path) -> str:
    """Return a page with the parts between its marks written anew."""
    text = page.read_text(encoding="utf-8")
    return MARKED.sub(lambda found: f"{found[1]}{part(found[2].split())}{found[3]}", text)


def main() -> None:
    """Write pages and pictures."""
    PICTURES.mkdir(exist_ok=True)
    for old in PICTURES.glob("*.svg"):
        old.unlink()
    for name, svg in pictures().items():
        (PICTURES / name).write_text(svg, encoding="utf-8")
    for page in PAGES:
        page.write_text(filled(page), encoding="utf-8")


if __name__ == "__main__":
    main()
