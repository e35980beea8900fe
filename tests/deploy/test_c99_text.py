"""What stands around the equations of printed C: head, comments, names, sizes, checks."""

import ctypes
import dataclasses
import re

import numpy as np
import pytest
from deployed import CompiledC
from families import PROCESSES, bare, family
from refusals import refused

from clepsydra import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import Operation
from clepsydra.program.owned_state import state_paths, with_owned_state
from clepsydra.program.program import Block, ForLoop, Program

DOUBLE = Block(1, (Operation(1, "add", (0, 0)),), (1,))
LONG = "the sum of a great many things that somebody once measured, and of some that he did not"


def normal(text: str) -> str:
    return " ".join(text.split())


def beside(lines: list[str], start: str) -> str:
    """The comment beside the line that begins so, or above it."""
    (place,) = (k for k, line in enumerate(lines) if line.strip().startswith(start))
    if "/*" in lines[place]:
        return normal(lines[place].partition("/*")[2].removesuffix("*/"))
    assert lines[place - 1].endswith("*/"), lines[place - 3 : place + 1]
    first = next(k for k in range(place - 1, -1, -1) if "/*" in lines[k])
    return normal("".join(lines[first:place]).partition("/*")[2].removesuffix("*/"))


@pytest.mark.sampled
@pytest.mark.parametrize("name", PROCESSES)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_every_number_says_its_unit_and_source(name, precision):
    ready = family(name)[1]
    printed = print_c(ready.program, origin=ready.origin, precision=precision)
    header, source = printed.header.splitlines(), printed.source.splitlines()
    # The declaration of a long type has no place to be broken at.
    assert max(len(line) for line in [*header, *source] if len(line.split()) > 2) <= 98
    step = next(k for k, line in enumerate(source) if line.startswith("void") and "_step(" in line)
    kinds = {"real": "float" if precision == "single" else "double",
             "integer": "int32_t", "boolean": "bool"}  # fmt: skip
    parts = header.index("/* State: what the next sample needs. */")
    parameters, state = header[:parts], header[parts : header.index("/* Inputs of one sample. */")]
    paths = state_paths(with_owned_state(ready.program))
    for where, declared, entries in (
        ("parameters", parameters, [(s.identifier, s) for s in ready.program.parameters]),
        ("state", state, zip(map(".".join, paths), ready.program.state, strict=True)),
    ):
        for path, entry in entries:
            signal, from_where = signal_of(entry), normal(ready.origin.source_of(entry))
            assert from_where
            unit = "truth value;" if signal.kind == "boolean" else f"[{signal.unit}]"
            ring = isinstance(entry, DelayRing) and entry.length > 1
            if "." not in path:
                end = "[" if ring else ";"
                told = beside(declared, f"{kinds[signal.kind]} {signal.identifier}{end}")
                assert signal.kind == "boolean" or told.startswith(unit)
                assert normal(signal.description) in told and told.endswith(from_where)
            # What an instance keeps is declared in its block, for all of them.
            member = f"{where}->{path}{'[i]' if ring else ''}"
            assert beside(source[:step], f"{member} = ") == f"{unit} {from_where}"


@pytest.mark.parametrize("precision", ["double", "single"])
def test_the_head_names_process_design_version_and_digest(precision):
    ready = family("PI, SIMC")[1]
    printed = print_c(ready.program, origin=ready.origin, precision=precision)
    found = re.search(r"program digest ([0-9a-f]{16})\.", printed.header)
    assert found is not None
    if precision == "double":
        assert found[1] == digest(ready.program)
    for text in (printed.header, printed.source):
        comment, _, rest = text.partition("*/")
        head = normal(re.sub(r"\n \*", " ", comment))
        assert found[0] in head and "Printed by Clepsydra " in head
        assert all(normal(line) in head for line in ready.origin.lines())
        assert "Numbers inside formulas belong to the equations of the law" in head
        assert f"Needs IEEE 754 {'doubles' if precision == 'double' else 'floats'}" in head
        assert rest.lstrip().startswith("#")


def test_without_an_origin_units_are_there_all_the_same():
    gain = Signal("gain", "V/m", initial=0.1, low=0.0, high=2.0, description=LONG)
    program = Program("law", (Signal("x", "m", initial=0.5),), (), (gain,), (), Block(2, (), (0,)))
    printed = print_c(program)
    assert "  parameters->gain = 0.1; /* [V/m] */\n" in printed.source
    assert "  state->x = 0.5; /* [m] */\n" in printed.source
    assert f"  /* [V/m] 0 to 2; {LONG.split(', and')[0]}" in printed.header


HOSTILE = 'ends */ here /* and\n#error "begins"\\\n'


def test_an_origin_cannot_leave_its_comment(tmp_path):
    program = Program(
        "law", (Signal("x"),), (), (Signal("k"),), (Signal("y"),), Block(2, (), (0, 1))
    )
    origin = Origin(HOSTILE, HOSTILE, HOSTILE, 1.0, {"k": HOSTILE}, HOSTILE)
    printed = print_c(program, origin=origin)
    for text in (printed.header, printed.source):
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        assert "ends" not in code and "begins" not in code and "*/" not in code


def every_number_changed(item):
    """Yield copies of a program, or of a part of one, each with another number."""
    if isinstance(item, float):
        yield float(np.nextafter(item, 10.0)) if np.isfinite(item) else 7.0
    elif isinstance(item, tuple):
        for place, part in enumerate(item):
            for other in every_number_changed(part):
                yield (*item[:place], other, *item[place + 1 :])
    elif dataclasses.is_dataclass(item):
        for field in dataclasses.fields(item):
            value = getattr(item, field.name)
            if isinstance(item, ForLoop | DelayRing) and field.name in ("count", "length"):
                yield dataclasses.replace(item, **{field.name: value + 1})
            elif field.compare and not isinstance(value, int | str | dict | frozenset):
                for other in every_number_changed(value):
                    yield dataclasses.replace(item, **{field.name: other})


def test_the_digest_changes_with_any_number():
    turn = Block(3, (Operation(3, "constant", (), 0.5), Operation(4, "add", (0, 3))), (4, 2))
    ring = DelayRing(Signal("late", "m", initial=0.3), 5)
    loop = ForLoop((2,), 2, turn, ((1.0, 2.0),), (0,), (), "turns", (ring,))
    block = Block(2, (loop, Operation(3, "constant", (), 1e300)), (1, 2, 3))
    state = (DelayRing(Signal("kept", "m", initial=0.1), 4),)
    outputs = (Signal("y", "m", low=0.0, high=1.0), Signal("z", "m"))
    program = Program("law", state, (), (Signal("k", "m", initial=-0.0),), outputs, block)
    others = list(every_number_changed(program))
    # Range and initial value of five signals, two lengths, a count, a table of two, and the
    # constants of three operations.
    assert len(others) == 5 * 3 + 2 + 1 + 2 + 3
    assert len({digest(program), *map(digest, others)}) == len(others) + 1


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize(
    "program",
    [
        Program("nothing", (), (), (), (), Block(0, (), ())),
        Program("flag", (Signal("a", kind="boolean"),), (), (), (), Block(1, (), (0,))),
        Program(
            "mixed",
            (Signal("a", kind="boolean"), DelayRing(Signal("b"), 3), Signal("c", kind="boolean"),
             DelayRing(Signal("d", kind="integer"), 1), Signal("e"), Signal("f", kind="boolean")),
            (), (), (), Block(6, (), tuple(range(6))),
        ),
        "Smith predictor, PI",
        "Start/stop levels",
    ],
    ids=lambda program: getattr(program, "name", program),
)  # fmt: skip
def test_the_size_of_the_state_is_that_of_the_structure(program, precision, tmp_path):
    """The declared structure's own size is compared with the compiler's when it is built."""
    program = bare(program) if isinstance(program, str) else program
    assert ctypes.sizeof(CompiledC(program, tmp_path, precision).memory) > 0


def test_rings_of_loops_count_in_the_size(tmp_path):
    body = Block(3, (), (0, 2))
    ring = DelayRing(Signal("late"), 7)
    loop = ForLoop((2,), 2, body, (), (0,), (0,), "turns", (ring,))
    state = (Signal("flag", kind="boolean"),)
    program = Program("law", state, (Signal("u"),), (), (), Block(2, (loop,), (0,)))
    for precision, size in (("double", 8 + 7 * 8 + 8), ("single", 4 + 7 * 4 + 4)):
        built = CompiledC(program, tmp_path / precision, precision)
        assert ctypes.sizeof(built.memory) == size


@pytest.mark.parametrize("value", [1e39, -1e200, 1e-39, 5e-324, -1e-60])
def test_a_constant_outside_real_is_refused_with_place_and_remedy(value):
    block = Block(1, (Operation(1, "constant", (), value), Operation(2, "add", (0, 1))), (2,))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"),), block)
    assert print_c(program).source
    with refused(place="law, a constant", expected="REAL", remedy="double precision"):
        print_c(program, precision="single")
    table = ForLoop((1,), 1, Block(2, (), (0,)), ((value,),), (0,), (), "turns")
    program = dataclasses.replace(program, block=Block(1, (table,), (1,)))
    with refused(place="law, table of turns", expected="REAL"):
        print_c(program, precision="single")
    for group in ("state", "parameters"):
        signal = Signal("x", initial=value)
        lists = {"state": (), "parameters": (), group: (signal,)}
        program = Program(
            "law", lists["state"], (), lists["parameters"], (),
            Block(1, (), (0,) if group == "state" else ()),
        )  # fmt: skip
        with refused(place="law, x", expected="REAL"):
            print_c(program, precision="single")


def test_numbers_of_float_are_written_as_floats():
    block = Block(
        1,
        (
            Operation(1, "constant", (), 0.1),
            Operation(2, "constant", (), float("inf")),
            Operation(3, "minimum", (0, 2)),
            Operation(4, "multiply", (1, 3)),
            Operation(5, "square_root", (4,)),
            Operation(6, "less", (5, 1)),
            Operation(7, "number", (6,)),
            Operation(8, "exp", (7,)),
        ),
        (5, 8),
        frozenset({6}),
    )
    program = Program("law", (), (Signal("u"),), (), (Signal("y"), Signal("z")), block)
    code = print_c(program, precision="single").source.partition("{")[2]
    assert "inputs->u < HUGE_VALF ? inputs->u : HUGE_VALF" in code and "sqrtf(0.1f * " in code
    assert "expf(" in code and "? 1.0f : 0.0f" in code
    assert "double" not in code and not re.search(r"\d\.\d+(E-?\d+)?[^f\dE]", code)


def test_a_value_that_is_named_like_a_group_leaves_the_group_unread():
    twice = Block(2, (Operation(2, "add", (0, 0)), Operation(3, "multiply", (2, 2))), (3,))
    named = Program(
        "law", (), (Signal("u"),), (Signal("k"),), (Signal("y"),), twice, {2: "parameters"}
    )
    lines = print_c(named).source.splitlines()
    assert "  const double parameters_2 = inputs->u + inputs->u;" in lines
    assert "  (void)parameters;" in lines
