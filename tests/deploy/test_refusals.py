"""What a printer refuses, and what it writes around the equations."""

import dataclasses
import subprocess

import numpy as np
import pytest
from deployed import run_both
from refusals import refused
from tools import need_compiler, need_grammar

from clepsydra import InputError, PidForm, Signal, program_of
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.defaults import with_defaults
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, ForLoop, Program

DOUBLE = Block(1, (Operation(1, "add", (0, 0)),), (1,))


def doubling(entry: Signal, output: Signal, block: Block = DOUBLE) -> Program:
    return Program("law", (), (entry,), (), (output,), block)


@pytest.mark.parametrize("name", ["2nd", "level__1", "level_", "pegel_ö", "a-b", ""])
@pytest.mark.parametrize("printer", [print_c, print_structured_text])
def test_names_that_are_no_identifiers(printer, name):
    with refused(expected="an identifier of"):
        printer(doubling(Signal(name), Signal("y")))


@pytest.mark.parametrize(
    ("printer", "word", "accepted_by"),
    [
        (print_c, "double", print_structured_text),
        (print_c, "register", print_structured_text),
        (print_structured_text, "Limit", print_c),
        (print_structured_text, "by", print_c),
        (print_structured_text, "Lreal", print_c),
    ],
)
def test_words_of_one_language_are_names_in_the_other(printer, word, accepted_by):
    with pytest.raises(InputError, match=f"law, {word}: got '{word}', expected a name that is no"):
        printer(doubling(Signal(word), Signal("y")))
    accepted_by(doubling(Signal(word), Signal("y")))


def test_names_that_become_one():
    both = Block(2, (), (0, 1))
    outputs = (Signal("y"), Signal("z"))
    dotted = Program("law", (), (Signal("tank.level"), Signal("tank_level")), (), outputs, both)
    for printer in (print_c, print_structured_text):
        with refused(value="tank_level", expected="a name that differs"):
            printer(dotted)
    cases = Program("law", (), (Signal("Level"), Signal("level")), (), outputs, both)
    print_c(cases)
    with refused(expected="differs in Structured Text from program law, Level"):
        print_structured_text(cases)
    ring = DelayRing(Signal("late"), 3)
    clash = Program("law", (ring, Signal("late_position")), (), (), (), both)
    for printer in (print_c, print_structured_text):
        with refused(place="late_position"):
            printer(clash)


def test_an_output_named_like_an_input_is_printed_as_c_only():
    program = doubling(Signal("level"), Signal("level"))
    assert "outputs->level = inputs->level + inputs->level;" in print_c(program).source
    with refused(remedy="rename one"):
        print_structured_text(program)


def test_fused_operations_are_refused():
    fused = Block(1, (Operation(1, "multiply", (0, 0), fused=True),), (1,))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"),), fused)
    for printer in (print_c, print_structured_text):
        with refused(value="a fused multiply"):
            printer(program)


@pytest.mark.parametrize("printer", [print_c, print_structured_text])
def test_what_is_no_program_is_refused_with_the_way_to_one(printer):
    for value in (
        None,
        multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration")),
    ):
        with refused(expected="a Program", remedy="give controller.program(), or"):
            printer(value)


def test_functions_of_the_standard_only():
    root = Block(1, (Operation(1, "tanh", (0,)),), (1,))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"),), root)
    assert "tanh(inputs->u)" in print_c(program).source
    with refused(place="operation tanh"):
        print_structured_text(program)


@pytest.mark.parametrize(
    ("kind", "message"),
    [("integer", "a whole number of at most 32 bits"), ("boolean", "expected 0 or 1")],
)
def test_results_that_may_not_fit_their_type(kind, message):
    for source in ("real", "integer"):
        program = doubling(Signal("u", kind=source), Signal("y", kind=kind))
        for printer in (print_c, print_structured_text):
            with pytest.raises(InputError, match=message):
                printer(program)


@pytest.mark.parametrize(
    ("kind", "initial"), [("integer", 0.5), ("integer", 2.0**31), ("boolean", 2.0),
                          ("integer", float("nan")), ("boolean", float("inf"))]
)  # fmt: skip
def test_initial_values_of_another_type(kind, initial):
    for printer in (print_c, print_structured_text):
        with refused(place="initial value of u"):
            printer(doubling(Signal("u", kind=kind, initial=initial), Signal("y")))


def test_infinite_defaults_are_for_c_only():
    endless = Signal("u", initial=-float("inf"))
    program = Program("law", (), (), (endless,), (Signal("y"),), DOUBLE)
    assert "parameters->u = -HUGE_VAL;" in print_c(program).source
    with refused(expected="Structured Text can write"):
        print_structured_text(program)


def test_default_values():
    program = program_of(
        multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration"))
    )
    designed = with_defaults(program, {"level_1.proportional_gain": 0.1, "pump_1.last_output": 3.0})
    assert "parameters->level_1_proportional_gain = 0.1;" in print_c(designed).source
    assert "state->pump_1_last_output = 3.0;" in print_c(designed).source
    text = print_structured_text(designed)
    assert "  level_1_proportional_gain : LREAL := 0.1;" in text
    assert "  pump_1_last_output : LREAL := 3.0;" in text
    with refused(place="multiloop_pi, gain_1", value=1.0, expected="a value for"):
        with_defaults(program, {"gain_1": 1.0})


def test_the_digest_tells_programs_apart():
    program = program_of(
        multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration"))
    )
    assert digest(program) == digest(
        program_of(
            multiloop_pid_law(
                ["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration")
            )
        )
    )
    others = [
        program_of(multiloop_pid_law(["level_1"], ["pump_1"])),
        program_of(
            multiloop_pid_law(
                ["level_1", "level_2"],
                ["pump_1", "pump_2"],
                PidForm(anti_windup="conditional_integration"),
            )
        ),
        with_defaults(program, {"level_1.proportional_gain": 1.0000000000000002}),
    ]
    assert len({digest(program), *map(digest, others)}) == 4
    for text in (print_c(program).header, print_c(program).source, print_structured_text(program)):
        assert digest(program) in text and "Clepsydra" in text.splitlines()[1]


def test_the_digest_covers_names_and_groups():
    """Equal digests mean equal text, so whatever shows in the text is part of it."""
    program = program_of(
        multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration"))
    )
    value = next(value for value, name in program.names.items() if name == "level_1.unlimited")
    renamed = dataclasses.replace(program, names=program.names | {value: "wanted_1"})
    *inputs, last = program.inputs
    moved = dataclasses.replace(
        program, inputs=tuple(inputs), parameters=(last, *program.parameters)
    )
    turn = Block(2, (Operation(2, "add", (0, 1)),), (2,))
    loops = [
        doubling(Signal("u"), Signal("y"), block=Block(1, (loop,), (1,)))
        for loop in (ForLoop((1,), 3, turn, ((1.0, 2.0, 3.0),), (0,), (), name) for name in "ab")
    ]
    for one, other in ((program, renamed), (program, moved), loops):
        assert print_structured_text(one) != print_structured_text(other)
        assert print_c(one) != print_c(other)
        assert digest(one) != digest(other)


def test_the_law_keeps_its_own_names():
    program = program_of(
        multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup="conditional_integration"))
    )
    for text in (print_c(program).source, print_structured_text(program)):
        for name in ("level_1_error", "level_1_unlimited", "pump_1_out"):
            assert f"{name} =" in text or f"{name} :=" in text or f"{name} =\n" in text
        assert "level_1_good" in text and "<> 0.0" not in text and "!= 0.0" not in text
    assert max(map(len, print_c(program).source.splitlines())) <= 100
    assert max(map(len, print_structured_text(program).splitlines())) <= 100


HOSTILE = "ends */ here *) and /* begins (* again\nnext line ?" * 3


def test_descriptions_cannot_leave_their_comment(tmp_path):
    program = dataclasses.replace(
        doubling(Signal("u", "m^3/s", description=HOSTILE), Signal("y", description=HOSTILE)),
        state=(DelayRing(Signal("late", description=HOSTILE), 3),),
        block=Block(2, (Operation(2, "add", (0, 1)),), (1, 2)),
    )
    need_grammar()
    from clepsydra.deploy.proof.text.interpreter import function_block

    block = function_block(print_structured_text(program))
    assert set(block.declared) == {"u", "y", "late", "late_position"}
    compile_strictly(program, tmp_path, "-std=c99")


def test_laws_without_any_of_their_parts_compile(tmp_path):
    nothing = Block(0, (), ())
    constant = Block(1, (Operation(1, "constant", (), 2.5),), (1,))
    programs = [
        Program("nothing", (), (), (), (), nothing),
        Program("unread", (), (Signal("u"),), (), (Signal("y"),), constant),
        Program("kept", (Signal("x"),), (), (), (), Block(1, (), (0,))),
        Program("state", (Signal("state"),), (Signal("inputs"),), (), (), Block(2, (), (1,))),
    ]
    for program in programs:
        compile_strictly(program, tmp_path, "-std=c99")


def test_values_that_nothing_reads_leave_no_variable(tmp_path):
    body = Block(
        4,
        (
            Operation(4, "add", (1, 0)),
            Operation(5, "multiply", (2, 0)),
            Operation(6, "multiply", (5, 5)),
            Operation(7, "square_root", (0,)),
        ),
        (4, 6, 7),
    )
    start = Operation(1, "square_root", (0,))
    loop = ForLoop((2, 3, 4), 2, body, ((1.0, 10.0),), (0, 1, 0), (), "sum_up")
    unread = Operation(5, "multiply", (1, 1))
    block = Block(1, (start, loop, unread), (2,))
    program = Program("law", (), (Signal("u"),), (), (Signal("y"),), block)
    source = print_c(program).source
    # The second carried value feeds itself only, and the third is read by nothing.
    assert "outputs->y = outputs->y + sum_up_table[i];" in source and "sum_up_value" not in source
    compile_strictly(program, tmp_path, "-std=c99")
    for table in run_both(program, tmp_path, {"u": np.array([0.5])}):
        assert table.tolist() == [[11.5]]


def test_the_header_serves_cpp(tmp_path):
    compiler, empty = need_compiler(), tmp_path / "empty.cpp"
    empty.write_text("")
    check = [compiler, "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    if subprocess.run([*check, str(empty)], capture_output=True).returncode != 0:
        pytest.skip("the C compiler has no C++")
    compile_strictly(
        program_of(
            multiloop_pid_law(
                ["level_1", "level_2"],
                ["pump_1", "pump_2"],
                PidForm(anti_windup="conditional_integration"),
            )
        ),
        tmp_path,
        "-std=c11",
    )
    user = tmp_path / "user.cpp"
    user.write_text(
        '#include "multiloop_pi.h"\n'
        "void run(multiloop_pi_state &state) { multiloop_pi_initialise(&state); }\n"
    )
    built = subprocess.run([*check, str(user)], capture_output=True, text=True)
    assert built.returncode == 0, built.stderr


def compile_strictly(program: Program, folder, standard: str) -> None:
    printed = print_c(program)
    (folder / printed.header_name).write_text(printed.header, encoding="utf-8")
    source = folder / printed.source_name
    source.write_text(printed.source, encoding="utf-8")
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Wshadow", "-Werror"]
    built = subprocess.run(
        [need_compiler(), standard, *warnings, "-fsyntax-only", str(source)],
        capture_output=True,
        text=True,
    )
    assert built.returncode == 0, built.stderr
