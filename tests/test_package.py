"""What a package index shows of a built package: links that lead somewhere, or none."""

import importlib.util
import re
import subprocess
from pathlib import Path

import pytest
from tools import need

ROOT = Path(__file__).resolve().parents[1]
ADDRESS = "https://example.org/water/clock"
ANY_LINK = re.compile(r"\]\(([^)]+)\)")


@pytest.fixture(scope="module")
def hook():
    need("hatchling")
    found = importlib.util.spec_from_file_location("hatch_metadata", ROOT / "hatch_metadata.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_every_link_of_the_readme_is_absolute_and_leads_to_a_file(hook):
    readme = (ROOT / "README.md").read_text("utf-8")
    links = ANY_LINK.findall(hook.published(readme, ADDRESS))
    assert len(links) == len(ANY_LINK.findall(readme)) > 20
    for link in links:
        kind, path = re.fullmatch(rf"{ADDRESS}/(blob|raw)/HEAD/(.+)", link).groups()
        assert (ROOT / path).exists()
        assert (kind == "raw") is path.endswith(".png")


def test_without_an_address_the_words_of_links_stay_and_pictures_go(hook):
    text = "![a picture](docs/a.png) [words](docs/a.md), [kept](https://example.org)"
    assert hook.published(text, "") == " words, [kept](https://example.org)"
    assert hook.urls("") == {}


@pytest.mark.parametrize(
    "origin",
    [
        ADDRESS,
        f"{ADDRESS}.git",
        "git@example.org:water/clock.git",
        "ssh://git@example.org/water/clock.git",
        "https://name:word@example.org/water/clock.git",
    ],
)
def test_the_address_is_that_of_the_origin(hook, tmp_path, monkeypatch, origin):
    monkeypatch.delenv(hook.VARIABLE, raising=False)
    for words in (["init", "-q", "."], ["remote", "add", "origin", origin]):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    assert hook.repository(tmp_path) == ADDRESS
    assert hook.urls(ADDRESS)["Repository"] == ADDRESS


def test_a_folder_of_this_machine_is_no_address(hook, tmp_path, monkeypatch):
    monkeypatch.delenv(hook.VARIABLE, raising=False)
    assert hook.repository(tmp_path) == ""
    for words in (["init", "-q", "."], ["remote", "add", "origin", "/srv/clock"]):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    assert hook.repository(tmp_path) == ""
    monkeypatch.setenv(hook.VARIABLE, ADDRESS)
    assert hook.repository(tmp_path) == ADDRESS


def test_what_is_built_says_both(hook):
    from hatchling.metadata.core import ProjectMetadata
    from hatchling.plugin.manager import PluginManager

    metadata = ProjectMetadata(str(ROOT), PluginManager())
    address = hook.repository(ROOT)
    assert metadata.core.urls == hook.urls(address)
    assert metadata.core.readme == hook.published((ROOT / "README.md").read_text("utf-8"), address)
    assert not re.search(r"\]\((?!https?:)", metadata.core.readme)
