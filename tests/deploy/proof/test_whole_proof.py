"""The proof as a whole: rows, verdicts, refusals, going on after an interruption, its page."""

import dataclasses
import importlib.metadata
import io
import json
import re
from functools import lru_cache

import pytest
from plants import ONE_TANK, plant
from refusals import refused
from rich.console import Console
from spoilt_programs import FMUS, item, level_control, quick_proof, quickly
from tools import need_compiler, need_grammar, need_importer

import clepsydra as cl
from clepsydra import PythonLaw, Signal
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.run import Run
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program
from clepsydra.studies.designs import DESIGNS

TARGETS = [
    ("C", "double"),
    ("Structured Text, matiec", "double"),
    ("Structured Text, codesys", "double"),
    ("Structured Text, scl", "double"),
    ("FMU 3.0", "double"),
    ("FMU 2.0", "double"),
    ("WebAssembly", "double"),
    ("Structured Text", "single"),
    ("C", "single"),
]


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@lru_cache
def shelled(name: str) -> ProofItem:
    analysis = plant(ONE_TANK).analysis
    point = analysis.operating_point
    period = point.process.sampling_period
    controller = with_plant_shell(DESIGNS[name](analysis), period)
    return ProofItem(name, period, controller.program(), controller=controller, point=point)


def screen(proof, *, whole: bool = False, columns: int = 100) -> str:
    console = Console(width=columns, record=True, file=io.StringIO())
    console.print(cl.Proof(**vars(proof)).shown(every=whole).on_command_line)
    return console.export_text()


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["PI, SIMC"])
def test_a_controller_in_its_shell_is_the_same_on_every_target(name):
    proof = prove([shelled(name)])
    assert [(row.target, row.precision) for row in proof.rows] == TARGETS
    assert [row.verdict for row in proof.rows] == ["equal"] * 8 + ["reported"]
    assert all(row.bound == 0.0 and row.exact and row.scans == 10_000 for row in proof.rows[:8])
    assert proof.holds
    # Every bit of every status word was on in some scan and off in another.
    assert proof.coverage[name].unseen == () and len(proof.coverage[name].seen) >= 15
    single = proof.rows[-1]
    assert single.largest > 0.0 and single.bound is None
    # Single precision has 24 bits: what it moves of a score is far below what a study prints.
    assert single.scores["is_change"] is False
    assert abs(single.scores["ranking"] - 1.0) < 1e-3
    assert 0.0 < single.scores["change"] < 1e-2 and single.overflows == 0


@pytest.mark.thorough
def test_a_process_is_the_same_on_every_target(monkeypatch):
    quickly(monkeypatch, 2000)
    proof = prove([process_item(plant(ONE_TANK).point)], scans=2000)
    assert [row.target for row in proof.rows] == [
        "C", "Structured Text, matiec", "Structured Text, codesys", "Structured Text, scl",
        "FMU 3.0", "FMU 2.0", "FMU 3.0 exchange", "FMU 2.0 exchange", "WebAssembly",
    ]  # fmt: skip
    assert all(row.verdict == "equal" for row in proof.rows)
    assert proof.rows[-2].against == "CasADi"


def library_law(code: str) -> Program:
    block = Block(1, (Operation(1, code, (0,)),), (1,))
    shown = Signal("u", low=-2.0, high=2.0, initial=0.5)
    return Program("curve", (), (shown,), (), (Signal("y"),), block)


@pytest.mark.thorough
def test_a_law_with_a_library_function_is_held_to_its_bound(monkeypatch):
    proof = quick_proof(monkeypatch, library_law("exp"), without=FMUS[1:])
    double = [row for row in proof.rows if row.precision == "double"]
    (web,) = (row for row in double if row.target == "WebAssembly")
    assert web.bound == 0.0 and web.verdict == "equal"
    double.remove(web)
    assert all(row.bound == 1e-12 and not row.exact for row in double)
    assert all(row.verdict in ("equal", "within the bound") for row in double) and proof.holds


@pytest.mark.thorough
def test_what_a_target_cannot_write_is_refused_with_the_reason(monkeypatch):
    proof = quick_proof(monkeypatch, library_law("tanh"), without=FMUS)
    verdicts = {row.target: row for row in proof.rows if row.precision == "double"}
    assert verdicts["C"].verdict in ("equal", "within the bound")
    assert verdicts["Structured Text, matiec"].verdict == "refused"
    assert "tanh" in verdicts["Structured Text, matiec"].reason
    assert verdicts["Structured Text, matiec"].limit == "functions of Structured Text"
    assert proof.holds and "tanh" in screen(proof, whole=True)
    assert "no hyperbolic functions" in screen(proof)
    assert len(proof.refusals) == 4 and "4 rows refused by" in screen(proof)


def python_item(program: Program | None = None) -> ProofItem:
    """A controller whose law is a function of Python."""
    controller = DESIGNS["PI, SIMC"](plant("quadruple-tank").analysis)
    law = controller.law
    function = PythonLaw(law.name, law.inputs, law.parameters, law.state, law.outputs, (), None, ())
    own = dataclasses.replace(controller, law=function)
    return ProofItem("own law", 1.0, program, "a law in Python has no program", controller=own)


@pytest.mark.thorough
def test_a_controller_without_a_program_is_named_and_does_not_fail(monkeypatch):
    quickly(monkeypatch, without=FMUS)
    own = python_item()
    proof = prove([own, item()], scans=1000)
    assert proof.holds and [row.subject for row in proof.refusals] == ["own law"]
    shown = " ".join(screen(proof, whole=True).split())
    assert "own law: not run: every target (" in shown
    assert "a law in Python has no program)" in shown
    only = prove([own], scans=1000)
    assert not only.holds and "Nothing was compared." in screen(only)


@pytest.mark.thorough
def test_an_item_that_is_refused_for_a_setting_fails_the_proof(monkeypatch):
    quickly(monkeypatch, without=FMUS)
    wrong = ProofItem("other law", 1.0, refusal="its fail-safe value is outside the limits")
    proof = prove([wrong, item()], scans=1000)
    assert not proof.holds and [row.subject for row in proof.failures] == ["other law"]
    said = "refused without need: every target (its fail-safe value is outside the limits)"
    shown = " ".join(screen(proof).split())
    assert said in shown and "1 more refused without need" in shown


@pytest.mark.thorough
@pytest.mark.parametrize(("whole", "columns"), [(False, 80), (True, 100)])
def test_nothing_is_written_wider_than_a_terminal(monkeypatch, whole, columns):
    quickly(monkeypatch, without=FMUS)
    proof = prove([item(), process_item(plant(ONE_TANK).point)], scans=1000)
    text = screen(proof, whole=whole, columns=columns)
    assert max(len(line.rstrip()) for line in text.splitlines()) <= columns
    assert "…" not in text and ("; Clepsydra 0." in text) is whole
    assert text.strip().splitlines()[-1].startswith("Next: ")


@pytest.mark.thorough
def test_an_interrupted_proof_goes_on(monkeypatch, tmp_path):
    def interrupt(progress):
        if progress.name == "level control: FMU 3.0, double":
            raise KeyboardInterrupt

    older = FMUS[1:]
    first = quick_proof(monkeypatch, without=older, folder=tmp_path, progress=interrupt)
    assert first.interrupted and not first.holds and len(first.rows) == 4
    assert "run the same command again" in screen(first)
    asked = []
    row = Run.row
    monkeypatch.setattr(Run, "row", lambda run, *more: asked.append(run.name) or row(run, *more))
    second = quick_proof(monkeypatch, without=older, folder=tmp_path)
    assert asked == ["FMU 3.0", "WebAssembly", "Structured Text", "C"]
    assert second.holds and second.rows[:4] == first.rows
    asked.clear()
    again = quick_proof(monkeypatch, without=older, folder=tmp_path)
    assert again.rows == second.rows and asked == []
    # Other scans and another program are other rows.
    quick_proof(monkeypatch, without=FMUS, folder=tmp_path, seed=2)
    assert len(asked) == 7
    asked.clear()
    program = level_control()
    changed = dataclasses.replace(
        program, parameters=(dataclasses.replace(program.parameters[0], initial=2.8),
                             *program.parameters[1:]),
    )  # fmt: skip
    quick_proof(monkeypatch, changed, without=FMUS, folder=tmp_path, seed=2)
    assert len(asked) == 7


@pytest.mark.thorough
def test_rows_that_differed_are_computed_again(monkeypatch, tmp_path):
    from clepsydra.deploy.proof import compiled_c

    print_c = compiled_c.print_c
    monkeypatch.setattr(
        compiled_c,
        "print_c",
        lambda program, **more: print_c(
            dataclasses.replace(
                program, state=(dataclasses.replace(program.state[0], initial=0.1),
                                *program.state[1:]),
            ),
            **more,
        ),
    )  # fmt: skip
    # Scans that begin in automatic: in manual the integral follows, whatever it was.
    assert not quick_proof(monkeypatch, without=FMUS, folder=tmp_path, seed=5).holds
    monkeypatch.setattr(compiled_c, "print_c", print_c)
    assert quick_proof(monkeypatch, without=FMUS, folder=tmp_path, seed=5).holds


def test_the_files_say_what_was_proved(monkeypatch, tmp_path):
    proof = quick_proof(monkeypatch, folder=tmp_path, stem="tank.proof")
    said = json.loads((tmp_path / "tank.proof.json").read_text())
    assert said["holds"] is True and len(said["rows"]) == 9
    assert said["rows"][0]["target"] == "C" and said["rows"][0]["bound"] == 0.0
    assert f"FMPy {importlib.metadata.version('FMPy')}" in said["versions"]
    page = (tmp_path / "tank.proof.md").read_text()
    assert "\n## level control\n" in page and "**The proof holds" in page
    assert len(re.findall(r"^\| .* \| (double|single) \| ", page, re.M)) == 9
    assert proof.as_dict()["rows"] == said["rows"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["tank.proof.json", "tank.proof.md"]


@pytest.mark.parametrize("text", ["", "{}", '{"rows": [{}]}', "[1]", "[" * 100_000])
def test_a_file_that_is_no_proof_is_not_overwritten(text, tmp_path, monkeypatch):
    (tmp_path / "proof.json").write_text(text)
    with refused(expected="what an earlier proof wrote"):
        quick_proof(monkeypatch, folder=tmp_path)
    assert (tmp_path / "proof.json").read_text() == text


@pytest.mark.parametrize(("scans", "seed"), [(9_999, 1), (10_000, -1)])
def test_too_few_scans_are_refused(scans, seed):
    with refused(expected="at least"):
        prove([item()], scans=scans, seed=seed)
