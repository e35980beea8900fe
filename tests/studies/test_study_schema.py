"""The schema for editors knows every study file of the tree, and refuses what the reader does."""

import json
import subprocess
import sys
import tomllib

import pytest
from json_schema import faults
from pages import PAGES, blocks
from study_texts import BASIN, LOOP, loop

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.studies.file.reader import read_study, study_schema

SCHEMA = study_schema()
SHOWN = [
    pytest.param(block, id=block.place)
    for page in PAGES
    for block in blocks(page, "toml")
    if block.table.keys() & {"controllers", "scenario", "ranking", "process"}
    and "tasks" not in block.table
]


def refused(text):
    tables = tomllib.loads(text)
    return list(faults({"process": "equalisation-tank", **tables}, SCHEMA))


@pytest.mark.parametrize("block", SHOWN)
def test_it_fits_what_the_pages_show(block):
    assert refused(block.text) == []


@pytest.mark.sampled
@pytest.mark.parametrize("name", catalogue_names())
def test_it_fits_the_file_to_begin_with(name, tmp_path):
    assert refused(cl.new_study("mine", name, folder=tmp_path).read_text(encoding="utf-8")) == []


DESIGN = BASIN + '[controllers.a]\ndesign = "simc"\n'
STEP = BASIN + '[scenario]\nduration = "6 h"\n[[scenario.setpoint]]\nsignal = "level"\n'


@pytest.mark.parametrize(
    "text",
    [
        BASIN + "scenaro = 1",
        BASIN + "seed = -1",
        BASIN + "seed = 1.5",
        BASIN + "[ranking]",
        BASIN + '[ranking]\nscores = "iae"',
        BASIN + '[scenario]\nnoise = "5 h"',
        STEP + 'at = "1 h"',
        STEP + 'at = "1 h"\nto = "60 %"\nby = "10 %"',
        STEP + 'to = "60 %"',
        BASIN + "[controllers.a]",
        BASIN + '[controllers.a]\ndesign = "smic"',
        DESIGN + 'arrest_time = "1 h"',
        DESIGN + "closed_loop_time_constant = 300",
        DESIGN + 'actions = "I"',
        DESIGN + 'law = "a.py"',
        DESIGN + '[controllers.a.tune]\nmethod = "sum"',
        BASIN + '[controllers.a]\ndesign = "lqi_by_weights"',
        BASIN + '[controllers.a]\ndesign = "lqi"\nanti_windup = "variable_structure"',
        loop(actions=None),
        loop(action='"up"'),
        loop(gian='"2 %/%"'),
        BASIN + LOOP + "[controllers.a.outputs.outflow]\nlowest = 1",
        BASIN + LOOP + '[controllers.a.selectors.s]\nselect = "mean"\noutput = "outflow"',
        BASIN + '[controllers.a.start_stop]\nmeasurement = "level"',
        BASIN + '[controllers.a]\nfuzzy = "a.toml"\nactions = "PI"',
    ],
)
def test_it_refuses_what_the_reader_refuses(text, tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(Exception, match=r"study\.toml"):
        read_study(path)
    assert refused(text) != []


def test_it_fits_the_right_ones():
    assert refused(DESIGN) == refused(BASIN + LOOP) == refused(BASIN) == []


@pytest.mark.parametrize("options", [["new", "--study"], ["new"], ["processes"]])
def test_the_command_prints_it(options):
    command = [sys.executable, "-m", "clepsydra", *options, "--schema"]
    shown = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    assert (shown == json.loads(json.dumps(SCHEMA))) == ("--study" in options)
    assert shown["title"].startswith("Clepsydra")
