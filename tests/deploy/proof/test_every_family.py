"""One controller of every family, in its plant shell, proved on every target over 2,000 scans.

An FMU takes longest to build, so that each controller gets one, of the two versions in turn.
"""

from functools import cache
from pathlib import Path

import pytest
from plants import plant
from schemes import SCHEMES
from spoilt_programs import FMUS, items_of, quickly
from tools import need_compiler, need_grammar, need_importer

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.controllers.controller import Controller
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.row import Proof
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.studies.designs import DESIGNS
from clepsydra.studies.file.reader import read_study

SCANS = 2_000
#: Small processes, so that a proof is quick; a design is proved on the first where it applies.
PROCESSES = (
    "wet-well", "equalisation-tank", "three-tanks", "quadruple-tank", "eight-tanks",
    "averaging-tank:inflow-constant", "wet-well:start-stop",
)  # fmt: skip
#: Designs that give other numbers to the law of another one, as a test below sees.
OTHER_NUMBERS = {
    "PI, arrest time", "PI, lambda", "PI, phase margin", "PI, AMIGO", "PI, Ziegler-Nichols",
    "PI, Tyreus-Luyben", "PID, SIMC", "PID, AMIGO", "PID, Ziegler-Nichols", "LQI, Bryson",
    "State feedback, pole placement",
}  # fmt: skip
PROVED = [name for name in DESIGNS if name not in OTHER_NUMBERS]
OWN_LAW = """\
from clepsydra import Signal
from clepsydra.program.step_law import Equations, step_law
import casadi as ca

def equations(s):
    error = s["level_1.sp"] - s["level_1.pv"]
    wanted = s["gain"] * error + s["summed"]
    rests = ca.logic_and(ca.fabs(error) < 0.01, s["quiet"] > 3)
    quiet = ca.if_else(ca.fabs(error) < 0.1, ca.fmin(s["quiet"] + 1, 9), 0)
    moved = ca.if_else(rests, s["pump_1.last_output"], wanted)
    following = ca.if_else(rests, s["summed"], s["summed"] + error * s["time_step"] / 30)
    return Equations({"summed": following, "quiet": quiet}, {"pump_1.out": moved},
                     {"error": error, "rests": rests})

law = step_law(
    "resting_pi",
    inputs=[Signal("level_1.sp", "V"), Signal("level_1.pv", "V"), Signal("time_step", "s"),
            Signal("pump_1.last_output", "V")],
    parameters=[Signal("gain", "V/V", initial=2.0)],
    state=[Signal("summed", "V", initial=3.0), Signal("quiet", low=0.0, high=9.0)],
    outputs=[Signal("pump_1.out", "V")],
    equations=equations,
)
"""
PYTHON_LAW = """\
inputs = ["level_1.sp", "level_1.pv"]
outputs = ["pump_1.out"]

def step(state, inputs, parameters, time_step):
    return {}, {"pump_1.out": 3.0 + inputs["level_1.sp"] - inputs["level_1.pv"]}
"""
RULES = """\
[inputs.e]
of = "level_1"
unit = "V"
[inputs.e.sets]
N = { left_shoulder = [-1, 0] }
ZO = { triangle = [-1, 0, 1] }
P = { right_shoulder = [0, 1] }
[outputs.du]
moves = "pump_1"
action = "increment"
unit = "V/min"
range = [-4, 4]
[outputs.du.sets]
down = { left_shoulder = [-4, 0] }
stay = { trapezoid = [-2, -1, 1, 2] }
up = { right_shoulder = [0, 4] }
[rules]
R1 = "if e is N then du is down"
R2 = "if e is ZO then du is stay"
R3 = "if e is P then du is up"
"""
OWN = """
[controllers.own]
law = "law.py"
measurements = ["level_1"]
setpoints = ["level_1"]
manipulated = ["pump_1"]
"""
#: What only a study file has: name to the study.
WRITTEN = {
    **SCHEMES,
    "own": f'process = "quadruple-tank"{OWN}',
    "rules": 'process = "quadruple-tank"\n[controllers.rules]\nfuzzy = "rules.toml"',
}  # fmt: skip


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


def with_one_fmu(monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    """Let proofs be quick: of the FMUs only that whose turn it is by the controller's number."""
    quickly(monkeypatch, SCANS, without=[name for name in FMUS if name != FMUS[number % 2]])


@cache
def designed(name: str) -> tuple[Controller, OperatingPoint]:
    """Return a controller of a design, and where it rests."""
    for process in PROCESSES:
        analysis = plant(process).analysis
        try:
            return DESIGNS[name](analysis), analysis.operating_point
        except NotApplicable:
            continue
    pytest.fail(f"{name} applies to none of PROCESSES: add one there to which it does")


def kind(controller: Controller) -> tuple[str, str]:
    """What two controllers share that differ in numbers only."""
    return controller.family, controller.law.name


def proof_of(controller: Controller, point: OperatingPoint) -> Proof:
    ready = exportable(controller, point)
    # Without the loop: what single precision does to scores is another matter.
    period = point.process.sampling_period
    item = ProofItem(controller.name, period, ready.program, origin=ready.origin)
    return prove([item], scans=SCANS)


def check(proof: Proof, controller: Controller) -> None:
    """Every target was run, every row holds, and what the scans show of it moves."""
    assert not proof.refusals, [row.reason for row in proof.refusals]
    assert proof.holds, proof.failures
    rows = [(row.target, row.precision, row.verdict) for row in proof.rows]
    compared = [verdict for *_, precision, verdict in rows if precision == "double"]
    assert compared == ["equal"] * 6
    assert len(rows) == 8
    assert ("Structured Text", "single", "equal") in rows
    assert ("C", "single", "reported") in rows
    coverage = proof.coverage[controller.name]
    assert coverage.still == ()
    assert len(coverage.seen) > len(coverage.unseen), coverage.sentence


@pytest.mark.thorough
def test_every_kind_of_law_is_proved():
    kinds: dict[tuple[str, str], str] = {}
    for name in DESIGNS:
        kinds.setdefault(kind(designed(name)[0]), name)
    missing = set(kinds) - {kind(designed(name)[0]) for name in PROVED}
    assert not missing, {found: kinds[found] for found in missing}


@pytest.mark.thorough
@pytest.mark.parametrize("name", PROVED)
def test_a_design_of_each_kind(name, monkeypatch):
    with_one_fmu(monkeypatch, PROVED.index(name))
    controller, point = designed(name)
    check(proof_of(controller, point), controller)


def written(name: str, folder: Path, law: str = OWN_LAW) -> Path:
    (folder / "law.py").write_text(law)
    (folder / "rules.toml").write_text(RULES)
    path = folder / "study.toml"
    path.write_text(WRITTEN[name])
    return path


@pytest.mark.thorough
@pytest.mark.parametrize("name", WRITTEN)
def test_what_is_written_out_in_a_study(name, tmp_path, monkeypatch):
    """Schemes of every block, a law of a user's own, and rules."""
    with_one_fmu(monkeypatch, list(WRITTEN).index(name))
    request = read_study(written(name, tmp_path))
    point = request.analysis.operating_point
    (asked,) = request.controllers
    controller = asked.make(request.analysis, linearise(point))
    check(proof_of(controller, point), controller)


@pytest.mark.thorough
def test_a_law_in_python_is_refused_with_its_reason(tmp_path):
    path = written("own", tmp_path, PYTHON_LAW)
    items = items_of(cl.study(path))
    (row,) = prove(items).rows
    assert row.verdict == "refused" and row.target == "every target"
    assert "a law in Python" in row.reason and "write it as expressions" in row.reason
    assert not prove(items).holds
