"""Printed C as a program of its own, for a machine or a build that no library here can be of."""

import subprocess
from pathlib import Path

import numpy as np

from clepsydra import Signal
from clepsydra.deploy.c99.printer import CSource
from clepsydra.program.entries import is_ring
from clepsydra.program.owned_state import state_paths, with_owned_state
from clepsydra.program.program import Program

#: Reads inputs and parameters of every scan, and writes outputs and states after each.
DRIVER = """\
#include "{name}.h"
#include <stdio.h>
int main(void)
{{
  static {name}_parameters printed, parameters;
  static {name}_state state;
  static {name}_inputs inputs;
  static {name}_outputs outputs;
  double given[{columns}], found[{results}];
  {name}_default_parameters(&printed);
  {name}_initialise(&state);
  while (fread(given, sizeof given, 1, stdin) == 1) {{
    parameters = printed;
{taken}
    {name}_step(&parameters, &state, &inputs, &outputs);
{shown}
    fwrite(found, sizeof found, 1, stdout);
  }}
  return 0;
}}
"""


def written(printed: CSource, folder: Path) -> Path:
    """Write header and source; returns the path of the source."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / printed.header_name).write_text(printed.header, encoding="utf-8")
    source = folder / printed.source_name
    source.write_text(printed.source, encoding="utf-8")
    return source


def built(command: list[str], program: Program, printed: CSource, folder: Path) -> Path:
    """Build the driver of a program by a compiler with its flags."""
    source, driver = written(printed, folder), folder / "driver.c"
    single = "float " in printed.header
    kinds = {"real": "float" if single else "double", "integer": "int32_t", "boolean": "bool"}
    taken, shown = [], []
    for place, signal in enumerate((*program.inputs, *program.parameters)):
        inputs = place < len(program.inputs)
        member = f"{'inputs' if inputs else 'parameters'}.{signal.identifier}"
        # Not a number stands for the printed value of a parameter.
        given = "" if inputs else f"if (given[{place}] == given[{place}]) "
        taken.append(f"    {given}{member} = ({kinds[signal.kind]})given[{place}];")
    members = [f"outputs.{signal.identifier}" for signal in program.outputs]
    paths = state_paths(with_owned_state(program))
    for entry, path in zip(program.state, paths, strict=True):
        member = f"state.{'.'.join(path)}"
        members.append(f"{member}[{member}_position]" if is_ring(entry) else member)
    for place, member in enumerate(members):
        shown.append(f"    found[{place}] = (double){member};")
    driver.write_text(
        DRIVER.format(
            name=program.name, columns=len(taken), results=len(members),
            taken="\n".join(taken), shown="\n".join(shown),
        )
    )  # fmt: skip
    executable = folder / "driver"
    command = [*command, "-o", str(executable), str(driver), str(source), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return executable


def run(command: list[str], program: Program, scans: dict[str, np.ndarray]) -> np.ndarray:
    """Run a built driver over scans; returns outputs and then states [scans, q + n]."""
    signals: tuple[Signal, ...] = (*program.inputs, *program.parameters)
    count = len(next(iter(scans.values())))
    unset = np.full(count, np.nan)
    rows = np.column_stack([scans.get(signal.name, unset) for signal in signals])
    ran = subprocess.run(command, input=rows.astype(float).tobytes(), capture_output=True)
    assert ran.returncode == 0, ran.stderr.decode()
    return np.frombuffer(ran.stdout).reshape(count, -1)
