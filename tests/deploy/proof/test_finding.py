"""What is said of a controller or process in a line, and how it stands on the screen."""

import dataclasses
import io
import math

import pytest
from rich.console import Console

import clepsydra as cl
from clepsydra.deploy.proof.answer import findings
from clepsydra.deploy.proof.coverage import Coverage
from clepsydra.deploy.proof.row import ProofRow

LONG = "PI, Ziegler-Nichols, slowed 7.51 times"


def row(target, *, subject="LQG", precision="double", against="engine", **more):
    return ProofRow(subject, target, precision, against, "0f", 10_000, 1, **more)


TEXTS = [row(f"Structured Text, {dialect}") for dialect in ("matiec", "codesys", "scl")]
SINGLE_TEXT = row("Structured Text", precision="single", against="C in single")
SINGLE = {"precision": "single", "against": "engine in double", "differing": 7}


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([row("C"), *TEXTS, row("FMU 3.0"), row("FMU 2.0"), SINGLE_TEXT,
          row("C", verdict="reported", largest=1.01e-5, **SINGLE)],
         []),
        ([row("C", verdict="fails", reason="?"), *(dataclasses.replace(text, verdict="fails",
          reason="?") for text in TEXTS)],
         ["does not run: C, Structured Text (3 dialects) (?)"]),
        ([row("C"), row("FMU 3.0 exchange", verdict="differs", largest=0.5, signal="der(level)",
                        scan=8, differing=3)],
         ["differs: FMU 3.0 for model exchange (3 of the numbers compared, by up to 0.5 of the "
          "range of der(level) in scan 8)"]),
        ([*TEXTS[:2], row("C", verdict="differs", differing=4000, decisions=4000)],
         ["differs: C (4,000 of the numbers compared, 4,000 of them decisions)"]),
        ([row("C", verdict="differs", largest=math.inf, signal="y", scan=4, **SINGLE)],
         ["differs: C in single precision (y is infinite or not a number in scan 4)"]),
        ([row("C", verdict="diverges", largest=1.25, signal="y", scan=4, **SINGLE), SINGLE_TEXT],
         ["does not follow the simulation: C in single precision (y is 1.2 times its range off in "
          "scan 4; export it in double precision)"]),
        ([row("C", verdict="fails", reason="gcc refuses x.c:\nno space left\n^~~~\n")],
         ["does not run: C (gcc refuses x.c: no space left)"]),
        ([row("FMU 3.0 exchange", verdict="refused", limit="delays in model exchange"), row("C"),
          row("FMU 2.0", verdict="refused", reason="no package fmpy")],
         ["refused without need: FMU 2.0 (no package fmpy)",
          "not run: FMU 3.0 for model exchange (an importer integrates the present, and dead "
          "time needs the past)"]),
        ([row("C", verdict="within the bound", bound=1e-12, largest=3e-14, differing=2)], []),
    ],
)  # fmt: skip
def test_the_worst_is_said_first_and_with_how_much(rows, said):
    assert findings(rows) == said


def screen(proof, columns, **more):
    console = Console(width=columns, file=io.StringIO(), record=True)
    console.print(proof.shown(**more).on_command_line)
    return [line.rstrip() for line in console.export_text().splitlines()]


@pytest.mark.parametrize("columns", [80, 100])
def test_a_controller_has_a_line_and_no_name_is_broken(columns):
    still = {LONG: Coverage((), (), ("pump_2.out",), ("pump_1.out",))}
    single = row("C", verdict="reported", largest=1.01e-5, **SINGLE)
    proof = cl.Proof((row("C"), single, row("C", subject=LONG)), still)
    lines = screen(proof, columns)
    (head,) = (k for k, line in enumerate(lines) if line.startswith("controller or process"))
    assert " ".join(lines[head + 1].split()) == "LQG equal in every bit 1.1e-5 of range"
    assert " ".join(lines[head + 2].split()) == f"{LONG} equal in every bit not run"
    assert f" !  {LONG}: never moved: pump_2.out." in lines
    whole = screen(proof, columns, every=True)
    assert whole.count(LONG) == 1 and whole.count("LQG") == 1  # above the targets of each
    assert max(map(len, (*lines, *whole))) <= columns


@pytest.mark.parametrize("columns", [80, 100])
def test_a_proof_of_many_fits_a_terminal_and_tells_what_is_amiss(columns):
    many = [row("C", subject=f"controller {place}") for place in range(25)]
    fails = [row("FMU 2.0", subject=f"controller {place}", verdict="fails", reason="it ends")
             for place in (3, 20)]  # fmt: skip
    lines = screen(cl.Proof((*many, *fails)), columns)
    assert len(lines) <= 25
    for place in (3, 20):
        assert f" !  controller {place}: does not run: FMU 2.0 (it ends)." in lines
    (row_of_3,) = (line for line in lines if line.startswith("controller 3 "))
    assert row_of_3.split()[2:] == ["1", "equal", "in", "every", "bit,", "1", "fails"]
    assert "13 more, and every target: --all" in lines
