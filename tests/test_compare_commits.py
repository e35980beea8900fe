"""Two commits are compared by what the command line prints and writes."""

from __future__ import annotations

import datetime
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import wait_until

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

from compare_commits import command, runner, screen
from compare_commits.commits import Commit, find_commit
from compare_commits.comparison import Comparison, compare
from compare_commits.difference import ABSENT, Bound, Difference, differences
from compare_commits.kept import Kept
from compare_commits.outputs import Normaliser, read_file, read_printed
from compare_commits.plan import EXPORTS, TUNING_OF_ONE_IN, Command, following
from compare_commits.runner import STOPPED

ROOT = Path(__file__).resolve().parents[1]
STARTED = datetime.datetime(2030, 5, 6, 7, 8, tzinfo=datetime.UTC)
SIMULATE = Command("simulate", "quadruple-tank", "", (("simulate", "quadruple-tank", "--json"),))


def found(first: object, second: object, bound: Bound | None = None) -> list[tuple]:
    """Return kind, place and values of each difference."""
    every = differences(first, second, bound or Bound())
    return [(one.kind, one.place, one.first, one.second) for one in every]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (1.0, 1.0 + 0.9e-9),
        (-3e8, -3e8 * (1 + 0.9e-9)),
        (0.0, 0.9e-14),
        (2e-15, -3e-15),
        (1, 1.0),
        (math.nan, math.nan),
        (-math.inf, -math.inf),
        (None, None),
        ("a", "a"),
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}),
    ],
)
def test_what_lies_within_the_bound_is_no_difference(first: object, second: object) -> None:
    assert found({"a": first}, {"a": second}) == []


@pytest.mark.parametrize(
    ("first", "second", "kind"),
    [
        (1.0, 1.0 + 1.1e-9, "number"),
        (1e-6, 1e-6 * (1 + 1.1e-8), "number"),
        (0.0, 1.1e-14, "number"),
        (math.nan, 1.0, "number"),
        (math.inf, -math.inf, "number"),
        (None, 1.0, "number"),
        (True, 1, "text"),
        ("1", 1, "text"),
        ("19 % below", "18 % below", "text"),
        ([], {}, "text"),
    ],
)
def test_what_lies_beyond_it_is_one(first: object, second: object, kind: str) -> None:
    assert found({"a": first}, {"a": second}) == [(kind, "a", first, second)]
    assert found({"a": second}, {"a": first}) == [(kind, "a", second, first)]


def test_bound_and_floor_are_settable() -> None:
    assert found({"a": 1.0}, {"a": 1.05}, Bound(relative=0.1)) == []
    assert found({"a": 1.0}, {"a": 1.05}, Bound(floor=0.06)) == []
    assert [entry[0] for entry in found({"a": 1.0}, {"a": 1.05}, Bound(0.04, 0.04))] == ["number"]


def test_keys_come_and_go() -> None:
    assert found({"a": {"b": 1, "c": 2}}, {"a": {"c": 2, "d": 3}}) == [
        ("gone", "a.b", 1, ABSENT),
        ("came", "a.d", ABSENT, 3),
    ]


def test_lists_of_other_length() -> None:
    assert found({"a": [1, 2, 3]}, {"a": [1, 5]}) == [
        ("number", "a[1]", 2, 5),
        ("gone", "a[2]", 3, ABSENT),
    ]


def test_a_list_of_named_objects_is_compared_by_name() -> None:
    named = (("PI", 1), ("PID", 2), ("LQI", 3))
    pi, pid, lqi = ({"controller": name, "iae": iae} for name, iae in named)
    ranked = {"ranking": [pi, pid]}
    assert found(ranked, {"ranking": [lqi, pi, pid]}) == [("came", "ranking[LQI]", ABSENT, lqi)]
    assert found(ranked, {"ranking": [pid, {**pi, "iae": 1.5}]}) == [
        ("number", "ranking[PI].iae", 1, 1.5),
        ("order", "ranking", ["PI", "PID"], ["PID", "PI"]),
    ]
    twice = {"ranking": [pi, pi]}  # no name tells these apart
    assert [entry[:2] for entry in found(twice, ranked)] == [
        ("text", "ranking[1].controller"),
        ("number", "ranking[1].iae"),
    ]


def record(shown: dict, verb: str = "study") -> dict:
    """Return what is kept of a command."""
    return {"group": verb, "shown": shown, "left out": {"paths": 2}}


def run_of(status: object, printed: object = "", messages: str = "") -> dict:
    """Return what one command line showed."""
    return {"run": {"status": status, "printed": printed, "messages": messages}, "files": {}}


def test_exit_status_and_what_ran_on_one_side_only() -> None:
    first = {"study a": record(run_of(0, {"a": 1})), "study b": record(run_of(0))}
    second = {"study a": record(run_of(2, "", "wrong")), "draw c": record(run_of(0), "draw")}
    kinds = [(d.command, d.kind, d.place) for d in compare(first, second, Bound()).differences]
    assert kinds == [
        ("draw c", "came", "command"),
        ("study a", "status", "status"),
        ("study a", "text", "printed"),
        ("study a", "text", "messages"),
        ("study b", "gone", "command"),
    ]


def test_a_status_of_the_plant_is_a_number() -> None:
    first, second = ({"study a": record(run_of(0, {"status": s}))} for s in (1, 2))
    assert [d.kind for d in compare(first, second, Bound()).differences] == ["number"]


def test_a_command_that_was_stopped_is_told_once_even_where_both_were() -> None:
    stopped = {"study a": record(run_of(STOPPED, "half"))}
    whole = {"study a": record(run_of(0, "whole"))}
    for first, second in ((stopped, whole), (whole, stopped), (stopped, stopped)):
        assert [d.kind for d in compare(first, second, Bound()).differences] == ["stopped"]


def normaliser(verb: str = "study") -> Normaliser:
    """Return that of a run in /tmp/x of a checkout in /tmp/x/y."""
    paths = {"/tmp/x": "<folder>", "/tmp/x/y": "<checkout>"}
    return Normaliser(verb, paths, "1.2.0", STARTED)


@pytest.mark.parametrize(
    ("text", "clean"),
    [
        ("wrote /tmp/x/out.html by /tmp/x/y/src", "wrote <folder>/out.html by <checkout>/src"),
        ("Printed by Clepsydra 1.2.0; digest", "Printed by Clepsydra <version>; digest"),
        ('productVersion="1.2.0"', 'productVersion="<version>"'),
        ("clepsydra 1.2.01 and numpy 1.2.0", "clepsydra 1.2.01 and numpy 1.2.0"),
        ("on 2030-05-06T07:09:10.5Z", "on <date>"),
        ("on 2030-05-06 11:08", "on <date>"),
        ("as of 2012-04-01T00:00:00Z, S7 2030-05-06", "as of 2012-04-01T00:00:00Z, S7 2030-05-06"),
        ("settles in 24.5 s", "settles in 24.5 s"),
    ],
)  # fmt: skip
def test_a_run_is_taken_out_of_a_text_and_nothing_else(text: str, clean: str) -> None:
    assert normaliser().text(text) == clean


def test_times_and_versions_are_taken_out_by_their_keys_where_these_are_known() -> None:
    text = json.dumps({"seconds": 1.5, "rows": [{"seconds": 2, "largest": 0.5}], "versions": []})
    of_proof = normaliser("verify")
    assert read_printed(text, of_proof) == {"rows": [{"largest": 0.5}]}
    assert of_proof.left_out == {"times": 2, "versions": 1, "paths": 0}
    assert read_printed(text, normaliser("study")) == json.loads(text)


def test_a_proof_page_differs_by_its_verdicts_and_not_by_its_times() -> None:
    table = "| target | largest | s |\n| --- | --- | --- |\n| C | {} | {} |\n\n"
    page = table + "10 scans, seed 1; gcc {}.\n"

    def clean(*values: object) -> str:
        return normaliser("verify").markdown(page.format(*values))

    assert clean(0, 1.5, "12.2") == clean(0, 7.0, "13.1")
    assert clean(0, 1.5, "12.2") != clean(1, 1.5, "12.2")
    assert normaliser("export st").markdown(page) == page.rstrip("\n")


def test_a_table_is_compared_by_its_columns() -> None:
    def columns(*rows: tuple[float, float, str]) -> object:
        text = "time [s],level [m],controller\n" + "".join(f"{t},{v},{c}\n" for t, v, c in rows)
        return read_file("run.csv", text.encode(), normaliser())

    first = columns((0, 0.1, "PI"), (1, 0.2, "PI"), (2, 0.4, "PID"))
    assert found(first, columns((0, 0.1, "PI"), (1, 0.2, "PI"), (2, 0.4, "PID"))) == []
    close = columns((0, 0.1, "PI"), (1, 0.2 * (1 + 1e-12), "PI"), (2, 0.4, "PID"))
    assert found(first, close) == []
    swapped = columns((0, 0.2, "PI"), (1, 0.1, "PI"), (2, 0.4, "PID"))
    assert {entry[1].split(".")[1] for entry in found(first, swapped)} == {"level [m]"}
    renamed = columns((0, 0.1, "PI"), (1, 0.2, "LQ"), (2, 0.4, "PID"))
    assert [entry[:2] for entry in found(first, renamed)] == [("text", "columns.controller")]
    assert ("number", "rows", 3, 2) in found(first, columns((0, 0.1, "PI"), (1, 0.2, "PI")))


def test_to_what_a_controller_is_exported_depends_on_no_other() -> None:
    study = Command("study", "tank", "", ())

    def exported(*names: str) -> set[str]:
        ranking = {"ranking": [{"controller": name} for name in names]}
        return {one.label for one in following(study, ranking)}

    names = [f"PI {number}" for number in range(400)]
    every = exported(*names)
    assert every == exported(*names[:80]) | exported(*reversed(names[80:]))
    assert sum(of_sixteen for _, _, of_sixteen in EXPORTS) == 16
    for target, _, of_sixteen in (*EXPORTS, ("tuning", (), 16 / TUNING_OF_ONE_IN)):
        share = sum(label.startswith(f"export {target} tank PI") for label in every)
        # Five standard deviations of a fair choice.
        expected = 400 * of_sixteen / 16
        assert abs(share - expected) < 5 * math.sqrt(expected), target


def test_a_plan_survives_what_is_no_document() -> None:
    for printed in ("", None, [], {"processes": "none"}, {"ranking": [1]}, {"inputs": []}):
        for verb in ("processes", "analyse", "study", "draw"):
            assert isinstance(following(Command(verb, "tank", "", ()), printed), list)


def many() -> Comparison:
    """Return a comparison with forty kinds of place."""
    first = {f"study {n}": record(run_of(0, {f"{w}": 1.0 for w in WORDS})) for n in range(3)}
    second = {f"study {n}": record(run_of(0, {f"{w}": 1.5 for w in WORDS})) for n in range(3)}
    return compare(first, second, Bound())


WORDS = [f"{a}{b}" for a in "abcdefgh" for b in "vwxyz"]


@pytest.mark.parametrize(
    ("path", "place", "pattern"),
    [
        (("run", "printed"), "printed", "printed"),
        (("run", "status"), "status", "status"),
        (("run", "printed", "A", "[0]", "[1]"), "A[0][1]", "A[][]"),
        (
            ("step 2", "printed", "ranking", "[PI, SIMC]", "scores", "iae[level_1]"),
            "step 2.printed.ranking[PI, SIMC].scores.iae[level_1]",
            "step #.printed.ranking[]",
        ),
        (
            ("run", "printed", "ranking", "[PI, SIMC]", "scores", "iae[level_1]"),
            "ranking[PI, SIMC].scores.iae[level_1]",
            "ranking[].scores.iae[]",
        ),
        (("files", "a.fmu", "b.c"), "files.a.fmu.b.c", "files.*.fmu.b.c"),
    ],
)  # fmt: skip
def test_places_are_counted_by_a_pattern(path: tuple[str, ...], place: str, pattern: str) -> None:
    difference = Difference("study a", "study", path, "text", 1, 2)
    assert (difference.place, difference.pattern) == (place, pattern)


def test_a_screen_holds_25_lines_and_all_of_it_every_difference() -> None:
    one, other = Commit("old", "0" * 40), Commit(".", "tree-1")
    comparison = many()
    lines = screen.screen(comparison, one, other).splitlines()
    assert len(lines) <= 25 and max(map(len, lines)) <= 100
    assert "120 differences in 3 commands: 120 number" in lines
    assert "     3 number      study: av  at most 3.3e-01" in lines
    text = screen.whole(comparison, one, other)
    assert all(f"  {word}: 1 -> 1.5" in text for word in WORDS)
    document = json.loads(screen.document(comparison, one, other))
    assert len(document["differences"]) == 120 and document["counts"] == {"number": 120}
    assert document["left_out"] == {"times": 0, "versions": 0, "paths": 12, "dates": 0}


def test_a_record_is_kept_for_its_command_line_alone(tmp_path: Path) -> None:
    kept = Kept(tmp_path, "0" * 40)
    kept.store(SIMULATE, {"steps": [list(SIMULATE.steps[0])], "a": 1})
    assert Kept(tmp_path, "0" * 40).load(SIMULATE)["a"] == 1
    assert Kept(tmp_path, "1" * 40).load(SIMULATE) is None
    other = Command("simulate", "quadruple-tank", "", (("simulate", "three-tanks"),))
    assert kept.load(other) is None


def git(folder: Path, *arguments: str) -> None:
    """Run git as somebody."""
    who = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", *who, "-C", str(folder), *arguments], check=True, capture_output=True)


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a repository of these sources with two commits; in the later, pump 1 gives more."""
    if shutil.which("git") is None:
        pytest.skip("no git")
    folder = tmp_path_factory.mktemp("repository").resolve()
    shutil.copytree(ROOT / "src", folder / "src", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", ".gitignore"):
        shutil.copyfile(ROOT / name, folder / name)
    git(folder, "init", "--quiet")
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "First")
    file = folder / "src/clepsydra/process/catalogue/quadruple-tank.toml"
    text = file.read_text(encoding="utf-8")
    assert text.count('gain = "3.33 cm^3/(s V)"') == 1
    file.write_text(text.replace('gain = "3.33 ', 'gain = "3.34 '), encoding="utf-8")
    git(folder, "commit", "--quiet", "--all", "--message", "Give pump 1 more")
    return folder


def compared(
    repository: Path, tmp_path: Path, old: str, new: str, limit: float = 120
) -> Comparison:
    """Compare two commits by one command."""
    first, second = find_commit(repository, old), find_commit(repository, new)
    cache = tmp_path / "cache"
    return command.run(repository, first, second, Bound(), cache, limit, [SIMULATE])


@pytest.mark.thorough
def test_a_commit_equals_itself_and_another_number_is_found(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(runner, "WARM_UP", [])
    same = compared(repository, tmp_path, "HEAD", "HEAD")
    assert same.differences == [] and same.first[SIMULATE.label]["shown"]["run"]["status"] == 0
    assert capsys.readouterr().err.count("1 of 1 commands run now") == 2

    other = compared(repository, tmp_path, "HEAD~1", "HEAD")
    assert "0 of 1 commands run now" in capsys.readouterr().err  # HEAD was kept
    found_levels = [d for d in other.differences if d.place == "signals.level_1.start"]
    assert [d.kind for d in found_levels] == ["number"]
    # Outflow as the root of the level: 0.7 of pump 1 and 0.4 of pump 2 go through tank 1.
    inflows = [0.7 * gain + 0.4 * 3.35 for gain in (3.33, 3.34)]
    levels = found_levels[0].second / found_levels[0].first
    assert levels == pytest.approx((inflows[1] / inflows[0]) ** 2, rel=1e-5)
    assert not any(".pump_2." in d.place for d in other.differences)
    listed = subprocess.run(["git", "-C", repository, "worktree", "list"], capture_output=True)
    assert len(listed.stdout.splitlines()) == 1  # nothing stays checked out

    # What was printed is what the command prints where it is run by itself.
    alone = subprocess.run(
        [sys.executable, "-m", "clepsydra", *SIMULATE.steps[0]], cwd=tmp_path, capture_output=True,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(repository / "src")}, check=True,
    )  # fmt: skip
    assert same.first[SIMULATE.label]["shown"]["run"]["printed"] == json.loads(alone.stdout)


def is_alive(process: str) -> bool:
    """Return whether a process runs; one that only waits for its parent to notice does not."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False


@pytest.mark.thorough
def test_a_changed_working_tree_hangs_and_is_stopped_with_what_it_began(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "WARM_UP", [])
    assert find_commit(repository, ".").key == find_commit(repository, "HEAD").key
    begun = tmp_path / "begun"
    (repository / "src/clepsydra/__main__.py").write_text(
        "import subprocess\n"
        "process = subprocess.Popen(['sleep', '600'])\n"
        f"open({str(begun)!r}, 'a').write(f'{{process.pid}}\\n')\n"
        "process.wait()\n"
    )
    try:
        assert find_commit(repository, ".").is_tree
        hung = compared(repository, tmp_path, ".", ".", limit=10)
    finally:
        git(repository, "checkout", "--quiet", "--", ".")
    assert [(d.kind, d.first, d.second) for d in hung.differences] == [
        ("stopped", STOPPED, STOPPED)
    ]
    sleeping = begun.read_text().split()
    assert len(sleeping) == 2
    wait_until(lambda: not any(map(is_alive, sleeping)))
    assert not list((tmp_path / "cache").rglob("*.json"))  # and it is run again the next time


@pytest.mark.skipif(shutil.which("git") is None, reason="no git")
def test_what_is_no_commit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command.main(["HEAD"]) == 2
    assert "no git repository" in capsys.readouterr().err
    git(tmp_path, "init", "--quiet")
    assert command.main(["HEAD"]) == 2
    assert capsys.readouterr().err.startswith("HEAD: no commit of")
