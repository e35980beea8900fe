"""The facts from which an engineer sets up a controller, against the parameters of its law."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock
from clepsydra.report.law_tables import law_facts, law_grids, law_words
from clepsydra.report.pid_tables import equation, loop_settings, settings_table
from clepsydra.report.scheme_tables import added_table, scheme_blocks


@pytest.fixture(scope="module")
def wet_well():
    return cl.load("wet-well")


@pytest.fixture(scope="module")
def four_tanks():
    return cl.load("quadruple-tank")


def by_hand(point, form, **values):
    """One loop of the wet well: level [A] by duty [1]; the display is in mA and %."""
    process = point.process
    law = multiloop_pid_law([process.signal("level")], [process.signal("duty")], form)
    given = {p.name: values.get(p.part, p.initial) for p in law.parameters}
    state = {s.name: given.get(s.name.replace("last_", ""), 0.0) for s in law.state}
    return Controller(
        "by hand", "PID", "By hand.", law, given, state, ("level",), ("level",), ("duty",)
    )


def facts_of(controller, point):
    (loop,) = loop_settings(controller, point)
    return dict(loop.rows)


def test_gains_are_in_the_units_of_the_displays(wet_well):
    point = wet_well.point
    facts = facts_of(
        by_hand(point, PidForm(), proportional_gain=-125.0, integral_time=120.0), point
    )
    # -125 per A are -12.5 % per mA; of 16 mA that is 200 %, so 2 %/% and a band of 50 %.
    assert facts["gain K"] == "12.50 %/mA, that is 2.000 %/%"
    (row,) = settings_table(
        by_hand(point, PidForm(), proportional_gain=-125.0, integral_time=120.0), point.process
    ).rows
    assert (row[1:3], row[-1]) == (("12.5 %/mA", "2.00"), "direct")
    assert facts["proportional band"] == "50.00 %"
    assert facts["integral time Ti"] == "120.0 s = 2.000 min/repeat = 0.5000 repeats/min"
    assert facts["action"].startswith("direct: the output falls when the measurement falls")
    assert facts["the same in parallel form"] == "Kp = 12.50 %/mA, Ki = 0.1042 %/mA per s"
    assert facts["output limits"] == "0 to 100.0 %"


def test_what_decouples_the_loops_stands_with_their_settings(four_tanks):
    """Inverted decoupling: what pump_2 does to level_1 is undone by pump_1, −K12/K11."""
    gains = cl.analyse(four_tanks).static_gain
    assert added_table(cl.design.simc(four_tanks), four_tanks.process) is None
    controller = cl.design.simc(four_tanks, decoupling="dynamic")
    first, second = added_table(controller, four_tanks.process).rows
    for row, own, other in ((first, 0, 1), (second, 1, 0)):
        assert row[0] == f"pump_{own + 1} from pump_{other + 1}"
        wanted = -gains[own, other] / gains[own, own]
        assert float(row[2].replace("−", "-")) == pytest.approx(wanted, abs=5e-4)
        assert row[1] == f"{row[2]} V/V" and row[-1].endswith(" s")


def test_a_pid_names_its_derivative_and_the_other_forms(wet_well):
    point = wet_well.point
    values = {"proportional_gain": -125.0, "integral_time": 100.0, "derivative_time": 16.0}
    facts = facts_of(by_hand(point, PidForm("PID"), **values, derivative_filter=8.0), point)
    assert facts["derivative time Td"] == "16.00 s = 0.2667 min"
    assert facts["derivative filter"] == "2.000 s (Td/8)"
    # Ti' + Td' = 100 and Ti' Td' = 1600: 80 and 20 s; K' = K 80/100.
    assert facts["the same in series form"] == "K = 10.00 %/mA, Ti = 80.00 s, Td = 20.00 s"
    series = facts_of(by_hand(point, PidForm("PID", "series"), **values), point)
    assert series["integral time Ti"].startswith("116.0 s")
    assert series["the same in series form"].endswith("Ti = 100.0 s, Td = 16.00 s")


def test_a_parallel_form_is_shown_in_isa_too(wet_well):
    point = wet_well.point
    form = PidForm("PI", "parallel", anti_windup="conditional_integration")
    facts = facts_of(by_hand(point, form, proportional_gain=-125.0, integral_gain=-2.5), point)
    assert facts["integral time Ti"].startswith("50.00 s")
    assert "tracking time" not in facts
    assert facts["anti-windup"].startswith("conditional integration")


def test_gap_action_and_ramp_are_in_display_units(wet_well):
    point = wet_well.point
    form = PidForm(error="gap", setpoint_ramp=True)
    facts = facts_of(
        by_hand(point, form, proportional_gain=-9.0, gap=0.002, setpoint_ramp=1e-5),
        point,
    )
    assert facts["gap, to each side"] == "2.000 mA"
    assert facts["setpoint moves at most"] == "0.01000 mA/s"


def test_without_integral_action_there_is_a_bias_and_no_integral_time(wet_well):
    point = wet_well.point
    facts = facts_of(by_hand(point, PidForm("P"), proportional_gain=-125.0), point)
    assert "integral time Ti" not in facts and "anti-windup" not in facts
    assert "+ bias" in facts["algorithm"]


def test_equations_of_the_forms():
    assert equation(PidForm("PID")) == "u = K (b r − y) + K/Ti ∫ e dt + K Td·(−D(y)), e = r − y"
    assert "Kd·(D(e))" in equation(PidForm("PID", "parallel", "error"))
    assert equation(PidForm("PI", "velocity")).endswith("computed as increments of u")
    assert "y′ = y − Td" in equation(PidForm("PID", "series"))


def scheme_of(blocks, values=None):
    parameters = {p.name: p.initial for block in blocks for p in block.parameters()}
    law = SimpleNamespace(blocks=tuple(blocks), description=(), state=())
    return SimpleNamespace(
        free_inputs={},
        law=law,
        values=parameters | (values or {}),
        initial_state={},
        measurements=(),
    )


def test_every_block_of_a_scheme_is_said(wet_well):
    process = wet_well.point.process
    level, duty = process.signal("level"), process.signal("duty")
    percent = Signal("split", "%", low=0.0, high=100.0)
    standby = Signal("standby", "1", "%", 0.0, 1.0)
    blocks = [
        SelectorBlock("lowest", ("level loop", "power loop"), "low"),
        FeedforwardBlock(
            "sum",
            "lowest",
            percent,
            (FeedforwardTerm("ahead", percent, level, measured=True, dynamic=True),),
        ),
        SplitRangeBlock(
            "split",
            "sum",
            (Leg("a", duty, 0.0, 50.0, 0.0, 1.0), Leg("b", standby, 50.0, 100.0, 0, 0.8)),
        ),
        RatioBlock("ratio", "c", level, duty, None),
        OutputBlock(duty, "split, duty", True),
    ]
    given = {
        "ahead.gain": 5000.0, "ahead.reference": 0.012, "ahead.lead": 3.0,
        "ahead.lag": 9.0, "duty.rate_limit": 0.02, "c.ratio": 40.0,
    }  # fmt: skip
    found = {
        part.title: dict(part.rows) for part in scheme_blocks(scheme_of(blocks, given), process)
    }
    selector = found["Override, lowest selector (lowest)"]
    assert selector["takes"] == "the lowest of level loop, power loop"
    assert "external reset" in selector["loops not selected"]
    assert found["Feedforward of split (sum)"]["from level"] == (
        "5.000 %/mA × (level − 12.00 mA), through (1 + 3.000 s · s)/(1 + 9.000 s · s)"
    )
    split = found["Split range (split)"]
    assert split["duty"] == "from 0 % at 0 % to 100.0 % at 50.00 %, level beyond"
    assert split["standby"] == "from 0 % at 50.00 % to 80.00 % at 100.0 %, level beyond"
    assert found["Ratio of duty to level (ratio)"]["ratio"] == "4.000 %/mA"
    output = found["Output duty"]
    assert output["moved by"] == "split, duty" and output["rate limit"] == "2.000 % per s"


def test_an_inner_loop_says_where_its_setpoint_comes_from(wet_well):
    point = wet_well.point
    level, duty = point.process.signal("level"), point.process.signal("duty")
    inner = PidBlock("inner", "inner", PidForm(), level, duty, "outer", inner=True)
    values = {"inner.setpoint_low_limit": 0.006, "inner.setpoint_high_limit": 0.018}
    (loop,) = loop_settings(scheme_of([inner, OutputBlock(duty, "inner")], values), point)
    assert dict(loop.rows)["setpoint"] == "from outer (cascade), kept from 6.000 mA to 18.00 mA"


def test_an_outer_loop_moves_a_setpoint(wet_well):
    point = wet_well.point
    level, duty = point.process.signal("level"), point.process.signal("duty")
    outer = PidBlock("outer", "level", PidForm(), level, level, "level.sp", direct=False)
    inner = PidBlock("inner", "inner", PidForm(), level, duty, "outer", inner=True)
    loops = loop_settings(scheme_of([outer, inner, OutputBlock(duty, "inner")]), point)
    assert dict(loops[0].rows)["moves"] == "the setpoint of level (4 to 20 mA)"


def test_a_fixed_setpoint_is_not_said_to_be_the_operators(wet_well):
    point = wet_well.point
    level, duty = point.process.signal("level"), point.process.signal("duty")
    flood = PidBlock("flood", "flood", PidForm(), level, duty, "flood.sp")
    scheme = scheme_of([flood, OutputBlock(duty, "flood")])
    scheme.free_inputs = {"flood.sp": 0.012}
    (loop,) = loop_settings(scheme, point)
    assert dict(loop.rows)["setpoint"].startswith("fixed at 12")


def test_decoupling_is_said_of_every_output(four_tanks):
    controller = cl.design.simc(four_tanks, decoupling="dynamic")
    blocks = scheme_blocks(controller, four_tanks.process)
    found = {part.title: dict(part.rows) for part in blocks}
    words = found["Decoupling of pump_2 (pump_2 decoupled)"]["from pump_1"]
    assert words.startswith(
        f"{controller.values['pump_2.feedforward.pump_1.gain']:.4f}".replace("-", "−")
    )
    assert "V/V × (pump_1 − 3.000 V), through 1/(1 + " in words  # there is no lead
    assert found["Output pump_1"]["output limits"] == "0 to 10.00 V"


def test_matrices_name_their_rows_and_columns_in_display_units(wet_well):
    controller = cl.design.lqi_kalman(wet_well)
    grids = {grid.title: grid for grid in law_grids(controller, wet_well.point.process)}
    feedback = grids["F, feedback"]
    assert feedback.head == ("", "well.level [m]", "duty.actual [%]")
    ((name, level, actual),) = feedback.rows
    values = controller.values
    assert name == "duty [%]"
    assert float(level.replace("−", "-")) == pytest.approx(
        100 * values["duty.feedback.well.level"], rel=1e-3
    )
    assert float(actual.replace("−", "-")) == pytest.approx(
        values["duty.feedback.duty.actual"], rel=1e-3
    )
    (row,) = grids["C, shown by"].rows
    # 4 to 20 mA over 4 m of level.
    assert row[0] == "level [mA]" and float(row[1]) == pytest.approx(4.0, rel=1e-3)
    assert len(grids["Φ, a sample later"].rows) == 2
    assert any("Observer" in sentence for sentence in law_words(controller))


def test_a_state_feedback_says_its_operating_point(four_tanks):
    process = four_tanks.process
    parts = {p.title: dict(p.rows) for p in law_facts(cl.design.lqi(four_tanks), process)}
    assert parts["Operating point"]["level_1°"] == "6.131 V"
    assert parts["Output pump_1"]["pump_1°, at rest"] == "3.000 V"
    assert "output at rest" not in parts["Output pump_1"]
    assert law_facts(cl.design.simc(four_tanks), process) == []


def test_start_and_stop_levels_are_a_table_of_stages():
    plant = cl.load("wet-well:start-stop")
    process, names = plant.process, [signal.name for signal in plant.process.inputs]
    controller = cl.design.start_stop_levels(plant).with_values({
        "stage.1.start_level": 0.012, "stage.1.stop_level": 0.008,
        "stage.2.start_level": 0.016, "stage.2.stop_level": 0.010,
        "shortest_rest": 60.0,
    })  # fmt: skip
    (grid,) = law_grids(controller, process)
    assert grid.rows[1] == ("stage 2: 2 running", "16.00 mA = 3.000 m", "10.00 mA = 1.500 m")
    parts = {part.title: dict(part.rows) for part in law_facts(controller, process)}
    assert parts["Pumps"]["shortest rest of a pump"] == "60.00 s"
    assert parts["Pumps"]["the duty changes"] == "after each run"
    assert parts[f"Output {names[0]}"]["in service"] == "yes"
    assert law_words(controller)[0].startswith("Each stage begins at its start level")


def test_a_gain_of_zero_is_said(wet_well):
    point = wet_well.point
    controller = by_hand(point, PidForm(), proportional_gain=1.0)
    still = replace(controller, values=controller.values | {"level.proportional_gain": 0.0})
    assert facts_of(still, point)["gain K"] == "0: no proportional action"


def test_a_parallel_form_without_isa_form_says_so(wet_well):
    point = wet_well.point
    level, duty = point.process.signal("level"), point.process.signal("duty")
    loop = PidBlock.of(level, PidForm("PI", "parallel"), duty)
    scheme = scheme_of(
        [loop, OutputBlock(duty, loop.name)],
        {"level.proportional_gain": -190.0, "level.integral_gain": 0.5},
    )
    (found,) = loop_settings(scheme, point)
    facts = dict(found.rows)
    assert facts["the ISA form"] == "none: its gains have different signs"
    assert facts["gain K"].startswith("−19")
