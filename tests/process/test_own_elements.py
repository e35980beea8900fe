"""A user's own element, exactly as its documentation shows it, and everything wrong with one."""

import math
import os
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import casadi as ca
import numpy as np
import pytest
from pages import blocks
from refusals import refused

import clepsydra as cl
from clepsydra import InputError
from clepsydra.linear.analysis import analyse
from clepsydra.process import reader
from clepsydra.process.elements.orifice import Orifice
from clepsydra.process.own_elements import joining_own
from clepsydra.process.reader import load_process

PYTHON, TOML, *_, SHORT = (block.text for block in blocks("docs/own-element.md", "python", "toml"))
#: The same weir with methods of its own to read and to connect.
BY_HAND = (Path(__file__).parent / "own-weir.txt").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write()
    return tmp_path


def write(python: str = PYTHON, toml: str = TOML) -> None:
    Path("my_elements.py").write_text(python, encoding="utf-8")
    Path("weir-tank.toml").write_text(toml, encoding="utf-8")


def message_for(python: str = PYTHON, toml: str = TOML) -> str:
    write(python, toml)
    with pytest.raises(InputError) as caught:
        load_process("weir-tank.toml")
    message = str(caught.value)
    assert message.isprintable()
    return message


def drawing() -> str:
    cl.draw("weir-tank.toml")
    return Path("weir-tank.svg").read_text(encoding="utf-8")


def study() -> cl.Study:
    plant = cl.load("weir-tank.toml")
    return cl.study(plant, [cl.design.simc(plant)])


def flow(level: float) -> float:
    """By hand: q = 8/15 c √(2 g) (h - z)^(5/2)."""
    return 8 / 15 * 0.58 * math.sqrt(2 * 9.81) * max(level - 0.2, 0.0) ** 2.5


def test_the_flow_is_that_of_the_formula() -> None:
    process = load_process("weir-tank.toml")
    p = process.parameter_values
    for level in (0.05, 0.2, 0.201, 0.23, 0.4):
        rate = float(process.dynamics([level], [3.0], [1e-4], p))
        assert rate == pytest.approx(3.0 * 0.2e-3 + 1e-4 - flow(level), rel=1e-12)


@pytest.mark.parametrize("python", [SHORT, BY_HAND], ids=["an outlet", "by hand"])
def test_the_same_weir_written_in_other_ways(python: str) -> None:
    whole = load_process("weir-tank.toml")
    assert len([line for line in SHORT.splitlines() if line]) <= 10
    write(python)
    process = load_process("weir-tank.toml")
    if python == SHORT:
        assert process.signal("weir_1.tip").initial == whole.signal("weir_1.tip").initial
    for level in (0.05, 0.2, 0.201, 0.23, 0.4):
        rate = float(process.dynamics([level], [3.0], [1e-4], process.parameter_values))
        assert rate == pytest.approx(3.0 * 0.2e-3 + 1e-4 - flow(level), rel=1e-12)
    assert [s.name for s in process.state] == [s.name for s in whole.state]
    assert study().ranking


def test_the_operating_point_and_its_time_constant() -> None:
    analysis = analyse(load_process("weir-tank.toml"))
    above = (1e-3 / flow(1.2)) ** 0.4  # flow(1.2) is the flow at one metre above the tip
    assert analysis.operating_point.as_dict()["tank_1.level"] == pytest.approx(0.2 + above)
    (pole,) = analysis.model.A.ravel()
    assert pole == pytest.approx(-2.5 * 1e-3 / above, rel=1e-6)  # 1 m² of surface


def test_a_study_and_a_drawing() -> None:
    best = study().best
    assert best.rank == 1
    assert best.maximum_sensitivity < 2.0
    levels = best.run.values["tank_1.level"]
    assert np.all((levels > 0.2) & (levels < 0.4))
    texts = ["".join(e.itertext()) for e in ElementTree.fromstring(drawing()).iter() if e.text]
    assert "weir_1" in " ".join(texts)


def test_an_idiom_that_vanishes_is_a_warning_of_the_process() -> None:
    write(PYTHON.replace("driver = above * above", "driver = ca.sqrt(above)**2 * above"))
    (warning,) = load_process("weir-tank.toml").warnings
    line = PYTHON[: PYTHON.index("driver = above")].count("\n") + 1
    assert warning.startswith(f"my_elements.py, line {line}, ca.sqrt(above) ** 2: it becomes above")
    write()
    assert load_process("weir-tank.toml").warnings == ()


def test_every_symbol_can_be_drawn() -> None:
    """A class may choose any symbol, or none; each drawing is proper XML with its name."""
    for symbol in ("box", "valve", "flow", "pump", "delay", "nothing of the sort"):
        write(PYTHON.replace('"v_notch_weirs", "orifice"', f'"v_notch_weirs", "{symbol}"'))
        assert ElementTree.fromstring(drawing()).tag.endswith("svg")
        assert "weir_1" in drawing()


def test_an_own_element_with_state_input_and_measurement(simulate) -> None:
    """A gate whose opening follows its input with a lag of 5 s, and a meter of its opening."""
    write(
        """
from dataclasses import dataclass
from clepsydra import Connection, Element, Flow, Signal

@dataclass(frozen=True)
class Gate(Element):
    kind, table, keys = "gate", "gates", ("source", "destination", "nominal", "tag")
    source: str
    destination: str

    @classmethod
    def read(cls, name, table):
        return cls(name, table.name("source", "a tank"), table.name("destination", "a basin"))

    def connections(self):
        yield Connection(("source",), self.source, "tank")
        yield Connection(("destination",), self.destination, "receiver")

    def states(self):
        return (Signal(f"{self.name}.opening", low=0.0, high=1.0, initial=0.5),)

    def inputs(self):
        return (Signal(self.name, low=0.0, high=1.0, initial=0.5),)

    def parameters(self):
        return (Signal(f"{self.name}.lag", "s", initial=5.0),)

    def rates(self, symbols, received, given):
        name = f"{self.name}.opening"
        return {name: (symbols[self.name] - symbols[name]) / symbols[f"{self.name}.lag"]}

    def flows(self, symbols, received):
        driver = symbols[f"{self.source}.level"] * symbols[f"{self.name}.opening"]
        return [Flow(self.source, self.destination, 1e-3 / symbols[f"{self.name}.lag"], driver)]
""",
        TOML.replace("[v_notch_weirs.weir_1]", "[gates.gate_1]").replace(
            'tip = "20 cm"', 'nominal = 0.5\ntag = "XV201"'
        ),
    )
    process = load_process("weir-tank.toml")
    assert [s.name for s in process.inputs] == ["pump_1", "gate_1"]
    assert process.tags == {"gate_1": "XV201"}
    course = simulate(
        process.elements,
        {"tank_1.level": 0.3, "gate_1.opening": 0.0},
        [0.0, 1.0],
        step=0.5,
        steps=20,
        disturbances=[0.0],
    )
    assert course["gate_1.opening"] == pytest.approx(1 - np.exp(-course.time / 5), rel=1e-5)
    # dh/dt = - k h s, so ln(h/h0) = - k ∫ s dt with k = 1e-3/5 for 1 m² of surface.
    run = course.time - 5 * (1 - np.exp(-course.time / 5))
    assert course["tank_1.level"] == pytest.approx(0.3 * np.exp(-2e-4 * run), rel=1e-9)


def test_read_twice_the_classes_are_the_same() -> None:
    first, second = load_process("weir-tank.toml"), load_process("weir-tank.toml")
    assert first.elements == second.elements
    assert first.elements[-1].tip == 0.2
    write(PYTHON.replace("0.58", "0.29"))
    third = load_process("weir-tank.toml")
    p = first.parameter_values
    fast, slow = (float(q.dynamics([0.3], [0.0], [0.0], p)) for q in (first, third))
    assert fast == pytest.approx(2 * slow, rel=1e-12)


def test_helper_classes_are_no_elements() -> None:
    """What is imported, what is no element and a base without `read` are left alone."""
    base = "class Outlet(Element):\n    pass\n\nclass Number:\n    pass\n\n"
    python = PYTHON.replace(
        "\n@dataclass", f"\nfrom clepsydra.process.elements.pump import Pump\n{base}\n@dataclass"
    )
    write(python.replace("class VNotchWeir(Element)", "class VNotchWeir(Outlet)"))
    assert load_process("weir-tank.toml").elements[-1].name == "weir_1"


def test_without_the_key_nothing_is_run() -> None:
    write("raise SystemExit(7)", TOML.replace('elements = "my_elements.py"\n', ""))
    with refused(place="line 11, v_notch_weirs", value="v_notch_weirs"):
        load_process("weir-tank.toml")


WRONG = tomllib.loads((Path(__file__).parent / "wrong_own_elements.toml").read_text("utf-8"))


@pytest.mark.parametrize("edit", WRONG["file"], ids=lambda edit: edit["by"][:40])
def test_a_wrong_process_file(edit: dict[str, str]) -> None:
    assert TOML.count(edit["replace"]) == 1
    Path("folder.py").mkdir()
    Path("loop.py").symlink_to("loop.py")
    Path("link.py").symlink_to(os.__file__)
    assert message_for(toml=TOML.replace(edit["replace"], edit["by"])) == edit["message"]


@pytest.mark.parametrize("edit", WRONG["code"], ids=lambda edit: edit["by"][:40])
def test_wrong_code(edit: dict[str, str]) -> None:
    assert BY_HAND.count(edit["replace"]) == 1
    assert message_for(BY_HAND.replace(edit["replace"], edit["by"])) == edit["message"]


@pytest.mark.parametrize("content", [b"x = 1\0", b"\xff\xfe", b"# coding: nonsense\nx = 1", b""])
def test_what_is_no_python(content: bytes) -> None:
    Path("my_elements.py").write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_process("weir-tank.toml")
    assert ("expected Python that runs" if content else "defines an element") in str(caught.value)


def test_two_classes_with_one_table() -> None:
    python = PYTHON + "\n@dataclass(frozen=True)\nclass Second(VNotchWeir):\n    pass\n"
    assert message_for(python) == (
        "my_elements.py, class Second.table: got 'v_notch_weirs', expected a table that process "
        "files do not have yet; choose another name for the table."
    )


def test_a_file_of_the_catalogue_runs_no_python(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "catalogue_file", lambda name: Path("weir-tank.toml"))
    with pytest.raises(InputError) as caught:
        load_process("quadruple-tank")
    assert str(caught.value) == (
        "weir-tank.toml, line 4, elements: got 'my_elements.py', expected no Python file in the "
        "catalogue; copy the file first."
    )


def test_a_failure_of_our_own_is_not_blamed_on_the_user() -> None:
    with pytest.raises(ZeroDivisionError), joining_own((), None):
        raise ZeroDivisionError


def test_published_names_are_those_of_the_elements() -> None:
    assert issubclass(Orifice, cl.Element)
    flow = cl.Flow("a", "b", ca.SX(2), ca.SX(3))
    assert float(flow.rate) == 6.0
    assert cl.Connection(("source",), "tank_1", "tank").carries_flow
