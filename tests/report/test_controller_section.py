"""What the page of one controller shows."""

import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.report.html import controller_section

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
    assert ">loop_flow_asks<" in cascade[0].svg
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
