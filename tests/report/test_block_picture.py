"""The picture of a program's blocks: what is wired to what, and that it can be read."""

import itertools
import re
from xml.etree import ElementTree

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.program.operation import Operation
from clepsydra.program.owned_state import with_owned_state
from clepsydra.program.program import Block, Call, Program
from clepsydra.report.drawing.block_diagram import diagram
from clepsydra.report.drawing.block_picture import block_svg, program_svg

SMALLEST = 6.5
CONTROLLERS = ("PI, SIMC", "PI, SIMC, dynamic decoupling", "LQI with Kalman filter", "cascade")


def signals(*names, kind="real"):
    return tuple(cl.Signal(name, kind=kind) for name in names)


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    path = tmp_path_factory.mktemp("cascade") / "study.toml"
    path.write_text(flow_cascade(duration="1 min", at="10 s", by="2 %"), encoding="utf-8")
    plant = cl.load("quadruple-tank")
    found = {
        "PI, SIMC": cl.design.simc(plant),
        "PI, SIMC, dynamic decoupling": cl.design.simc(plant, decoupling="dynamic"),
        "LQI with Kalman filter": cl.design.lqi_kalman(plant),
        "cascade": cl.study(path).best.controller,
    }
    return {
        name: with_owned_state(with_plant_shell(controller, 1.0).program())
        for name, controller in found.items()
    }


def shapes(svg, tag):
    return ElementTree.fromstring(svg).iter(f"{{http://www.w3.org/2000/svg}}{tag}")


def words(svg):
    """Return each text with its rectangle, of letters half as wide as they are high."""
    found = []
    for text in shapes(svg, "text"):
        size = float(text.get("font-size", 7.5))
        x, y, width = float(text.get("x")), float(text.get("y")), 0.5 * size * len(text.text)
        left = x - width if text.get("text-anchor") == "end" else x
        found.append((text.text, (left, left + width, y - 0.7 * size, y)))
    return found


def segments(svg):
    """Return the straight lines of all wires as (left, right, top, bottom)."""
    for path in shapes(svg, "path"):
        if path.get("stroke") in ("#1f2328", "#59636e"):
            for x, y, way, end in re.findall(r"M(\S+) ([\d.]+)([HV])([\d.]+)", path.get("d")):
                (x, y, end) = float(x), float(y), float(end)
                a, b = ((x, end), (y, y)) if way == "H" else ((x, x), (y, end))
                yield (*sorted(a), *sorted(b))


def meet(one, other):
    return one[0] < other[1] and other[0] < one[1] and one[2] < other[3] and other[2] < one[3]


def test_wires_names_and_operations_of_a_small_program():
    """y = 2 (a + b) is told to a second block as it is, and its double through an operation."""
    real, truth = signals("y"), signals("sound", kind="boolean")
    add = Block(2, (Operation(2, "add", (0, 1)), Operation(3, "constant", (), 1.0)), (2, 3))
    first = Program("first", (), signals("a", "b"), (), real + truth, add)
    ends = Block(3, (Operation(3, "add", (0, 1)),), (3,))
    second = Program("second", (), signals("u", "v", "gain"), (), signals("z"), ends)
    calls = Block(
        3,
        (
            Call((3, 4), first, "one", (0, 1)),
            Operation(5, "multiply", (3, 1)),
            Call((6,), second, "two", (3, 5, 2)),
        ),
        (6,),
    )
    law = Program("law", (), signals("a", "b"), signals("K"), signals("out"), calls)
    one, two = diagram(law)
    (y,) = one.outputs  # nothing reads whether it is sound
    assert [(p.name, p.names, p.wires, p.computed) for p in two.inputs] == [
        ("u", [], [y], False),
        ("v", ["b"], [y], True),
    ]
    assert (two.settings, two.outputs[0].names, one.column, two.column) == (1, ["out"], 0, 1)


#: Blocks that read nothing but parameters.
JUDGING = {"parameter_check", "limits_check", "range_check"}


@pytest.mark.parametrize("name", CONTROLLERS)
def test_every_port_of_every_call_is_drawn_or_counted(programs, name):
    program = programs[name]
    boxes = {box.title: box for box in diagram(program) if box.kind}
    # A parameter that is judged is drawn as the parameter.
    calls = [call for call in program.calls if call.program.name not in JUDGING]
    assert list(boxes) == [call.identifier for call in calls] and len(calls) < len(program.calls)
    for call in calls:
        box, block = boxes[call.identifier], call.program
        shown = [port.name for port in box.inputs]
        assert all(port.wires or port.names for port in box.inputs)
        # The rest are constants: the values of a cold start, and what follows from the parameters.
        left = {signal.identifier for signal in block.inputs} - set(shown)
        constants = {n for n in left if n.startswith("start_")} | ({"restart"} & left)
        assert len(left - constants - {"longest_delay", "lowest", "highest"}) <= box.settings
    wires = [(w, p) for box in boxes.values() for p in box.inputs for w in p.wires]
    assert all((w.box, w.real) < (p.box, True) for w, p in wires) and len(wires) > 10


@pytest.mark.parametrize("name", CONTROLLERS)
def test_nothing_hides_anything_else(programs, name):
    svg = program_svg(programs[name], name)
    whole, *frames = [
        (x, x + w, y, y + h)
        for x, y, w, h in (
            [float(rect.get(key)) for key in ("x", "y", "width", "height")]
            for rect in shapes(svg, "rect")
        )
    ]
    assert all(not meet(*pair) for pair in itertools.combinations(frames, 2))
    texts = words(svg)
    for (one, at), (other, there) in itertools.combinations(texts, 2):
        assert not meet(at, there), (one, other)
    for text, (left, right, top, bottom) in texts:
        assert whole[0] <= left and right <= whole[1] and top >= whole[2] and bottom <= whole[3]
        assert all(
            inside[0] <= left and right <= inside[1]
            for inside in frames
            if meet((left, right, top, bottom), inside)
        ), text
    for line in segments(svg):
        # Lines end at boxes; within one by more than their width they would cross it.
        thick = (line[0] + 0.2, line[1] - 0.2, line[2] + 0.2, line[3] - 0.2)
        thick = tuple(sorted(thick[:2])) + tuple(sorted(thick[2:]))
        assert not any(meet(thick, frame) for frame in frames)


def test_a_picture_repeats_and_escapes_its_words(programs):
    program = programs["PI, SIMC"]
    assert program_svg(program, "x") == program_svg(program, "x")
    block = program.calls[0].program
    found = block_svg(block, "<one>")
    assert "&lt;one&gt;" in found
    drawn = {text for text, _ in words(found)}
    assert {signal.name for signal in (*block.inputs, *block.outputs)} < drawn
