"""The names that `import clepsydra` publishes: what they are, and that tools see their types."""

import importlib
import inspect
import pkgutil
import pydoc
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

import clepsydra as cl

PACKAGES = [module.name for module in pkgutil.iter_modules(cl.__path__)]


def test_no_name_is_that_of_a_package():
    """One that is would turn into that package once it is imported."""
    for name in PACKAGES:
        importlib.import_module(f"clepsydra.{name}")
    assert not set(cl.__all__) & set(PACKAGES)


@pytest.mark.parametrize("name", cl.__all__)
def test_a_published_name_has_help(name):
    thing = getattr(cl, name)
    assert inspect.getdoc(thing)
    assert getattr(cl, name) is thing


def test_names_are_listed():
    assert set(cl.__all__) <= set(dir(cl))
    shown = pydoc.plain(pydoc.render_doc(cl))
    assert all(name in shown for name in cl.__all__)
    assert "simc" in dir(cl.design) and not [name for name in dir(cl.design) if name[0] == "_"]


@pytest.mark.parametrize(
    ("owner", "name", "meant"),
    [
        (cl, "desing", "design"),
        (cl, "processes", "catalogue"),
        (cl.design, "smic", "simc"),
        (cl.design, "lambd", "lambda_"),
    ],
)
def test_an_unknown_name_is_an_attribute_error_that_says_what_was_meant(owner, name, meant):
    with pytest.raises(AttributeError) as error:
        getattr(owner, name)
    assert isinstance(error.value, cl.InputError)
    assert (
        error.value.value == name and meant in error.value.expected.split()[-1] + error.value.remedy
    )
    assert not hasattr(owner, name)


#: Each line of a user's file with the type that mypy has to find.
TYPED = [
    ('cl.load("quadruple-tank")', "clepsydra.interface.plant.Plant"),
    ("cl.design.simc(plant)", "clepsydra.interface.controller.Controller"),
    (
        'cl.design.simc(plant, closed_loop_time_constant="20 s")',
        "clepsydra.interface.controller.Controller",
    ),
    (
        'cl.design.lqi(plant, maximum_errors={"level_1": "5 %", "level_2": 0.5})',
        "clepsydra.interface.controller.Controller",
    ),
    ("cl.simulate(plant)", "clepsydra.interface.run.OpenLoopRun"),
    ("cl.simulate(plant, pi)", "clepsydra.interface.run.Run"),
    ("cl.study(plant, [pi]).best", "clepsydra.interface.study.Candidate"),
    ('cl.tune(pi, plant, goal="iae")', "clepsydra.interface.tuned.TunedController"),
    ('cl.identify("record.csv")', "clepsydra.interface.identify.Identification"),
    ("cl.verify(pi, plant).holds", "bool"),
    ("cl.step", "clepsydra.interface.events.Event"),
]
#: And lines in which it has to find a mistake.
WRONG = [
    "cl.design.smic(plant)",
    "cl.design.simc(plant, closed_loop_time=1.0)",
    "cl.design.simc(pi)",
    "cl.design.simc(plant, closed_loop_time_constant=[1.0])",
    "cl.export(pi, plant, to=3)",
    "cl.loda",
]


@pytest.mark.thorough
def test_the_types_of_the_designs_are_those_of_the_designs():
    script = Path(__file__).parents[1] / ".ci" / "design_stub.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.thorough
def test_a_type_checker_outside_sees_the_types(tmp_path):
    pytest.importorskip("mypy")
    lines = [
        "import clepsydra as cl",
        'plant = cl.load("three-tanks")',
        "pi = cl.design.simc(plant)",
    ]
    lines += [f"reveal_type({expression})" for expression, _ in TYPED] + WRONG
    file = tmp_path / "user.py"
    file.write_text("\n".join(lines) + "\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(file)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    said: dict[int, str] = defaultdict(str)
    for line in done.stdout.splitlines():
        if "user.py:" in line:
            said[int(line.split(":")[1])] += line
    for number, (_, kind) in enumerate(TYPED, start=4):
        assert "Revealed" in said[number] and kind in said[number]
    for number in range(4 + len(TYPED), 4 + len(TYPED) + len(WRONG)):
        assert ": error:" in said[number]
    assert len([line for line in said.values() if ": error:" in line]) == len(WRONG)
