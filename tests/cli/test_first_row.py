"""What a first row may load: nothing that the rules in front of a study do without."""

import json
import subprocess
import sys

import pytest

from clepsydra.designs.design import DESIGNS

#: What takes a tenth of a second or more to load, and no plain rule needs.
HEAVY = (
    "control", "jinja2", "matplotlib", "pandas", "pint", "pyarrow", "rich", "scipy.fft",
    "scipy.integrate", "scipy.interpolate", "scipy.optimize", "scipy.signal", "scipy.sparse",
    "scipy.special", "scipy.stats", "sympy", "xarray",
)  # fmt: skip
#: The packages of Clepsydra, or parts of them, that come after the first rows.
LATER = (
    "controllers.fuzzy", "controllers.observers", "deploy.proof", "deploy.printing",
    "designs.loop_shaping", "designs.polynomial", "designs.regulators", "designs.states",
    "identification", "papers", "report.drawing", "report.html", "report.study_answer",
    "studies.tuning.tune", "studies.file.reader",
)  # fmt: skip
PLAIN = {
    "PI, AMIGO", "PI, SIMC", "PI, SIMC, dynamic decoupling", "PI, SIMC, static decoupling",
    "PI, Tyreus-Luyben", "PI, Ziegler-Nichols", "PI, arrest time", "PI, lambda", "PI, phase margin",
    "PI, variable structure",
}  # fmt: skip

#: A study whose standard error tells what is loaded with each row, until one needs states.
COMMAND = """
import json, sys
told = []
class Told:
    isatty = fileno = lambda self: False
    flush = lambda self: None
    def write(self, text):
        name, said, _ = text.partition(": ")
        if name in ("PI, gain scheduling", "PID, phase margin"):
            print(json.dumps(told), flush=True)
            sys.exit()
        if said:
            told.append((name, sorted(sys.modules)))
sys.stderr = Told()
sys.argv[1:] = ["study", sys.argv[1], "--output", sys.argv[2]]
from clepsydra.cli import main
main()
"""
#: One design asked for by its name.
DESIGN = """
import json, sys
import clepsydra as cl
getattr(cl.design, sys.argv[1])
print(json.dumps([(sys.argv[1], sorted(sys.modules))]))
"""
#: A design made, of the plainest rule: its modules are counted.
MADE = """
import json, sys
import clepsydra as cl
cl.design.simc(cl.load("quadruple-tank"))
print(json.dumps([("simc", sorted(sys.modules))]))
"""
#: So many modules of Clepsydra it may load: decision 0049 says what they are.
MOST = 245


def rows_of(script, *arguments):
    """Return the name of each row with the modules that are loaded when it is told."""
    command = [sys.executable, "-c", script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def unwanted(modules):
    later = tuple(f"clepsydra.{part}." for part in LATER)
    return [name for name in modules if name in HEAVY or f"{name}.".startswith(later)]


@pytest.mark.parametrize("process", ["quadruple-tank", "equalisation-tank", "wet-well"])
def test_plain_rules_are_printed_before_anything_heavy_is_loaded(process, tmp_path):
    rows = rows_of(COMMAND, process, tmp_path)
    assert {"PI, SIMC", "PI, AMIGO"} <= {name for name, _ in rows} <= PLAIN
    for name, modules in rows:
        assert not unwanted(modules), name


@pytest.mark.parametrize("name", ["simc", "amigo", "lqi", "fuzzy_pi"])
def test_a_design_loads_its_own_file_and_not_that_of_every_design(name):
    ((_, modules),) = rows_of(DESIGN, name)
    files = {each.function.__module__ for each in DESIGNS.values()}
    own = DESIGNS[name].function.__module__
    assert own in modules
    assert len((files - {own}) & set(modules)) <= 2  # one may begin with what another found


def test_a_design_that_is_made_loads_a_third_of_the_house_at_most():
    ((_, modules),) = rows_of(MADE)
    loaded = [name for name in modules if name.partition(".")[0] == "clepsydra"]
    assert len(loaded) <= MOST
    assert not unwanted(modules)
    assert not [name for name in loaded if name.startswith("clepsydra.program.reader")]
