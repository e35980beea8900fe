"""What a second study of a plant takes over from the first, and what it never believes."""

import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import clepsydra as cl
from clepsydra.studies import kept_work
from clepsydra.studies.designs import StudiedDesign
from clepsydra.studies.kept_work import KeptWork, default_store
from clepsydra.studies.usual_tuning import UsualTuning

ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"
TUNED = "PI, SIMC, tuned"
posix = pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return the folder in which studies of this test keep what they find."""
    monkeypatch.setenv("CLEPSYDRA_CACHE", str(tmp_path / "kernels"))
    return tmp_path / "kernels" / "studies"


@pytest.fixture
def made(monkeypatch):
    """Return what is designed and tuned from now on, by name."""
    names = []
    design, tune = StudiedDesign.__call__, UsualTuning.__subclasses__()[0].run

    def designed(self, analysis):
        names.append(self.studied.name)
        return design(self, analysis)

    def tuned(self, *given):
        names.append(self.name)
        return tune(self, *given)

    monkeypatch.setattr(StudiedDesign, "__call__", designed)
    monkeypatch.setattr(UsualTuning.__subclasses__()[0], "run", tuned)
    return names


def said(study):
    """Return everything that a study says, as JSON has it."""
    return study.as_dict()


def test_a_second_study_designs_and_tunes_nothing_and_says_the_same(folder, made):
    plant = cl.load(ONE_TANK)
    first = said(cl.study(plant))
    assert "PI, SIMC" in made and "PI, gain scheduling" in made and TUNED in made
    made.clear()
    assert said(cl.study(cl.load(ONE_TANK))) == first
    assert made == []


@pytest.mark.parametrize(
    "other",
    [
        {"plant": cl.load(ONE_TANK).with_values({"tank_1.area": "29 cm^2"})},
        {"plant": cl.load(ONE_TANK).at(inputs={"pump_1": "1.6 V"})},
    ],
    ids=["parameter", "operating point"],
)
def test_another_plant_is_designed_for_anew(folder, made, other):
    cl.study(cl.load(ONE_TANK), only=TUNED)
    made.clear()
    cl.study(**other, only=TUNED)
    assert made == ["PI, SIMC", TUNED]


@pytest.mark.parametrize(
    "other",
    [{"seed": 2}, {"duration": "500 s"}, {"events": [cl.step("level_1", "+1 cm", at="10 s")]}],
    ids=["seed", "duration", "events"],
)
def test_another_scenario_is_tuned_for_anew_with_the_same_start(folder, made, other):
    cl.study(cl.load(ONE_TANK), only=TUNED)
    made.clear()
    cl.study(cl.load(ONE_TANK), only=TUNED, **other)
    assert made == [TUNED]


def test_a_tuning_of_a_study_file_is_kept_by_all_that_the_file_says_of_it(folder, tmp_path):
    written = (
        f'process = "{ONE_TANK}"\n[controllers.loop]\ndesign = "simc"\n'
        "[controllers.loop.tune]\nmaximum_sensitivity = 1.5\n"
    )
    file, heard = tmp_path / "study.toml", []

    def study(text):
        file.write_text(text, encoding="utf-8")
        heard.clear()
        found = cl.study(file, progress=lambda progress: heard.append(progress.name))
        return found.ranking[0].controller.settings, any("search" in name for name in heard)

    settings, searched = study(written)
    assert searched
    again, searched = study(f"# the same, a line below\n{written}")
    assert not searched and again == settings
    tighter, searched = study(written.replace("1.5", "1.2"))
    assert searched and tighter != settings


def question(number=7):
    return "a design", number


@pytest.fixture
def plant():
    return cl.load(ONE_TANK)


def counted():
    """Return an answer that tells how often it was looked for, and the function that looks."""
    looked = []

    def look():
        looked.append(None)
        return f"found {len(looked)}"

    return looked, look


def test_a_refusal_is_kept_with_its_reason_and_its_method(folder, plant):
    def refuse():
        raise cl.NotApplicable("it has no delay", "the Smith predictor")

    messages = []
    for compute in (refuse, lambda: 1 / 0):
        with pytest.raises(cl.NotApplicable) as caught:
            KeptWork(plant.point).outcome(question(), compute)
        messages.append((str(caught.value), caught.value.reason, caught.value.method))
    expected = "the Smith predictor is not applicable: it has no delay."
    assert messages == [(expected, "it has no delay", "the Smith predictor")] * 2


def test_what_does_not_last_and_what_cannot_be_told_is_not_kept(folder, plant):
    looked, look = counted()
    for _ in range(2):
        KeptWork(plant.point).outcome(question(), look, lasts=lambda _: False)
        KeptWork(plant.point).outcome(None, look)
    assert len(looked) == 4


@pytest.mark.parametrize(
    "what",
    ["version", "numpy", "processor", "source"],
)
def test_an_answer_of_another_version_library_or_processor_is_not_taken(
    folder, plant, monkeypatch, tmp_path, what
):
    looked, look = counted()
    kept_work._computed_by.cache_clear()
    KeptWork(plant.point).outcome(question(), look)
    if what == "version":
        monkeypatch.setattr(cl, "__version__", "0.0.9")
    elif what == "numpy":
        monkeypatch.setattr(kept_work.np, "__version__", "1.0")
    elif what == "processor":
        other = replace(kept_work.host(), name="another")
        monkeypatch.setattr(kept_work, "host", lambda: other)
    else:
        (tmp_path / "package").mkdir()
        (tmp_path / "package" / "changed.py").touch()
        monkeypatch.setattr(cl, "__file__", str(tmp_path / "package" / "__init__.py"))
    kept_work._computed_by.cache_clear()
    KeptWork(plant.point).outcome(question(), look)
    kept_work._computed_by.cache_clear()
    assert len(looked) == 2


class FromElsewhere:
    """What a user's own file defines."""


def test_what_code_from_elsewhere_has_a_part_in_is_not_kept(folder, plant):
    looked, look = counted()
    for _ in range(2):
        KeptWork(plant.point).outcome((FromElsewhere(), 1), look)
    assert len(looked) == 2
    for _ in range(2):
        found = KeptWork(plant.point).outcome(question(), FromElsewhere)
        assert type(found) is FromElsewhere
    assert not folder.exists() or list(folder.iterdir()) == []


def test_controllers_of_one_law_come_back_with_one_law(folder, plant):
    simc, lambda_tuning = cl.design.simc(plant), cl.design.lambda_(plant)
    assert simc.law is lambda_tuning.law
    first = KeptWork(plant.point)
    first.outcome("a", lambda: simc)
    first.outcome("b", lambda: lambda_tuning)
    second = KeptWork(plant.point)
    one, other = second.outcome("a", lambda: 1 / 0), second.outcome("b", lambda: 1 / 0)
    assert one.law is other.law and one.law is not simc.law
    assert (one.values, other.values) == (simc.values, lambda_tuning.values)


def damaged(folder: Path, damage) -> None:
    for file in folder.iterdir():
        file.write_bytes(damage(file.read_bytes()))


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[: len(content) // 2],
        lambda content: content + b"\0",
        lambda content: pickle.dumps("planted"),
    ],
    ids=["empty", "half", "longer", "planted"],
)
def test_what_is_damaged_or_planted_is_found_anew_and_replaced(folder, plant, damage):
    look = counted()[1]
    assert KeptWork(plant.point).outcome(question(), look) == "found 1"
    damaged(folder, damage)
    assert KeptWork(plant.point).outcome(question(), look) == "found 2"
    assert KeptWork(plant.point).outcome(question(), look) == "found 2"


def test_a_controller_whose_law_is_gone_is_designed_anew(folder, plant):
    KeptWork(plant.point).outcome(question(), lambda: cl.design.simc(plant))
    largest = max(folder.iterdir(), key=lambda file: file.stat().st_size)
    largest.unlink()
    found = KeptWork(plant.point).outcome(question(), lambda: "designed anew")
    assert found == "designed anew"


@posix
@pytest.mark.parametrize("how", ["a file", "open to others"])
def test_a_folder_that_cannot_be_used_costs_a_design_and_no_study(folder, plant, how):
    folder.parent.mkdir(mode=0o700)
    if how == "a file":
        folder.touch()
    else:
        folder.mkdir()
        folder.chmod(0o777)
    looked, look = counted()
    for _ in range(2):
        KeptWork(plant.point).outcome(question(), look)
    assert len(looked) == 2
    assert cl.study(plant, only="PI, SIMC").best.controller.name == "PI, SIMC"


@posix
def test_a_full_disk_costs_a_design_and_leaves_nothing(folder, plant, monkeypatch):
    def no_room(*given):
        raise OSError(28, "no space left on device")

    monkeypatch.setattr(os, "rename", no_room)
    looked, look = counted()
    for _ in range(2):
        KeptWork(plant.point).outcome(question(), look)
    assert len(looked) == 2 and list(folder.iterdir()) == []


STUDY = """
import sys
import clepsydra as cl
sys.stdin.readline()
found = cl.study(sys.argv[1], only="PI, SIMC, tuned")
print([each.scores for each in found.ranking])
"""


@pytest.mark.thorough
def test_two_studies_at_once_in_one_fresh_folder_find_the_same(folder):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    both = [
        subprocess.Popen(
            [sys.executable, "-c", STUDY, str(ONE_TANK)],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True,
        )
        for _ in range(2)
    ]  # fmt: skip
    for each in both:
        each.stdin.write("go\n")
        each.stdin.flush()
    answers = [each.communicate() for each in both]
    assert [each.returncode for each in both] == [0, 0], answers
    assert answers[0] == answers[1] and answers[0][1] == ""
    assert default_store().folder == folder
    alone = cl.study(str(ONE_TANK), only=TUNED)
    assert str([each.scores for each in alone.ranking]) == answers[0][0].strip()
