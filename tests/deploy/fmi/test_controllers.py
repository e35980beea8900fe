"""FMUs of controllers, run by FMPy: every bit is the engine's, and the rules of the interface."""

from dataclasses import replace

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from fmus import VERSIONS, Imported, all_bits, cases, written
from law_of_blocks import law_of_blocks
from models import drawn, lqi_program, origin, pi_model, pi_program
from plants import designed, plant

from clepsydra import Kernel
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import state_names
from clepsydra.program.reader import structured_program_of

SCANS = 1200


def simulated(program, inputs) -> np.ndarray:
    """Outputs, then states that are no rings, after each scan [scans, entries]."""
    shown = [k for k, entry in enumerate(program.state) if not is_ring(entry)]
    states = [replace(signal_of(program.state[k]), name=f"after.{k}") for k in shown]
    results = (*program.block.results, *(program.next_state[k] for k in shown))
    showing = replace(
        program,
        outputs=(*program.outputs, *states),
        block=replace(program.block, results=results),
    )
    run = Kernel(showing).run(len(next(iter(inputs.values()))), inputs=inputs)
    return np.column_stack([run.output(s.name)[0] for s in showing.outputs])


def shelled(design, name):
    return exportable(designed(design, name), plant(name).point).program


PROGRAMS = {
    "PI": pi_program,
    "LQI with Kalman filter": lqi_program,
    "PI in its shell": lambda: shelled("simc", "quadruple-tank"),
    "fuzzy in its shell": lambda: shelled("fuzzy_pi", "three-tanks"),
    "Smith predictor": lambda: shelled("smith_predictor", "eight-tanks"),
    "blocks": lambda: structured_program_of(law_of_blocks()),
}


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "version"), cases(PROGRAMS))
def test_every_bit_is_that_of_the_engine(name, version, tmp_path):
    program, period = PROGRAMS[name](), 0.7
    path = written(controller_model(program, origin("a process", period)), tmp_path, version)
    assert validate_fmu(str(path)) == []
    inputs = drawn(program, SCANS, 5, period)
    expected = simulated(program, inputs)
    names = [s.name for s in program.outputs]
    held = state_names(program)
    names += [held[entry.name] for entry in program.state if not is_ring(entry)]
    fmu = Imported(path, tmp_path).initialise()
    found = np.empty_like(expected)
    for scan in range(SCANS):
        fmu.set({name: values[scan] for name, values in inputs.items()})
        fmu.step(scan * period, period)
        found[scan] = fmu.get_all(names)
    fmu.close()
    assert len({tuple(row) for row in all_bits(expected[:, : len(program.outputs)])}) > 100
    assert np.array_equal(all_bits(found), all_bits(expected))


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pi")
    return {version: (written(pi_model(), folder, version), folder) for version in VERSIONS}


@pytest.fixture(params=VERSIONS)
def importing(request, paths):
    """Return a function that makes instances and closes them all at the end."""
    path, folder = paths[request.param]
    made = []

    def make(name: str = "one", token: str = "") -> Imported:
        made.append(Imported(path, folder, name, token))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


#: States of the loop that moves the first pump.
INTEGRAL, LAST_OUTPUT = "pump_1_loop.integral", "pump_1_loop.last_output"
#: A setpoint above its measurement.
STEP = {"level_1.sp": 6.3, "level_1.pv": 6.0, "level_2.sp": 6.0, "level_2.pv": 6.0}


def test_a_state_has_the_name_of_the_instance_that_holds_it():
    model = controller_model(structured_program_of(law_of_blocks()), origin("a process", 1.0))
    kept = model.variable("pair.inner_filter.kept")
    assert kept.member == "state.pair.inner_filter.kept" and kept.signal.initial == 0.5
    # The filter's output is computed from the state before the scan.
    outer = "pair.outer_filter"
    assert model.variable("y").depends_on == (f"{outer}.kept", f"{outer}.scans", "cold", "most")


def test_before_the_first_step_the_outputs_are_those_of_a_scan_that_leaves_no_trace(importing):
    fmu = importing()
    fmu.enter()
    fmu.set(STEP)
    before = fmu.get("pump_1.out"), fmu.get(LAST_OUTPUT)
    fmu.set({"level_1.sp": 6.2})
    assert fmu.get("pump_1.out") != before[0]
    fmu.set({"level_1.sp": 6.3})
    fmu.fmu.exitInitializationMode()
    assert (fmu.get("pump_1.out"), fmu.get(LAST_OUTPUT)) == before
    fmu.step(0.0, 1.0)
    assert fmu.get("pump_1.out") == before[0]
    assert fmu.get(LAST_OUTPUT) != before[1]


def test_outputs_hold_while_inputs_change_between_the_scans(importing):
    fmu = importing().initialise()
    fmu.set(STEP)
    fmu.step(0.0, 1.0)
    held = fmu.get("pump_1.out")
    fmu.set({"level_1.sp": 9.0})
    assert fmu.get("pump_1.out") == held


def test_a_scan_runs_when_it_falls_due_however_the_steps_are_cut(importing):
    """Communication steps of a third and of three periods: one scan in each period."""
    whole, parts, long = (importing(name).initialise() for name in ("whole", "parts", "long"))
    for fmu in (whole, parts, long):
        fmu.set(STEP)
    seen = []
    for scan in range(6):
        whole.step(float(scan), 1.0)
        for part in range(3):
            parts.step(scan + part / 3, 1 / 3)
            seen.append(parts.get("pump_1.out") == whole.get("pump_1.out"))
        if scan % 3 == 0:
            long.step(float(scan), 3.0)
    assert all(seen)
    assert long.get("pump_1.out") == whole.get("pump_1.out")
    assert long.get(INTEGRAL) == parts.get(INTEGRAL) == whole.get(INTEGRAL)


def test_parameters_are_set_before_the_start_and_tuned_later(importing):
    """Proportional action alone: the output moves by the gain times the change of setpoint."""
    moves = {}
    for when in ("never", "before", "later"):
        fmu = importing(when)
        gain = fmu.get("level_1.proportional_gain")
        fmu.set({"level_1.integral_time": 1e9})
        if when == "before":
            fmu.set({"level_1.proportional_gain": 2 * gain})
        fmu.initialise()
        fmu.set(STEP)
        fmu.step(0.0, 1.0)
        if when == "later":
            fmu.set({"level_1.proportional_gain": 2 * gain})
            assert fmu.get("level_1.proportional_gain") == 2 * gain
        fmu.step(1.0, 1.0)
        first = fmu.get("pump_1.out")
        fmu.set({"level_1.sp": STEP["level_1.sp"] + 0.1})
        fmu.step(2.0, 1.0)
        moves[when] = (fmu.get("pump_1.out") - first) / (0.1 * gain)
    weight = fmu.get("level_1.setpoint_weight")
    expected = {"never": weight, "before": 2 * weight, "later": 2 * weight}
    assert moves == pytest.approx(expected, rel=1e-6)


def test_a_state_is_set_before_the_start_only(importing):
    fmu = importing()
    fmu.set({LAST_OUTPUT: 4.0})
    fmu.initialise()
    assert fmu.get(LAST_OUTPUT) == 4.0
    with pytest.raises(FMICallException):
        fmu.set({LAST_OUTPUT: 5.0})
    assert fmu.get(LAST_OUTPUT) == 4.0
    assert "cannot be set now" in fmu.said[-1]


def run_on(fmu: Imported, first: int, scans: int) -> list[list[float]]:
    found = []
    for scan in range(first, first + scans):
        fmu.set({"level_1.sp": 6.0 + np.sin(scan), "level_1.pv": 6.0})
        fmu.step(float(scan), 1.0)
        found.append(fmu.get_all(["pump_1.out", "pump_2.out", INTEGRAL]))
    return found


def test_a_state_is_kept_given_back_and_sent_as_bytes(importing):
    fmu = importing().initialise()
    run_on(fmu, 0, 5)
    kept = fmu.state()
    onward = run_on(fmu, 5, 7)
    content = fmu.serialised(kept)
    fmu.set_state(kept)
    assert run_on(fmu, 5, 7) == onward
    other = importing("other").initialise()
    received = other.deserialised(content)
    other.set_state(received)
    assert run_on(other, 5, 7) == onward
    for state in (kept, received):
        fmu.free_state(state)
    with pytest.raises(FMICallException):
        other.deserialised(content[:-1])
    assert "another size" in other.said[-1]
    with pytest.raises(FMICallException):
        other.deserialised(b"x" * len(content))
    assert "no state of this model" in other.said[-1]


def test_reset_starts_anew_and_instances_know_nothing_of_each_other(importing):
    fmu, other = importing("one").initialise(), importing("two").initialise()
    first = run_on(fmu, 0, 5)
    fmu.fmu.terminate()
    fmu.fmu.reset()
    fmu.initialise()
    assert run_on(fmu, 0, 5) == first
    assert run_on(other, 0, 5) == first


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda fmu: fmu.step(0.0, float("nan")), "not a number above 0 s"),
        (lambda fmu: fmu.step(0.0, 0.0), "not a number above 0 s"),
        (lambda fmu: fmu.step(0.0, float("inf")), "not a number above 0 s"),
        (lambda fmu: fmu.step(3.0, 1.0), "the communication point is 3 s"),
        (lambda fmu: fmu.step(float("nan"), 1.0), "the communication point is"),
        (lambda fmu: fmu.step(0.0, 1e300), "too long"),
        (lambda fmu: fmu.fmu.exitInitializationMode(), "not allowed in this phase"),
        (lambda fmu: fmu.set({"pump_1.out": 1.0}), "cannot be set now"),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(call, text, importing):
    fmu = importing().initialise()
    with pytest.raises(FMICallException):
        call(fmu)
    assert text in fmu.said[-1]
    fmu.step(0.0, 1.0)


def test_an_unknown_variable_is_refused_with_its_number(importing):
    fmu = importing().initialise()
    number = 10_000
    with pytest.raises(FMICallException):
        (fmu.fmu.getFloat64 if fmu.third else fmu.fmu.getReal)([number])
    assert f"value reference {number}" in fmu.said[-1]
    mode = fmu.variables["pump_1.mode"].valueReference
    with pytest.raises(FMICallException):
        (fmu.fmu.getFloat64 if fmu.third else fmu.fmu.getReal)([mode])
    assert f"value reference {mode}" in fmu.said[-1]


def test_the_token_of_another_model_is_refused(importing):
    with pytest.raises(Exception, match="instantiate"):
        importing("foreign", token="{00000000-0000-0000-0000-000000000000}")
