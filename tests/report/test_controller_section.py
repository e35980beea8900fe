"""What the page of one controller shows."""

from dataclasses import replace

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.program.step_law import Equations, step_law
from clepsydra.report.html import controller_section
from clepsydra.report.law_tables import law_grids, law_words

STUDY = (
    flow_cascade(duration="1 min", at="10 s", by="2 %")
    + """\
[controllers.single.loops.level]
measurement = "level"
output = "duty"
actions = "P"
action = "direct"
gain = "3 %/%"
"""
)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("cascade") / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return cl.study(path)


def parts_of(section, has):
    """All parts with a field, in sections within it too: tables have rows, pictures an svg."""
    for part in section.parts:
        if hasattr(part, has):
            yield part
        if hasattr(part, "parts"):
            yield from parts_of(part, has)


def test_the_time_at_the_limits_of_the_inner_setpoint_is_among_the_scores(study):
    for name, told in (("cascade", True), ("single", False)):
        tables = parts_of(controller_section(study, study[name]), "rows")
        titles = [row[0] for table in tables for row in table.rows]
        assert ("Time at a setpoint limit" in titles) is told


def test_the_blocks_are_those_of_its_export(study):
    cascade, single = (
        [*parts_of(controller_section(study, study[name], with_blocks=True), "svg")]
        for name in ("cascade", "single")
    )
    assert ">loop_flow_demand<" in cascade[0].svg
    assert ">level_check<" in single[0].svg
    assert "loop_flow" not in single[0].svg


def test_settings_are_told_once(study):
    tables = [*parts_of(controller_section(study, study["single"]), "rows")]
    heads = [table.title for table in tables]
    assert len(heads) == len(set(heads)) or heads.count("") > 1
    assert sum("proportional_gain" in row for table in tables for row in table.rows) == 0


def test_a_loop_whose_setpoint_is_fixed_is_told_where_it_rests(tmp_path):
    """An override: the second loop of one level has a setpoint that no operator gives."""
    loops = [
        f'[controllers.override.loops.{name}]\nmeasurement = "level"\noutput = "highest"\n'
        f'actions = "P"\naction = "direct"\ngain = "{gain}"\n{more}'
        for name, gain, more in (
            ("level", "0.5 %/%", ""),
            ("flood", "10 %/%", 'setpoint = "80 %"\n'),
        )
    ]
    select = '[controllers.override.selectors.highest]\nselect = "high"\noutput = "outflow"\n'
    scenario = '[scenario]\nduration = "1 h"\nnoise = false\n[[scenario.load]]\n'
    scenario += 'signal = "inflow"\nat = "10 min"\nby = "0.1 m^3/s"\n'
    path = tmp_path / "study.toml"
    path.write_text('process = "equalisation-tank"\n' + scenario + "".join(loops) + select)
    study = cl.study(path)
    tables = [*parts_of(controller_section(study, study["override"]), "rows")]
    (wiring,) = (dict(table.rows) for table in tables if table.title == "Wiring")
    assert wiring["level.sp"] == "setpoint of level"
    assert wiring["flood.sp"] == "80.0 % at rest"


def test_nothing_is_told_of_a_law_because_of_what_its_parameters_are_called():
    """A law u = K1 (r - y), whose parameters have the names of an LQI, is no LQI."""
    names = ["pump_1.feedback.level_1", "pump_1.integral_gain.level_1", "pump_1.bias"]
    law = step_law(
        "mine",
        inputs=[cl.Signal("level_1.sp"), cl.Signal("level_1.pv")],
        parameters=[cl.Signal(name, initial=2.0) for name in names],
        state=[],
        outputs=[cl.Signal("pump_1.out")],
        equations=lambda s: Equations(
            {}, {"pump_1.out": s[names[0]] * (s["level_1.sp"] - s["level_1.pv"]) + s[names[2]]}
        ),
        description=["A law of three numbers."],
    )
    plant = cl.load("quadruple-tank")
    lqi = cl.design.lqi(plant)
    by_name = {parameter.name for parameter in lqi.law.parameters}
    assert set(names[:2]) <= by_name  # they are those of the LQI
    mine = replace(
        lqi, law=law, values=dict.fromkeys(names, 2.0), initial_state={}, manipulated=("pump_1",),
        measurements=("level_1",), setpoints=("level_1",),
    )  # fmt: skip
    assert law_words(mine) == ["A law of three numbers."]
    assert law_grids(mine, plant.process) == []
    assert (
        law_words(lqi)[0].startswith("u = u° − F x + I") and len(law_grids(lqi, plant.process)) == 2
    )
