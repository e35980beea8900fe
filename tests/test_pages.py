"""What README and docs print does what they say: each page in its order, in one folder."""

import json
import re

import pytest
import typer
from pages import ACTIVATE, ELSEWHERE, PAGES, ROOT, blocks, command, lines
from PIL import Image
from rich.console import Console
from tools import need, need_compiler

import clepsydra as cl
from clepsydra.cli.application import application

LANGUAGES = {"sh", "python", "pycon", "toml", "c", "js", "iecst", "csv", "text"}
COMMANDS = [block for page in PAGES for block in blocks(page, "sh")]


@pytest.mark.parametrize("page", PAGES)
def test_every_block_has_a_language(page):
    assert {block.language for block in blocks(page)} <= LANGUAGES
    assert len(re.findall(r"^ *```", (ROOT / page).read_text(), re.MULTILINE)) == 2 * len(
        blocks(page)
    )


def test_what_is_not_run_says_why():
    left_out = [block for page in PAGES for block in blocks(page) if block.not_run]
    assert all(len(block.not_run.split()) >= 3 for block in left_out)
    assert [block.page for block in left_out] == ["README.md", "docs/study-files.md"]


@pytest.mark.parametrize("block", COMMANDS, ids=lambda block: block.place)
def test_verbs_and_options_are_those_of_the_command_line(block):
    group = typer.main.get_command(application())
    context = group.make_context("clepsydra", [], resilient_parsing=True)
    for program, *words in lines(block.text):
        if program == "clepsydra":
            name, verb, rest = group.resolve_command(context, words)
            assert verb.make_context(name, rest, parent=context).params, words


@pytest.mark.parametrize("page", PAGES)
def test_python_is_python(page):
    for block in blocks(page, "python"):
        compile(block.text, block.place, "exec")


def test_what_runs_elsewhere_stands_on_a_page():
    for line, file in ELSEWHERE.items():
        assert any(line in block.text for block in COMMANDS), line
        assert (ROOT / file).exists()


@pytest.mark.thorough
@pytest.mark.parametrize("page", [p for p in PAGES if any(b.runs for b in blocks(p))])
def test_the_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    todo = [block for block in blocks(page) if block.runs]
    if any(re.search("clepsydra verify|--to fmu|^cc ", block.text, re.M) for block in todo):
        need_compiler()
        need("fmpy", "tree_sitter_iec61131_3_st", "wasmtime")
    names = {}
    for block in todo:
        block.run(tmp_path, names)


def commands_of(page, *verbs):
    """Return the commands of a page with one of these verbs, each as its words."""
    return [
        words
        for block in blocks(page, "sh")
        for words in lines(block.text)
        if words[0] == "clepsydra" and words[1] in verbs
    ]


def test_the_first_line_of_the_readme_writes_where_git_ignores_it():
    (line, _) = next(b.text for b in blocks("README.md", "sh") if b.not_run).splitlines()
    (folder,) = re.findall(r"clepsydra study quadruple-tank -o (\S+)$", line)
    assert f"/{folder}/" in (ROOT / ".gitignore").read_text().splitlines()


def test_the_readme_activates_what_it_installed_before_it_calls_it_by_its_name():
    first = next(b for b in blocks("README.md", "sh") if not b.not_run)
    assert lines(first.text)[0] == ACTIVATE
    installed = next(b.text for b in blocks("README.md", "sh") if b.not_run)
    assert (
        f"pip --python {ACTIVATE[1].removesuffix('activate')}python install --no-compile"
        in installed
    )


def test_the_record_of_the_readme_gives_the_settings_of_the_study_of_its_tank(
    tmp_path, monkeypatch, capsys
):
    """Its pump moves by as much, and as briefly, as for the step of the study: K Δy = Δu."""
    monkeypatch.chdir(tmp_path)
    for words in commands_of("README.md", "new", "simulate"):
        if "my-tanks" in words[2] and ("new" in words or "csv" in words):
            command(words[1:], tmp_path, "README.md")
    (identify,) = commands_of("README.md", "identify")
    capsys.readouterr()
    command([*identify[1:], "--json"], tmp_path, "README.md")
    document = json.loads(capsys.readouterr().out)
    found = document["models"][0]["settings"]
    designed = cl.design.simc("my-tanks.toml").values
    assert found["gain_unit"] == "V/m"
    assert found["gain"] == pytest.approx(designed["level_1.proportional_gain"], rel=0.15)
    assert found["integral_time"] == pytest.approx(designed["level_1.integral_time"], rel=0.15)


@pytest.mark.thorough
def test_the_picture_of_the_readme_shows_what_its_study_finds(studied):
    """Where it does not, .ci/report_picture.py makes it again."""
    with Image.open(ROOT / "docs" / "report.png") as picture:
        assert picture.text["Description"] == studied("quadruple-tank").verdict


@pytest.mark.thorough
def test_the_pictures_and_words_of_robustness_are_what_it_finds():
    """Where they are not, .ci/robustness_pictures.py makes them again."""
    plant = cl.load("quadruple-tank")
    found = cl.robustness(cl.design.simc(plant), plant)
    for name in ("fan", "worst", "causes"):
        with Image.open(ROOT / "docs" / f"robustness-{name}.png") as picture:
            assert picture.text["Description"] == found.answer().parts[0].text
    (told,) = (block.text for block in blocks("docs/robustness.md", "text"))
    console = Console(width=80)
    with console.capture() as shown:
        console.print(found)
    assert told.split() == shown.get().split()[: len(told.split())]


@pytest.mark.thorough
def test_the_readme_begins_with_what_its_study_prints(studied):
    """Numbers within what a tuning leaves to the last digits of another processor."""
    (told,) = (block.text for block in blocks("README.md", "text"))
    console = Console(width=80)
    with console.capture() as shown:
        console.print(studied("quadruple-tank"))
    length = len(told.splitlines())
    printed = "\n".join(line.rstrip() for line in shown.get().splitlines()[:length])
    number = re.compile(r"\d+(?:\.\d+)?")
    assert number.sub("#", told).split() == number.sub("#", printed).split()
    values = [[float(each) for each in number.findall(text)] for text in (told, printed)]
    assert values[0] == pytest.approx(values[1], rel=0.05)
