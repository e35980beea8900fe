"""The printed test project: a controller at work on the simulated process, as in the engine."""

import dataclasses
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from deployed import files_of
from plants import designed, plant, tagged
from refusals import refused
from tools import need

import clepsydra as cl
from clepsydra import InputError, Signal
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.text.interpreter import StructuredText
from clepsydra.deploy.proof.text.scl import standard_text
from clepsydra.deploy.structured_text.project import Project, print_test_project, wired
from clepsydra.deploy.structured_text.time_literal import LONGEST, milliseconds, time_literal
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

SCANS, SUBSTEPS = 240, 2
FACTOR = 1.05


@cache
def controlled():
    """PI in its plant shell, and the programs of controller and quadruple tank."""
    controller = with_plant_shell(designed("simc", "quadruple-tank"), 1.0)
    process = process_program(plant("quadruple-tank").point, SUBSTEPS)
    return controller, dataclasses.replace(controller.program(), name="tank_pi"), process


def project(dialect="matiec", precision="double", period=1.0):
    """A quadruple tank under PI in its plant shell; the wires as the loop has them."""
    controller, law, process = controlled()
    wires = controller.input_wires | controller.output_wires
    made = Project(law, process, wires, period, dialect=dialect, precision=precision)
    text = print_test_project(made)
    return plant("quadruple-tank").analysis, controller, text


def run_in_text(text: str, step: dict[str, float]) -> dict[str, np.ndarray]:
    """Run the program; after a third of the scans an engineer sets what `step` says."""
    program = StructuredText(text).instance("tank_pi_test")
    seen = ("level_1", "level_2", "pump_1_out", "pump_2_out", "pump_1_status", "watchdog")
    rows = []
    for scan in range(SCANS):
        if scan == SCANS // 3:
            program.state.update(step)
        program.run()
        rows.append([float(program.state[name]) for name in seen])
    return dict(zip(seen, np.array(rows).T, strict=True))


def test_it_moves_as_the_loop_of_the_engine():
    need("tree_sitter_iec61131_3_st")
    analysis, controller, text = project()
    at = analysis.operating_point.as_dict()
    found = run_in_text(text, {"level_1_sp": FACTOR * at["level_1"], "inflow_2": 2.0})
    process, late = analysis.operating_point.process, slice(SCANS // 3, None)
    setpoints = np.tile([at["level_1"], at["level_2"]], (SCANS, 1))
    disturbances = np.tile([at[signal.name] for signal in process.disturbances], (SCANS, 1))
    setpoints[late, 0] *= FACTOR
    disturbances[late, 1] = 2e-6
    noise = np.zeros((SCANS, len(process.measurements)))
    scenario = Scenario(1.0, setpoints, disturbances, noise, (), seed=1)
    run = Loop(controller, analysis.model).run(scenario, substeps=SUBSTEPS)
    for number in (1, 2):
        expected = run.values[f"pump_{number}"]
        assert np.ptp(expected) > 0.1
        # The engine fuses multiplications into additions of the process, the text cannot.
        assert found[f"pump_{number}_out"] == pytest.approx(expected, abs=1e-9)
    assert found["level_1"][:-1] == pytest.approx(run.true_measurement("level_1")[1:], abs=1e-9)
    assert set(found["pump_1_status"]) == {1.0} and found["watchdog"][-1] == SCANS


@pytest.mark.parametrize(
    "precision", ["double", pytest.param("single", marks=pytest.mark.thorough)]
)
def test_all_dialects_run_the_same(precision):
    need("tree_sitter_iec61131_3_st")
    texts = {name: project(name, precision)[2] for name in ("matiec", "codesys", "scl")}
    texts["scl"] = standard_text(texts["scl"])
    step = {"pump_1_mode": 0, "pump_1_manual": np.float32(2.5) if precision == "single" else 2.5}
    tables = {name: run_in_text(text, step) for name, text in texts.items()}
    for name in tables["matiec"]:
        for other in ("codesys", "scl"):
            assert np.array_equal(tables["matiec"][name], tables[other][name])
    assert tables["matiec"]["pump_1_out"][-1] == 2.5


def test_each_system_gets_its_own_frame():
    texts = {name: project(name)[2] for name in ("matiec", "codesys", "scl")}
    assert texts["matiec"].endswith(
        "CONFIGURATION Config0\n"
        "  RESOURCE Res0 ON PLC\n"
        "    TASK sampling(INTERVAL := T#1s, PRIORITY := 0);\n"
        "    PROGRAM instance_of_tank_pi_test WITH sampling : tank_pi_test;\n"
        "  END_RESOURCE\n"
        "END_CONFIGURATION\n"
    )
    assert "PROGRAM tank_pi_test" in texts["codesys"] and "TASK" not in texts["codesys"]
    assert "CONFIGURATION" not in texts["scl"] and "PROGRAM tank" not in texts["scl"]
    assert 'FUNCTION_BLOCK "tank_pi_test"' in texts["scl"] and "OB30" in texts["scl"]
    assert 'plant : "quadruple_tank";' in texts["scl"] and "#plant(" in texts["scl"]
    for text in texts.values():
        assert len(re.findall(r"cyclic task of T#1s", text)) == 1


def test_what_an_engineer_sets_starts_at_rest():
    analysis, _, text = project()
    at = analysis.operating_point.as_dict()
    program = text[text.index("PROGRAM tank_pi_test") :]
    for name, value in (("level_1_sp", at["level_1"]), ("pump_2_manual", at["pump_2"]),
                        ("pump_1_tracking", at["pump_1"]), ("time_step", 1.0)):  # fmt: skip
        found = re.search(rf"^  {name} : LREAL := ([-\d.E]+);", program, re.MULTILINE)
        assert found is not None and float(found[1]) == value


@pytest.mark.parametrize(
    ("period", "expected"),
    [(1.0, "T#1s"), (0.001, "T#1ms"), (2.3, "T#2300ms"), (600, "T#600s"), (0.1, "T#100ms"),
     (4294967.295, "T#4294967295ms")],
)  # fmt: skip
def test_times_that_a_task_can_hold(period, expected):
    assert time_literal(period) == expected
    assert f"INTERVAL := {expected}," in project(period=period)[2]


@pytest.mark.parametrize("period", [0.0, -1.0, 0.0005, 1 / 3, 4294967.296, float("nan"),
                                    float("inf"), 0.1 + 0.2])  # fmt: skip
def test_times_that_no_task_can_hold(period):
    with pytest.raises(InputError, match=r"sampling period: got '.* s', expected a whole number"):
        project(period=period)


def test_milliseconds_are_exact():
    for count in (1, 7, 1001, 2300, 86_400_000, LONGEST):
        assert milliseconds(count / 1000) == count


def test_wires_that_do_not_fit():
    law = Program("law", (), (Signal("level_1.pv"),), (), (Signal("pump_1.out"),),
                  Block(1, (), (0,)))  # fmt: skip
    tank = Program("tank", (), (Signal("pump_1"),), (), (Signal("level_1"),), Block(1, (), (0,)))
    good = {"level_1.pv": "level_1", "pump_1.out": "pump_1"}
    assert wired(law, tank, good, 1.0)[0] == {"level_1.pv": "level_1"}
    for name, wire, what in (
        ("level_1.pv", "level_2", "an output of the process: level_1"),
        ("pump_1.out", "valve_1", "an input of the process: pump_1"),
    ):
        with pytest.raises(InputError, match=f"law, {name}: got '{wire}', expected {what}"):
            print_test_project(Project(law, tank, good | {name: wire}, 1.0))
    with refused(value="no wire"):
        print_test_project(Project(law, tank, {"pump_1.out": "pump_1"}, 1.0))
    with refused(value="LAW", expected="a name that differs"):
        print_test_project(Project(law, dataclasses.replace(tank, name="LAW"), good, 1.0))


def test_two_structures_of_one_name_are_refused_and_equal_ones_stand_once():
    def told(*names):
        parts = [f"pump.conditions.{name}" for name in names]
        return [Signal(part, kind="boolean", record="conditions") for part in parts]

    def stating(name, *names):
        never = Operation(1, "less", (0, 0)), Operation(2, "number", (1,))
        block = Block(1, never, (2,) * len(names))
        return Program(name, (), (Signal("u"),), (), tuple(told(*names)), block)

    law, tank = stating("law", "full"), stating("tank", "full")
    assert print_test_project(Project(law, tank, {}, 1.0)).count("TYPE ST_Conditions") == 1
    with refused(place="tank, TYPE ST_Conditions", expected="law"):
        print_test_project(Project(law, stating("tank", "full", "empty"), {}, 1.0))


#: Types of inputs that are not real, by the end of their names.
KINDS = {"mode": "DINT", "start": "DINT", "good": "BOOL", "acknowledge": "BOOL"}
PAGE = Path(__file__).parents[2] / "docs" / "plc.md"


@cache
def exported() -> str:
    """What the first export of docs/plc.md prints as its test."""
    ready = exportable(cl.design.simc(tagged()), tagged().point)
    return files_of(ready, "st")[f"{ready.program.name}_test.st"].decode()


def test_the_table_of_the_page_holds():
    """Each row of docs/plc.md is met by the printed program, in every digit shown."""
    need("tree_sitter_iec61131_3_st")
    program = StructuredText(exported()).instance("quadruple_tank_pi_simc_test")
    # The interpreter has all names in small letters.
    table = PAGE.read_text(encoding="utf-8").lower().split("<!-- numbers: begin -->\n")[1]
    rows = table.split("<!-- numbers: end -->")[0].splitlines()
    assert len(rows) == 11
    seen = ("lic101", "lic102", "p101_out", "p102_out", "p101_status")
    scans = 0
    for line in rows:
        what, after, *expected = (cell.strip() for cell in line.split("|")[1:-1])
        if what:
            scans = 0
        for name, value in re.findall(r"(\w+) := ([\w.]+)", what):
            kind = type(program.state[name])
            program.state[name] = value == "true" if kind is bool else kind(value)
        for _ in range(int(after) - scans):
            program.run()
        scans = int(after)
        found = [f"{float(program.state[name]):.4f}" for name in seen[:4]]
        assert [*found, str(program.state["p101_status"])] == expected, (what, after)


def test_the_wiring_of_the_page_runs():
    """The program of docs/plc.md moves the pump, fails safe and follows local control."""
    need("tree_sitter_iec61131_3_st")
    page = PAGE.read_text(encoding="utf-8")
    wiring = page.split("\n```iecst\n")[1].split("```")[0]
    block = exported().partition("FUNCTION_BLOCK quadruple_tank\n")[0].rpartition("(*")[0]
    # The grammar takes inputs in the call only; CODESYS and TwinCAT take assignments as well.
    assigned = re.findall(r"^ *control\.(\w+) := (.*);$", wiring, re.MULTILINE)
    names = list(dict.fromkeys(name for name, _ in assigned))
    declared = "".join(f"  {name}_in : {KINDS.get(name.rpartition('_')[2], 'LREAL')};\n"
                       for name in names)  # fmt: skip
    # The clock of the PLC, in ms.
    wiring = (
        wiring.replace("TIME()", "now").replace("TIME_TO_LREAL", "").replace(": TIME;", ": LREAL;")
    )
    text = wiring.replace("END_VAR", f"  now : LREAL := 5000.0;\n{declared}END_VAR", 1)
    text = re.sub(r"^( *)control\.(\w+) :=", r"\1\2_in :=", text, flags=re.MULTILINE)
    call = ", ".join(f"{name} := {name}_in" for name in names)
    program = StructuredText(block + text.replace("control();", f"control({call});")).instance(
        "plant_control"
    )

    def run(scans: int = 1, **given) -> float:
        program.state.update(given)
        for _ in range(scans):
            program.run()
            steps.append(float(program.state["time_step_in"]))
            program.state["now"] += 1003.0
        return float(program.state["p101"])

    steps: list[float] = []

    assert run(lic101_raw=round(0.6 * 27648), operator_p101_manual=4.0) == 4.0
    assert program.state["p101_raw"] == round(0.4 * 27648)
    assert 4.0 < run(operator_p101_mode=1, operator_lic101_sp=7.0) < 10.0
    # From STOP to RUN: ten minutes of which the block knows nothing are no step of the pump.
    before = run()
    program.state["now"] += 600_000.0
    assert run() == before and int(program.state["control"].state["p101_status"]) & 32768
    assert abs(run() - before) < 0.5
    assert run(p101_local=True, p101_position=5.5) == 5.5
    assert run(5, p101_local=False, lic101_raw=-4864) == 0.0
    assert steps == [1.0, 1.003, 1.003, 601.003, *7 * [1.003]]


def test_an_unwired_block_shows_what_the_page_says():
    need("tree_sitter_iec61131_3_st")
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    (status,) = re.search(r"every status is (\d+) ", page).groups()
    block = exported().partition("FUNCTION_BLOCK quadruple_tank\n")[0].rpartition("(*")[0]
    instance = StructuredText(block).instance("quadruple_tank_pi_simc")
    for _ in range(10):
        instance.run()
        for pump in ("p101", "p102"):
            assert instance.state[f"{pump}_status"] == int(status)
            assert instance.state[f"{pump}_out"] == 0.0
