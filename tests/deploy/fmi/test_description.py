"""Model descriptions: names, units, ranges, structure; FMPy reads them and finds nothing wrong."""

import re
from dataclasses import replace
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmus import VERSIONS
from models import exchange_of, origin, pi_model, pi_program, process_of
from plants import designed, plant
from refusals import refused

from clepsydra import Signal
from clepsydra.base.units import from_si, to_si
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.description import dimension
from clepsydra.deploy.fmi.model import output_dependencies
from clepsydra.deploy.fmi.write import write_fmu
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

MODELS = {
    "controller": pi_model,
    "process": lambda: process_of("equalisation-tank"),
    "exchange": lambda: exchange_of("wet-well"),
}


def described_only(model, folder, version):
    path = folder / f"{model.name}_{version[0]}.fmu"
    write_fmu(path, model, None, version=version, sources_only=True)
    return path


@pytest.fixture(scope="module")
def described(tmp_path_factory):
    """Return model, path and what FMPy reads, by kind and version."""
    found = {}
    for kind, make in MODELS.items():
        model = make()
        for version in VERSIONS:
            path = described_only(model, tmp_path_factory.mktemp(kind), version)
            found[kind, version] = model, path, fmpy.read_model_description(str(path))
    return found


cases = pytest.mark.parametrize(
    ("kind", "version"), [(kind, version) for kind in MODELS for version in VERSIONS]
)


@pytest.mark.sampled
@cases
def test_the_validator_finds_nothing(kind, version, described):
    assert validate_fmu(str(described[kind, version][1])) == []


@cases
def test_every_variable_has_its_name_unit_range_and_start(kind, version, described):
    model, _, description = described[kind, version]
    read = {v.name: v for v in description.modelVariables}
    assert set(read) - {"time"} == {variable.name for variable in model.variables}
    for variable in model.variables:
        signal, found = variable.signal, read[variable.name]
        assert found.causality == variable.causality
        assert found.variability == variable.variability
        if signal.kind == "real":
            assert found.unit == signal.unit
            shown = signal.shown_unit
            assert found.displayUnit == (shown if shown != signal.unit else None)
        if variable.settable and signal.kind == "real":
            assert float(found.start) == signal.initial
        if not variable.settable:
            assert found.start is None
        if found.min is not None and signal.kind != "boolean":
            assert float(found.min) == signal.low
        if found.max is not None and signal.kind != "boolean":
            assert float(found.max) == signal.high


def test_inputs_start_as_in_every_other_export():
    """Behind the plant shell: no sensor, manual, no time step, until the importer sets them."""
    ready = exportable(designed("simc", "quadruple-tank"), plant("quadruple-tank").point)
    model = controller_model(ready.program, ready.origin)
    starts = {
        name: model.variable(name).signal.initial
        for name in ("level_1.good", "level_1.pv", "pump_1.mode", "pump_1.manual", "time_step")
    }
    assert starts == {
        "level_1.good": 0.0,
        "level_1.pv": -2.5,
        "pump_1.mode": 0.0,
        "pump_1.manual": 0.0,
        "time_step": 0.0,
    }
    assert model.step == 1.0


@cases
def test_units_are_defined_by_their_dimension(kind, version, described):
    description = described[kind, version][2]
    units = {unit.name: unit for unit in description.unitDefinitions}
    if "m^3/s" in units:
        flow = units["m^3/s"].baseUnit
        assert (flow.m, flow.s, flow.kg) == (3, -1, 0)
    for unit in units.values():
        for shown in unit.displayUnits:
            # Two ways: the factor of the description, and the units of the package.
            assert 2.5 * float(shown.factor) == pytest.approx(from_si(2.5, unit.name, shown.name))
            back = to_si(f"{2.5 * float(shown.factor)!r} {shown.name}", unit.name, "test")
            assert back == pytest.approx(2.5, rel=1e-12)


def test_dimensions_in_base_units():
    units = [
        "V", "m^3/(s V)", "1", "1/s", "mol/m^3", "A/m", "s^2/m^5", "kg/m^3", "%", "m^0.5",
        "own_unit",
    ]  # fmt: skip
    found = {unit: dimension(unit)[0] for unit in units}
    assert found["V"] == {"kg": 1, "m": 2, "s": -3, "A": -1}
    assert found["m^3/(s V)"] == {"kg": -1, "m": 1, "s": 2, "A": 1}
    assert found["1"] == {}
    assert found["1/s"] == {"s": -1}
    assert found["mol/m^3"] == {"m": -3, "mol": 1}
    assert found["A/m"] == {"m": -1, "A": 1}
    assert found["s^2/m^5"] == {"m": -5, "s": 2}
    assert found["kg/m^3"] == {"kg": 1, "m": -3}
    assert dimension("%") == ({}, pytest.approx(0.01))
    assert found["m^0.5"] is None
    assert found["own_unit"] is None


def test_outputs_of_co_simulation_hold_and_so_depend_on_nothing_between_steps(described):
    for version in VERSIONS:
        description = described["controller", version][2]
        assert all(unknown.dependencies == [] for unknown in description.outputs)
        first = description.initialUnknowns[0]
        names = {variable.name for variable in first.dependencies}
        assert {
            "level_1.sp",
            "level_1.pv",
            "pump_1_loop.integral",
            "level_1.proportional_gain",
        } <= names
        assert not names & {"level_2.sp", "level_2.proportional_gain"}


def test_derivatives_depend_on_what_their_equations_read():
    """ḣ₁ of the quadruple tank: its own level, that of tank 3 above it, pump 1 and its inflow."""
    model = exchange_of("quadruple-tank")
    first = model.variable("der(tank_1.level)")
    assert set(model.known_later(first)) == {
        "tank_1.level", "tank_3.level", "pump_1", "inflow_1",
    } - ({"inflow_1"} if "inflow_1" not in first.depends_on else set())  # fmt: skip
    assert {"tank_1.area", "outlet_1.area", "outlet_3.area"} <= set(first.depends_on)
    assert "tank_2.area" not in first.depends_on


def test_dependencies_go_through_operations():
    block = Block(
        3,
        (
            Operation(3, "add", (0, 1)),
            Operation(4, "multiply", (3, 3)),
            Operation(5, "negate", (2,)),
        ),
        (0, 4, 5, 0),
    )  # fmt: skip
    program = Program(
        "law", (Signal("x"),), (Signal("u"),), (Signal("p"),),
        (Signal("a"), Signal("b"), Signal("c")), block,
    )  # fmt: skip
    assert output_dependencies(program) == [("x", "u"), ("p",), ("x",)]


@cases
def test_the_digest_and_the_design_are_told(kind, version, described):
    model, path, description = described[kind, version]
    assert description.generationTool.startswith("Clepsydra ")
    assert "a design." in description.description
    page = Path(fmpy.extract(str(path)), "documentation", "index.html")
    assert model.digest in page.read_text(encoding="utf-8")
    assert model.digest in (page.parents[1] / "modelDescription.xml").read_text(encoding="utf-8")
    sources = page.parents[1] / "sources" / f"{model.name}.c"
    found = re.search("program digest ([0-9a-f]{16})", sources.read_text(encoding="utf-8"))
    version = fmpy.read_model_description(str(path)).version
    assert found[1] == version == model.digest


def test_the_token_changes_with_the_numbers_and_the_version():
    program = pi_program()
    one = controller_model(program, origin("quadruple-tank", 1.0))
    parameter = replace(program.parameters[0], initial=program.parameters[0].initial + 1e-12)
    tuned = replace(program, parameters=(parameter, *program.parameters[1:]))
    other = controller_model(tuned, origin("quadruple-tank", 1.0))
    slower = controller_model(program, origin("quadruple-tank", 2.0))
    tokens = {m.token(v) for m in (one, other, slower) for v in VERSIONS}
    assert len(tokens) == 6
    assert one.token("3.0") == controller_model(program, origin("x", 1.0)).token("3.0")
    assert all(re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", t) for t in tokens)


def test_two_variables_of_one_name_are_refused():
    same = Program("law", (Signal("x"),), (), (), (Signal("x"),), Block(1, (), (0, 0)))
    with refused(expected="a name of its own in the FMU"):
        controller_model(same, origin("p", 1.0))


def test_what_xml_cannot_hold_is_left_out(tmp_path):
    signal = Signal("u", description='a <b> & "c"\n\x01 μ', low=0.0, high=float("inf"))
    program = Program("law", (), (signal,), (Signal("k", initial=float("inf")),),
                      (Signal("y"),), Block(2, (), (0,)))  # fmt: skip
    path = described_only(controller_model(program, origin("<&>", 1.0)), tmp_path, "3.0")
    assert validate_fmu(str(path)) == []
    read = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    assert read["u"].description == 'a <b> & "c" μ'
    assert float(read["k"].start) == float("inf")
