"""A controller made ready for a plant: what its block does before anything is wired to it."""

import re
from dataclasses import replace
from functools import cache
from xml.etree import ElementTree

import pytest
from deployed import files_of
from plants import designed, plant
from refusals import refused

from clepsydra.base.units import from_si
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.exportable import exportable, exportable_name
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES
from clepsydra.program.entries import signal_of
from clepsydra.studies.designs import DESIGNS

NUMBERS = {"true": "1", "false": "0"}
CASES = [
    ("quadruple-tank", "PI, SIMC"),
    ("equalisation-tank", "PI, arrest time"),
    ("eight-tanks", "Smith predictor, LQ"),
    ("wet-well:start-stop", "Start/stop levels"),
    ("averaging-tank", "Fuzzy PI"),
]


@cache
def made_ready(process, name):
    return exportable(DESIGNS[name](plant(process).analysis), plant(process).point)


@pytest.fixture(params=CASES, ids=lambda case: case[1])
def ready(request):
    return made_ready(*request.param)


def test_a_block_that_nobody_wired_stands_in_manual_at_fail_safe_and_without_sensors(ready):
    inputs = {signal.name: signal.initial for signal in ready.program.inputs}
    values = {signal.name: signal.initial for signal in ready.program.parameters}
    at = ready.point.as_dict()
    assert inputs["time_step"] == 0.0
    for name in ready.controller.manipulated:
        assert inputs[f"{name}.mode"] == 0.0
        safe = values[f"{name}.fail_safe"]
        assert inputs[f"{name}.manual"] == inputs[f"{name}.tracking"] == safe
    for name in ready.controller.measurements:
        low, high = (values[f"{name}.range_{end}"] for end in ("low", "high"))
        current = 4.0 + 16.0 * (inputs[f"{name}.pv"] - low) / (high - low)
        assert current < 3.6 and inputs[f"{name}.good"] == 0.0
    for name in ready.controller.setpoints:
        signal = ready.process.signal(name)
        at_rest = from_si(at[name], signal.unit, signal.shown_unit)
        assert inputs[f"{name}.sp"] == float(f"{at_rest:.9g}")


@pytest.mark.parametrize("process", ["quadruple-tank", "wet-well"])
def test_a_setpoint_begins_with_digits_to_read_and_the_state_with_all(process):
    """Nine of them, where the point has those of its solution: a level of 6.13148375977550 V."""
    ready = made_ready(process, "PI, SIMC")
    for exported in (ready.program, ready.program_in_si):
        for each in (signal for signal in exported.inputs if signal.part == "sp"):
            assert each.initial == float(f"{each.initial:.9g}")
    state = {signal_of(entry).name: signal_of(entry).initial for entry in ready.program.state}
    at = ready.point.as_dict()
    moved = ready.controller.manipulated
    assert [state[f"{name}.last_output"] for name in moved] == [at[name] for name in moved]


def test_every_printer_declares_the_inputs_alike():
    """What stands in the texts, read by plain patterns, is what the signals say."""
    ready = made_ready("quadruple-tank", "PI, SIMC")
    expected = {signal.identifier: signal.initial for signal in ready.program.inputs}
    found = {}
    for dialect in DIALECT_NAMES:
        exported = files_of(ready, "st", dialect=dialect)
        name = f"{ready.program.name}.{'scl' if dialect == 'scl' else 'st'}"
        # The blocks of the library come first.
        declared = exported[name].decode().split("VAR_INPUT")[-1].split("END_VAR")[0]
        found[dialect] = dict(re.findall(r"(\w+) : \w+ := ([-\w.]+);", declared))
    xml = ElementTree.fromstring(exported_xml(ready))
    tag = xml.tag.partition("}")[0] + "}"
    (block,) = [p for p in xml.iter(f"{tag}pou") if p.get("name") == ready.program.name]
    found["PLCopen"] = {
        variable.get("name"): next(variable.iter(f"{tag}simpleValue")).get("value")
        for variable in block.iter(f"{tag}variable")
        if variable.get("name") in expected
    }
    source = print_c(ready.program).source
    found["C"] = dict(re.findall(r"^  inputs->(\w+) = ([-\w.]+);", source, re.MULTILINE))
    model = controller_model(ready.program, ready.origin)
    found["FMU"] = {
        signal.identifier: str(model.variable(signal.name).signal.initial)
        for signal in ready.program.inputs
    }
    for printer, texts in found.items():
        values = {name: NUMBERS.get(texts[name].lower(), texts[name]) for name in expected}
        assert {name: float(value) for name, value in values.items()} == expected, printer


def exported_xml(ready) -> bytes:
    files = files_of(ready, "st")
    return files[f"{ready.program.name}_test.xml"]


def level_of(flow: float, hole: float) -> float:
    """Return what a sensor of 50 V/m shows above a hole [m²] that passes a flow [m³/s], at rest."""
    return 50.0 * (flow / hole) ** 2 / (2 * 9.81)


#: Setpoints, and outputs in SI, from Johansson's equations at 3 V and from the other files.
AT_REST = {
    "quadruple-tank": (
        [level_of(3.0 * (0.70 * 3.33e-6 + 0.40 * 3.35e-6), 0.071e-4),
         level_of(3.0 * (0.60 * 3.35e-6 + 0.30 * 3.33e-6), 0.057e-4)],
        [3.0, 3.0],
    ),
    "equalisation-tank": ([50.0], [0.614]),
    "eight-tanks": ([4.9e-3 * 3.08 * 60.0], [4.9e-3]),
    # No level at which a pump starts is reached.
    "wet-well:start-stop": ([], [0.0, 0.0]),
    "averaging-tank": ([5.0, 2.0], [5000.0, 0.2]),
}  # fmt: skip


@pytest.mark.parametrize(("process", "name"), CASES)
def test_setpoints_and_outputs_begin_where_the_plant_rests(process, name):
    program = made_ready(process, name).program
    outputs = (signal for signal in program.outputs if not signal.record)
    signals = [*program.inputs, *outputs, *map(signal_of, program.state)]

    def begin(part):
        return [signal.initial for signal in signals if signal.part == part]

    setpoints, in_si = AT_REST[process]
    assert begin("sp") == pytest.approx(setpoints, rel=1e-5)
    # Before the first call nobody knows where the plant is: each low limit here is 0.
    assert begin("out") == [0.0] * len(in_si)
    in_the_importer = [
        s for s in made_ready(process, name).program_in_si.outputs if s.part == "out"
    ]
    assert [s.initial for s in in_the_importer] == pytest.approx(in_si, rel=1e-12)
    assert begin("last_output") == pytest.approx(in_si, rel=1e-12)


def test_every_number_says_its_source():
    ready = made_ready("quadruple-tank", "PI, SIMC")
    entries = {entry.name: entry for entry in (*ready.program.parameters, *ready.program.state)}
    found = {name: ready.origin.source_of(entry) for name, entry in entries.items()}
    designed = ("proportional_gain", "integral_time", "setpoint_weight", "tracking_time")
    expected = {
        **{f"level_{k}.{name}": "PI, SIMC" for name in designed for k in (1, 2)},
        **{f"pump_{k}.{name}": f"range of pump_{k} in the process file"
           for name in ("low_limit", "high_limit") for k in (1, 2)},
        **{f"level_{k}.{name}": f"range of level_{k} in the process file"
           for name in ("range_low", "range_high") for k in (1, 2)},
        **{f"level_{k}.{name}": "at the operating point"
           for name in ("integral", "last_proportional_gain") for k in (1, 2)},
        **{f"pump_{k}.last_output": "at the operating point" for k in (1, 2)},
        **{f"pump_{k}.fail_safe": f"default: low limit of pump_{k}" for k in (1, 2)},
        **{f"level_{k}.good_measurement": "at a cold start" for k in (1, 2)},
        "sampling_period": "sampling period that the controller runs with",
    }  # fmt: skip
    assert {name: found[name] for name in expected} == expected
    others = [name for name in found if name not in expected and found[name] == "PI, SIMC"]
    assert not others


def test_a_name_of_which_no_letter_is_left_is_refused(ready):

    with refused(expected="a name with a letter"):
        exportable_name(ready.process, replace(ready.controller, name="泵"))


def test_before_the_first_call_an_output_stands_at_its_fail_safe_value():
    settings = PlantShell(fail_safe={"pump_2": 1.25})
    ready = exportable(designed("simc", "quadruple-tank"), plant("quadruple-tank").point, settings)
    first = {s.name: s.initial for s in ready.program.outputs if s.part == "out"}
    assert first == {"pump_1.out": 0.0, "pump_2.out": 1.25}
