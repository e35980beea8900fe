"""Outputs that are members of one structure, in every language and in what reads it back."""

from xml.etree import ElementTree

import numpy as np
import pytest
from structured_text_programs import plcopen_of
from tools import need_grammar

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.proof.compiled_c import CompiledC
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.block import Block
from clepsydra.program.reader import structured_program_of
from clepsydra.program.step_law import Equations, step_law


def told(owner):
    path = f"{owner}.told" if owner else "told"
    return (
        Signal(f"{path}.late", kind="boolean", high=1.0, low=0.0, record="what_is_told",
               description="it comes late"),
        Signal(f"{path}.sum", "V", record="what_is_told"),
    )  # fmt: skip


TOTAL = Block(
    "total", (Signal("u"),), (Signal("kept"),), (*told(""), Signal("y")),
    lambda s: Equations(
        {"kept": s["kept"] + s["u"]},
        {"told.late": s["kept"] > 2, "told.sum": s["kept"] + s["u"], "y": 2 * s["u"]},
    ),
)  # fmt: skip


def _written(s):
    """The first structure is a copy of its block's, the second is not: it turns a sign."""
    first, second = (
        TOTAL(f"of_{u}", {"u": s[u]}, {"kept": s[f"{u}.kept"]}) for u in ("first", "second")
    )
    outputs = {f"first.{name}": value for name, value in first.outputs.items()}
    outputs |= {f"second.{name}": value for name, value in second.outputs.items()}
    outputs["second.told.sum"] = -outputs["second.told.sum"]
    return Equations({"first.kept": first.next_state["kept"],
                      "second.kept": second.next_state["kept"]}, outputs)  # fmt: skip


def law():
    return step_law(
        "two_totals",
        inputs=[Signal("first"), Signal("second")],
        parameters=[],
        state=[Signal("first.kept"), Signal("second.kept")],
        outputs=[*told("first"), Signal("first.y"), *told("second"), Signal("second.y")],
        equations=_written,
    )


def test_a_structure_is_declared_once_and_copied_as_a_whole():
    text = print_structured_text(structured_program_of(law()))
    assert text.count("TYPE ST_WhatIsTold :") == 1
    assert "\n  first_told, second_told : ST_WhatIsTold;\n" in text
    assert "told => first_told" in text and "told => second_told" not in text
    assert "second_told.sum := -of_second.told.sum;" in text
    assert "told.late := kept > 2.0;" in text
    scl = print_structured_text(structured_program_of(law()), dialect="scl")
    assert 'TYPE "ST_WhatIsTold"\n' in scl and "told => #first_told" in scl


def test_c_has_the_structure_inside_that_of_the_outputs():
    printed = print_c(structured_program_of(law()))
    assert "  two_totals_what_is_told first_told;" in printed.header
    assert "outputs->first_told = of_first.told;" in printed.source


def test_plcopen_declares_a_data_type():
    root = ElementTree.fromstring(plcopen_of(structured_program_of(law())))
    space = {"p": root.tag[1:].partition("}")[0]}
    (kind,) = root.findall(".//p:dataTypes/p:dataType", space)
    assert kind.get("name") == "ST_WhatIsTold"
    members = kind.findall(".//p:struct/p:variable", space)
    assert [each.get("name") for each in members] == ["late", "sum"]
    derived = root.findall(".//p:outputVars//p:derived", space)
    assert [each.get("name") for each in derived] == ["ST_WhatIsTold"] * 3


@pytest.mark.parametrize("target", ["codesys", "scl", "c"])
def test_every_member_has_the_bits_of_the_engine(target, tmp_path):
    program = structured_program_of(law())
    random = np.random.default_rng(3)
    inputs = {name: random.normal(0.5, 1.0, 50) for name in ("first", "second")}
    expected = engine_run(program, inputs)
    if target == "c":
        found = CompiledC(program, tmp_path).run(inputs)
    else:
        need_grammar()
        found = InterpretedText(program, dialect=target).run(inputs)
    np.testing.assert_array_equal(found, expected)
    assert {0.0, 1.0} == set(expected[:, 0]) and len(set(expected[:, 4])) == 50


def test_structures_of_one_type_with_other_members_are_refused():
    base = law()
    wrong = step_law(
        base.name, inputs=base.inputs, parameters=[], state=base.state,
        outputs=[*base.outputs[:1], *base.outputs[2:]],
        equations=lambda s: Equations((found := _written(s)).next_state, {
            name: value for name, value in found.outputs.items() if name != "first.told.sum"}),
    )  # fmt: skip
    with pytest.raises(ValueError, match="other members than its type"):
        print_structured_text(structured_program_of(wrong))
