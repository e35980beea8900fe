"""Exports carry the tags of sensors and actuators, and compute what they compute without."""

import re
import zipfile
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from deployed import all_bits, run_both
from own_laws import law_of
from plants import TAGS, designed, plant, tagged
from refusals import refused
from tools import need_compiler, need_grammar

import clepsydra as cl
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.deploy.proof.text.interpreter import StructuredText

NAME = "quadruple-tank"
#: A law that has its own names for what it measures and moves.
OWN_LAW = """
from clepsydra import Signal
from clepsydra.program.step_law import Equations, step_law

law = step_law(
    "proportional",
    inputs=[Signal(n) for n in ("tank.sp", "tank.pv", "time_step")],
    parameters=[Signal("feed.gain.tank", initial=3.0)],
    state=[],
    outputs=[Signal("feed.out")],
    equations=lambda s: Equations(
        {}, {"feed.out": s["feed.gain.tank"] * (s["tank.sp"] - s["tank.pv"])}
    ),
)
"""
#: One with two measurements, which may be wired to one signal.
TWO_MEASUREMENTS = OWN_LAW.replace('"tank.pv",', '"tank.pv", "spare.pv",').replace(
    '- s["tank.pv"]', '- (s["tank.pv"] + s["spare.pv"]) / 2'
)
#: Of what a test takes every one; three of them in the fast tier.
DESIGNS = (
    "simc",
    "lqi",
    "lqi_kalman",
    "lqi_extended_kalman",
    "gain_scheduled_lqi",
    "polynomial",
    "feedback_linearisation",
    "variable_structure_pid",
    "glover_mcfarlane",
)


@cache
def of_tags(design):
    return getattr(cl.design, design)(tagged())


def in_tags(name):
    """A name of the quadruple tank with its tags."""
    return re.sub("|".join(TAGS), lambda found: TAGS[found[0]], name)


def own(of, text=OWN_LAW, measured=("level_1",)):
    wiring = {"setpoints": ["level_1"], "manipulated": ["pump_1"]}
    return cl.design.own(of, law_of(text), measurements=list(measured), **wiring)


def exported(controller, of, folder, to="st"):
    """The text of each file, comments left out, by its name without that of the process."""
    files = {
        path.name.removeprefix("quadruple_tank_"): path.read_text(encoding="utf-8")
        for path in cl.export(controller, of, folder, to=to).files
    }
    comments = r"\(\*.*?\*\)|/\*.*?\*/|<xhtml.*?</xhtml[^>]*>"
    return {name: re.sub(comments, "", text, flags=re.DOTALL) for name, text in files.items()}


@pytest.mark.sampled
@pytest.mark.parametrize("design", DESIGNS)
def test_no_name_of_the_process_file_is_left_where_there_is_a_tag(design, tmp_path):
    for to in ("st", "c"):
        for text in exported(of_tags(design), tagged(), tmp_path, to).values():
            assert "LIC101_pv" in text and "P101_out" in text
            assert not re.findall("|".join(TAGS), text)


def test_the_names_are_those_of_the_control_system_and_a_comment_names_both(tmp_path):
    (path, *_) = cl.export(of_tags("simc"), tagged(), tmp_path).files
    text = path.read_text(encoding="utf-8")
    for port in (
        "LIC101_pv",
        "LIC101_sp",
        "LIC101_good",
        "LIC101_proportional_gain",
        "P101_out",
        "P101_mode",
        "P101_status",
        "P101_fail_safe",
        "P101_last_output",
    ):
        assert re.search(rf"^  {port}(, P102_status)? : ", text, re.MULTILINE), port
    assert "  P101_loop, P102_loop : FB_PI;\n" in text
    assert re.search(r"LIC101_pv : .*; measured level_1 \(LIC101\) \*\)", text)
    assert re.search(r"P101_out : .*; voltage of pump_1 \(P101\) \*\)", text)
    assert text.count("(LIC101)") == text.count("(P101)") == 1


def test_a_number_of_a_matrix_has_the_tags_of_both_its_signals():
    ready = exportable(of_tags("lqi"), tagged().point)
    names = {signal.name for signal in ready.program.parameters}
    assert {"P101.feedback.LIC101", "P102.integral_gain.LIC101", "P101.feedback.level_3"} <= names


@pytest.mark.sampled
@pytest.mark.parametrize("design", DESIGNS)
def test_a_tagged_export_computes_the_same_bits(design):
    bare = exportable(designed(design, NAME), plant(NAME).point)
    ready = exportable(of_tags(design), tagged().point)
    scans = random_scans(bare.program, 300, 1, 1.0)
    expected = engine_run(bare.program, scans)
    found = engine_run(ready.program, {in_tags(name): v for name, v in scans.items()})
    assert np.array_equal(all_bits(found), all_bits(expected))


def test_its_c_and_its_text_compute_the_bits_of_the_untagged_engine(tmp_path):
    bare = exportable(designed("simc", NAME), plant(NAME).point)
    scans = random_scans(bare.program, 300, 1, 1.0)
    ready = exportable(of_tags("simc"), tagged().point)
    renamed = {in_tags(name): values for name, values in scans.items()}
    expected = all_bits(engine_run(bare.program, scans))
    for found in run_both(ready.program, tmp_path, renamed):
        assert np.array_equal(all_bits(found), expected)


def test_the_test_project_runs_as_without_tags(tmp_path):
    need_grammar()
    runs = []
    for of, setpoint in ((plant(NAME), "level_1_sp"), (tagged(), "lic101_sp")):
        cl.export(cl.design.simc(of), of, tmp_path)
        text = (tmp_path / "quadruple_tank_pi_simc_test.st").read_text(encoding="utf-8")
        program = StructuredText(text).instance("quadruple_tank_pi_simc_test")
        program.state[setpoint] = 7.0
        for _ in range(60):
            program.run()
        runs.append(program.state)
    bare, found = runs  # the interpreter has all names in small letters
    plain = {name: value for name, value in bare.items() if isinstance(value, int | float)}
    assert {in_tags(name).lower(): value for name, value in plain.items()}.items() <= found.items()
    assert found["lic101"] > 6.9


def test_an_fmu_and_that_of_the_process_fit_each_other(tmp_path):
    need_compiler()
    names = {}
    for what, controller in (("controller", of_tags("simc")), ("process", None)):
        for path in cl.export(controller, tagged(), tmp_path, to="fmu").files:
            text = zipfile.ZipFile(path).read("modelDescription.xml").decode()
            names.setdefault(what, []).append(set(re.findall(r'\bname="([^"]+)"', text)))
    for found in names["controller"]:
        assert {"LIC101.pv", "LIC102.sp", "P101.out", "P101_loop.integral"} <= found
    for found in names["process"]:
        assert {"LIC101", "P101", "P101.gain", "tank_1.level", "level_3"} <= found
    for found in (*names["controller"], *names["process"]):
        assert not {name for name in found if re.search("|".join(TAGS), name)}


def test_a_law_with_names_of_its_own_has_the_tags_too(tmp_path):
    text, *_ = exported(own(tagged()), tagged(), tmp_path).values()
    for port in ("LIC101_pv", "LIC101_sp", "P101_out", "P101_gain_LIC101"):
        assert re.search(rf"^  {port}(, P102_status)? : ", text, re.MULTILINE), port
    assert not re.search(r"\b(tank|feed)_(pv|sp|out|gain|mode)", text)


def test_a_tag_that_is_a_word_of_one_system_alone_is_refused_for_it(tmp_path):
    of = cl.Plant(replace(tagged().process, tags={**tagged().process.tags, "pump_1": "Ld"}))
    controller = cl.design.simc(of)
    with refused(place="tag of pump_1", value="Ld", expected="codesys", remedy="rename"):
        cl.export(controller, of, tmp_path, dialect="codesys")
    assert not list(tmp_path.iterdir())
    cl.export(controller, of, tmp_path, dialect="scl")


def test_two_measurements_wired_to_one_tag_are_refused(tmp_path):
    controller = own(tagged(), TWO_MEASUREMENTS, ("level_1", "level_1"))
    with refused(place="tag of level_1", value="LIC101", expected="tank", remedy="wire"):
        cl.export(controller, tagged(), tmp_path)
    assert not list(tmp_path.iterdir())
    # Without a tag each keeps its own name, and so it does where they are two signals.
    cl.export(own(plant(NAME), TWO_MEASUREMENTS, ("level_1", "level_1")), plant(NAME), tmp_path)
    cl.export(own(tagged(), TWO_MEASUREMENTS, ("level_1", "level_3")), tagged(), tmp_path)


def test_inside_clepsydra_the_names_stay_those_of_the_file():
    of, controller = tagged(), of_tags("simc")
    assert [signal.name for signal in of.process.inputs] == ["pump_1", "pump_2"]
    assert controller.input_wires["level_1.pv"] == "level_1"
    run = cl.simulate(of, controller, duration="1 min")
    assert "level_1" in run.values and "LIC101" not in run.values


def test_a_proof_holds_with_tags():
    need_grammar()
    proof = cl.verify(of_tags("simc"), tagged(), to="st")
    assert proof.holds and not proof.refusals


def test_tables_for_vendors_blocks_name_the_loops_by_their_tags(tmp_path):
    files = cl.export(of_tags("simc"), tagged(), tmp_path, to="tuning").files
    text = files[0].read_text(encoding="utf-8")
    assert "## LIC101 by P101\n\nLIC101 (0 to 10 V) by P101 (0 to 10 V), reverse" in text
    assert not re.search("|".join(TAGS), text)


def test_the_signals_of_a_plant_are_shown_with_their_tags():
    assert re.search(r"^ level_1 \(LIC101\) +controlled ", str(tagged()), re.MULTILINE)
    assert re.search(r"^ level_3 +measured ", str(tagged()), re.MULTILINE)
