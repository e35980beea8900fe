"""Exported controllers have the units of the process file at their ports, and SI inside."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from deployed import CompiledC, InterpretedText, all_bits, files_of
from plants import ONE_TANK, designed, plant
from tools import need_grammar

import clepsydra as cl
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.deploy.proof.text.interpreter import StructuredText

LABORATORY, WELL = "laboratory-four-tanks", "wet-well"


@cache
def ready(name, design="simc"):
    return exportable(designed(design, name), plant(name).point)


def ports(name):
    program = ready(name).program
    return {s.name: s for s in (*program.inputs, *program.parameters, *program.outputs)}


@pytest.mark.parametrize(
    ("name", "port", "unit", "low", "high"),
    [
        (LABORATORY, "level_1.pv", "%", 0.0, 120.0),
        (LABORATORY, "level_1.sp", "%", 0.0, 120.0),
        (LABORATORY, "pump_2.out", "%", 0.0, 100.0),
        (LABORATORY, "pump_2.tracking", "%", 0.0, 100.0),
        (WELL, "level.pv", "mA", 4.0, 20.0),
        (WELL, "duty.out", "%", 0.0, 100.0),
        (ONE_TANK, "level_1.pv", "cm", 0.0, 20.0),
        (ONE_TANK, "pump_1.out", "V", 0.0, 10.0),
    ],
)
def test_a_port_has_the_unit_and_the_range_of_the_process_file(name, port, unit, low, high):
    found = ports(name)[port]
    assert (found.unit, found.low, found.high) == (unit, low, high)


@pytest.mark.parametrize(
    ("name", "parameter", "unit", "value"),
    [
        (LABORATORY, "pump_1.high_limit", "%", 100.0),
        (LABORATORY, "level_1.range_high", "%", 120.0),
        (LABORATORY, "level_1.integral_time", "s", 10.4498),
        (LABORATORY, "pump_1.rate_limit", "%/s", 1e9),
        (WELL, "level.range_low", "mA", 4.0),
        (ONE_TANK, "level_1.range_high", "cm", 20.0),
        (ONE_TANK, "level_1.setpoint_rate", "cm/s", 1e9),
    ],
)
def test_a_parameter_has_the_unit_of_what_it_is_of(name, parameter, unit, value):
    found = ports(name)[parameter]
    assert (found.unit, found.initial) == (unit, value)


def test_a_gain_is_the_one_that_the_study_prints():
    for name, span in ((LABORATORY, 1.0), ("equalisation-tank", 1.0), (ONE_TANK, 10.0 / 20.0)):
        printed = re.findall(r"K = ([-\d.]+) %/%", ready(name).origin.design)
        gains = [s for s in ports(name).values() if s.name.endswith(".proportional_gain")]
        assert [float(f"{s.initial / span:.3g}") for s in gains] == list(map(float, printed))
    assert ports(LABORATORY)["level_1.proportional_gain"].unit == "%/%"
    assert ports(ONE_TANK)["level_1.proportional_gain"].unit == "V/cm"


def test_what_is_set_with_a_unit_is_printed_in_it(tmp_path):
    cl.export(
        designed("simc", LABORATORY), plant(LABORATORY), tmp_path, to="st",
        fail_safe={"pump_1": "7 %"}, setpoint_rate={"level_2": "0.3 %/s"},
    )  # fmt: skip
    (text,) = (p.read_text() for p in tmp_path.glob("*simc.st"))
    assert "pump_1_fail_safe : LREAL := 7.0;" in text
    assert "level_2_setpoint_rate : LREAL := 0.3;" in text


@pytest.mark.parametrize("name", [LABORATORY, WELL, "equalisation-tank"])
def test_exported_laws_score_and_rank_as_those_that_were_studied(name):
    orders = []
    for design in ("simc", "phase_margin", "lambda_"):
        bare, exported = designed(design, name), ready(name, design).controller
        assert exported.law.inputs != bare.law.inputs
        expected, found = (cl.simulate(plant(name), each).scores for each in (bare, exported))
        for score, value in expected.items():
            assert found[score] == pytest.approx(value, rel=1e-9, abs=1e-12), score
        errors = [score for score in expected if score.startswith("iae")]
        orders.append([sum(scores[e] for e in errors) for scores in (expected, found)])
    assert np.argsort(orders, axis=0)[:, 0].tolist() == np.argsort(orders, axis=0)[:, 1].tolist()


def test_the_reference_solver_converts_as_the_kernel_does():
    name, change = LABORATORY, [cl.step("level_1", by="2 %", at="1 s")]
    bare, exported = designed("simc", name), ready(name).controller
    by_kernel = cl.simulate(plant(name), bare, change, duration="20 s").values["pump_1"]
    run = cl.simulate(plant(name), exported, change, duration="20 s", solver="reference")
    assert np.ptp(by_kernel) > 0.01
    assert run.values["pump_1"] == pytest.approx(by_kernel, abs=1e-5)


@pytest.mark.parametrize("name", [LABORATORY, ONE_TANK, WELL])
def test_all_targets_equal_the_engine_in_the_units_of_the_ports(name, tmp_path):
    program = ready(name).program
    scans = random_scans(program, 600, 3, ready(name).process.sampling_period)
    pv = next(s for s in program.inputs if s.part == "pv")
    assert np.nanmedian(scans[pv.name]) > pv.low + 0.1 * pv.span
    engine = engine_run(program, scans)
    assert len(np.unique(engine[:, 0])) > 100
    for instance in (CompiledC(program, tmp_path), InterpretedText(program)):
        assert np.array_equal(all_bits(instance.run(scans)), all_bits(engine))


def test_no_limit_of_a_rate_is_none_in_every_unit():
    """A rate of 1e9 %/s would be one of 1e7 1/s: a setpoint that waits at the measurement."""
    program = ready(LABORATORY).program
    idle = {s.name: np.full(3, s.initial) for s in program.inputs}
    idle |= {"level_1.pv": np.full(3, 40.0), "level_1.good": np.ones(3), "time_step": np.ones(3)}
    states = [entry.name for entry in program.state]
    column = len(program.outputs) + states.index("level_1.ramped_setpoint")
    setpoint = next(s.initial for s in program.inputs if s.name == "level_1.sp")
    assert engine_run(program, idle)[-1, column] == pytest.approx(setpoint / 100.0)
    slow = idle | {"level_1.setpoint_rate": np.full(3, 1.0)}
    assert engine_run(program, slow)[-1, column] == pytest.approx(0.4)


def test_a_gain_of_six_digits_has_few_in_the_units_of_its_port():
    """3.03834 %/% are 18.989625 %/mA of 4 to 20 mA, and so it is printed."""
    (gain,) = (s.initial for s in ready(WELL).program.parameters if s.part == "proportional_gain")
    assert gain == float(f"{gain:.9g}")


def test_an_fmu_stays_in_si_and_says_what_to_show():
    exported = ready(LABORATORY)
    model = controller_model(exported.program_in_si, exported.origin)
    for name in ("level_1.pv", "pump_1.out", "pump_1.high_limit"):
        signal = model.variable(name).signal
        assert (signal.unit, signal.display_unit) == ("1", "%")
    assert model.variable("pump_1.high_limit").signal.initial == 1.0


def test_the_test_project_speaks_the_units_of_the_process_file():
    """100 cm³/s for 0.1 s into 15.5179 cm² are 0.6444 cm; what flows out of them is hardly more."""
    need_grammar()
    exported = ready(LABORATORY)
    files = files_of(exported, "st")
    (text,) = (t.decode() for n, t in files.items() if n.endswith("_test.st"))
    program = StructuredText(text).instance(f"{exported.program.name}_test")
    at = exported.point.as_dict()
    program.run()
    assert program.state["level_1"] == pytest.approx(100.0 * at["level_1"])
    assert program.state["tank_1_level"] == pytest.approx(100.0 * at["tank_1.level"])
    for scan in range(600):
        if scan == 5:
            program.state["level_1_sp"] += 5.0
        program.run()
    assert program.state["level_1"] == pytest.approx(100.0 * at["level_1"] + 5.0, abs=1.0)
    assert program.state["pump_1_out"] > 100.0 * at["pump_1"]
    before, program.state["pour_1"] = program.state["tank_1_level"], 100.0
    for _ in range(2):
        program.run()
    risen = program.state["tank_1_level"] - before
    assert risen == pytest.approx(100.0 * 0.1 / 15.5179, abs=0.02)


def test_a_process_in_si_is_exported_as_if_there_were_no_edge():
    exported = ready("quadruple-tank")
    # An importer of the FMU starts the loop at rest, a PLC its outputs at their fail-safe values.
    outputs = exported.program_in_si.outputs
    assert digest(replace(exported.program, outputs=outputs)) == digest(exported.program_in_si)
    source = files_of(exported, "c")[f"{exported.program.name}.c"].decode()
    assert not re.search(r"_si\b", source)
