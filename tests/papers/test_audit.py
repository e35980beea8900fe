"""The audit as a whole: its documents are folders, and processes may share its work."""

import math
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from textwrap import dedent

import pytest

from clepsydra import papers
from clepsydra.papers import audit as audits
from clepsydra.papers import side_by_side as sharing
from clepsydra.papers.document import documents, load_document
from clepsydra.papers.eight_tanks import second_order_model
from clepsydra.papers.printed_table import printed_table

TINY = {
    "__init__.py": """
        from clepsydra.papers.document import Document
        from clepsydra.papers.printed_table import printed_table

        DOCUMENT = Document(__name__, 0, "One tank", "Nobody, 2026", {"first-part": "Its area"})
        PRINTED = printed_table(__name__)
        """,
    "printed.csv": """
        place,name,line,text,unit,digits,damage,note,is_given
        section 1,diameter,3,1,m,,,,given
        section 1,area,4,0.785,m²,,,π d² / 4,
        """,
    "first_part.py": """
        from math import pi

        from clepsydra.papers.tiny_tank import PRINTED


        def run():
            (diameter,) = PRINTED.numbers("section 1", "diameter")
            area = pi * diameter**2 / 4.0
            return PRINTED.compared("section 1", {"area": area})
        """,
}


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """A document that is there because its folder is."""
    folder = tmp_path / "tiny_tank"
    folder.mkdir()
    for name, text in TINY.items():
        (folder / name).write_text(dedent(text).lstrip(), "utf-8")
    monkeypatch.setattr(papers, "__path__", [*papers.__path__, str(tmp_path)])
    yield folder
    for name in [name for name in sys.modules if name.startswith("clepsydra.papers.tiny_tank")]:
        del sys.modules[name]
    vars(papers).pop("tiny_tank", None)


def test_a_document_is_its_own_folder(tiny):
    (found,) = audits.audit(["tiny-tank"]).documents
    assert found.document.title == "One tank"
    (row,) = found.rows
    assert (row.verdict, row.unit, row.reason) == ("reproduced", "m²", "π d² / 4")
    assert (row.document, row.experiment) == ("tiny-tank", "first-part")
    assert next(iter(documents())) == "tiny-tank"  # by its number


def test_two_rows_of_one_name_are_a_mistake(tiny):
    part = tiny / "first_part.py"
    part.write_text(part.read_text("utf-8").replace("return ", "return 2 * "), "utf-8")
    with pytest.raises(AssertionError, match="more than once"):
        audits.audit(["tiny-tank"])


def test_two_lines_of_one_name_are_a_mistake(tiny):
    table = tiny / "printed.csv"
    table.write_text(table.read_text("utf-8") + "section 1,area,5,0.79,m²,,,,\n", "utf-8")
    with pytest.raises(AssertionError, match="twice"):
        documents()


@pytest.mark.thorough
@pytest.mark.parametrize("key", documents())
def test_every_line_of_a_table_is_judged_and_no_other_but_what_is_given(key, audited):
    table = printed_table(documents()[key].package)
    judged = {key for key, line in table.items() if not line.is_given}
    rows = audited(key).rows
    assert {(row.place, row.name) for row in rows} == judged
    for row in rows:  # what a note leaves open is told
        assert not set("{}") & set(row.reason), row


@pytest.mark.parametrize("key", documents())
def test_every_line_of_a_table_says_where_it_stands_and_headlines_are_claims(key):
    document = documents()[key]
    table = printed_table(document.package)
    assert all(line.line > 0 for line in table.values())
    assert len(document.headlines) == len(set(document.headlines)) > 2
    for headline in document.headlines:
        assert " " in table[headline].text  # in words


@pytest.mark.parametrize("key", documents())
def test_what_a_table_gives_is_a_number_with_which_the_code_computes(key):
    package = documents()[key].package
    folder = Path(import_module(package).__file__).parent
    code = "".join(path.read_text("utf-8") for path in folder.glob("*.py"))
    for line in printed_table(package).values():
        if line.is_given:
            # A name with what it is of, "γ, minimum phase", is put together.
            assert f'"{line.name.partition(",")[0]}' in code, line
            assert math.isfinite(line.value)


@pytest.mark.thorough
def test_processes_share_the_work_and_find_the_same(audited):
    told = []
    shared = audits.audit(["three-tanks"], workers=2, progress=told.append)
    assert shared.rows == audited("three-tanks").rows
    parts = len(load_document("three-tanks").experiments)
    assert [each.done for each in told] == list(range(1, parts + 1))
    assert {each.of for each in told} == {parts}


def test_another_document_lets_go_of_the_runs_of_one():
    kept = second_order_model._record
    audits._run(("eight-tanks", "second-order-model"))
    audits._run(("eight-tanks", "cross-references"))
    assert kept.cache_info().currsize > 0
    audits._run(("three-tanks", "cross-references"))
    assert kept.cache_info().currsize == 0


def test_a_group_stays_in_one_process_until_another_one_has_nothing_else_to_do(monkeypatch):
    monkeypatch.setattr(sharing, "ProcessPoolExecutor", lambda *_: ThreadPoolExecutor(1))
    ran, others_are_done, order = {}, threading.Event(), []

    def run(task):
        ran[task] = threading.get_ident()
        if task == "a1":
            assert others_are_done.wait(60.0)

    for task, _ in sharing.side_by_side(run, [["a1", "a2", "a3"], ["b1", "b2"]], 2):
        order.append(task)
        if len(order) == 4:
            others_are_done.set()
    assert order == ["b1", "b2", "a3", "a2", "a1"]
    first, *others = (ran[task] for task in ("a1", "a2", "a3", "b1", "b2"))
    assert {first}.isdisjoint(others) and len({*others}) == 1


def test_a_process_that_has_nothing_to_do_is_not_begun():
    assert [*sharing.side_by_side(len, [[], ["one"]], 8)] == [("one", 3)]
    assert {*sharing.side_by_side(len, [["a", "bb"], [], ["ccc"]], 2)} == {
        ("a", 1), ("bb", 2), ("ccc", 3)
    }  # fmt: skip
