"""The archive: what is in it, that it is the same each time, and what is refused."""

import ctypes
import platform
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import fmpy
import pytest
from fmus import VERSIONS, written
from models import exchange_of, origin, pi_model, pi_program, process_of
from refusals import refused

from clepsydra import InputError
from clepsydra.deploy.compiler import CompilationError, find_compiler
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.write import platform_folder, write_fmu

HEADERS = Path(fmpy.__file__).parent / "c-code"


def functions_of(version: str) -> set[str]:
    """The functions that the standard's own header declares."""
    number = version[0]
    text = (HEADERS / f"fmi{number}Functions.h").read_text(encoding="utf-8")
    return set(re.findall(rf"\bfmi{number}[A-Z]\w*TYPE\s+(fmi{number}\w+);", text))


MODELS = {"controller": pi_model, "exchange": lambda: exchange_of("wet-well")}
each = pytest.mark.parametrize(
    ("kind", "version"), [(kind, version) for kind in MODELS for version in VERSIONS]
)


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """Return a function that writes a model once; it returns model, path, unpacked folder."""

    @cache
    def of(kind: str, version: str):
        folder, model = tmp_path_factory.mktemp(kind), MODELS[kind]()
        path = written(model, folder, version)
        return model, path, fmpy.extract(str(path), str(folder / "unpacked"))

    return of


@pytest.mark.thorough
@each
def test_the_binary_has_every_function_of_the_standard_and_no_other(kind, version, unpacked):
    model, _, folder = unpacked(kind, version)
    (binary,) = Path(folder, "binaries").glob("*/*")
    assert binary.stem == model.name
    library = ctypes.CDLL(str(binary))
    declared = functions_of(version)
    assert len(declared) > 40
    assert [name for name in sorted(declared) if not hasattr(library, name)] == []
    hidden = [f"{program.name}_step" for program in model.programs]
    if sys.platform != "win32":
        assert not any(hasattr(library, name) for name in hidden)


@pytest.mark.thorough
@each
def test_the_functions_fit_the_prototypes_of_the_standard(kind, version, unpacked):
    """The standard's headers come first, and the compiler checks every definition by them."""
    _, _, folder = unpacked(kind, version)
    number = version[0]
    command = [
        *find_compiler("tests").command, "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror",
        "-fsyntax-only", f"-I{HEADERS}", "-include", f"fmi{number}Functions.h", f"fmi{number}.c",
    ]  # fmt: skip
    done = subprocess.run(
        command, cwd=Path(folder, "sources"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("version", VERSIONS)
def test_several_models_can_be_linked_into_one_program(version, tmp_path, unpacked):
    """With a prefix on the command line, as the standard has it for static linking."""
    _, _, folder = unpacked("controller", version)
    number, target = version[0], tmp_path / "object.so"
    command = [
        *find_compiler("tests").command, "-std=c99", f"-DFMI{number}_FUNCTION_PREFIX=own_",
        "-shared", "-fPIC", "-o", str(target), f"fmi{number}.c", "quadruple_tank_pi.c", "-lm",
    ]  # fmt: skip
    subprocess.run(command, cwd=Path(folder, "sources"), check=True)
    library = ctypes.CDLL(str(target))
    assert hasattr(library, f"own_fmi{number}GetVersion")
    assert not hasattr(library, f"fmi{number}GetVersion")


@pytest.mark.thorough
@pytest.mark.parametrize("version", VERSIONS)
def test_the_same_model_gives_the_same_file(version, tmp_path, unpacked):
    _, path, _ = unpacked("controller", version)
    assert written(pi_model(), tmp_path, version).read_bytes() == path.read_bytes()


@pytest.mark.thorough
@pytest.mark.parametrize("version", VERSIONS)
def test_the_sources_build_what_the_description_says(version, tmp_path):
    """Only the files that are named are compiled, as an importer would."""
    model = process_of("quadruple-tank")
    path = tmp_path / "sources.fmu"
    write_fmu(path, model, None, version=version, sources_only=True)
    with zipfile.ZipFile(path) as archive:
        assert not any(name.startswith("binaries/") for name in archive.namelist())
        archive.extractall(tmp_path)
        if version == "3.0":
            build = archive.read("sources/buildDescription.xml").decode()
            named = re.findall(r'SourceFile name="([^"]+)"', build)
        else:
            text = archive.read("modelDescription.xml").decode()
            named = re.findall(r'File name="([^"]+)"', text)
    assert f"{model.name}.c" in named
    sources = [tmp_path / "sources" / name for name in named]
    library = find_compiler("tests").build(sources, tmp_path / "built.so")
    number = version[0]
    get_version = getattr(ctypes.CDLL(str(library)), f"fmi{number}GetVersion")
    get_version.restype = ctypes.c_char_p
    assert get_version() == version.encode()


def test_without_a_compiler_the_binary_is_refused_with_the_remedy(tmp_path):
    with refused(remedy="gcc, or pip install 'clepsydra[zig]', or give sources_only=True"):
        write_fmu(tmp_path / "pi.fmu", pi_model(), None)
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_version_is_refused(tmp_path):
    with refused(expected="3.0 or 2.0"):
        write_fmu(tmp_path / "pi.fmu", pi_model(), find_compiler("tests"), version="1.0")
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_c_does_not_accept_is_refused_and_nothing_is_left(tmp_path):
    model = controller_model(replace(pi_program(), name="double"), origin("p", 1.0))
    with refused(expected="a name that is no word of C"):
        write_fmu(tmp_path / "pi.fmu", model, find_compiler("tests"))
    assert list(tmp_path.iterdir()) == []


def test_what_the_compiler_refuses_leaves_the_old_file_as_it_was(tmp_path):
    path = tmp_path / "pi.fmu"
    path.write_text("old")
    wrong = replace(find_compiler("tests"), flags=("-no-such-flag",))
    with pytest.raises(CompilationError):
        write_fmu(path, pi_model(), wrong)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_folder_is_refused_in_words(tmp_path):
    with refused(remedy="choose another folder"):
        write_fmu(tmp_path / "none" / "pi.fmu", pi_model(), None, sources_only=True)


@pytest.mark.parametrize(("machine", "folder"), [("arm64", "aarch64"), ("AMD64", "x86_64")])
def test_a_binary_lies_where_the_standard_has_it(machine, folder, monkeypatch):
    """FMI 2.0 has a name for x86 only; FMI 3.0 for others too."""
    monkeypatch.setattr(platform, "machine", lambda: machine)
    systems = {}
    for system in ("linux", "darwin", "win32"):
        monkeypatch.setattr(sys, "platform", system)
        systems[system] = platform_folder("3.0")
        if folder == "x86_64":
            assert platform_folder("2.0") == {"win32": "win64"}.get(system, f"{system}64")
        else:
            with pytest.raises(InputError, match=r"arm64 .*expected x86_64.*write it as FMI 3\.0"):
                platform_folder("2.0")
    assert systems == {
        "linux": f"{folder}-linux", "darwin": f"{folder}-darwin", "win32": f"{folder}-windows",
    }  # fmt: skip


def test_a_machine_without_a_name_is_refused_and_nothing_is_left(monkeypatch, tmp_path):
    monkeypatch.setattr(platform, "machine", lambda: "riscv64")
    with pytest.raises(InputError, match=r"riscv64.*on such a machine, or in Python"):
        write_fmu(tmp_path / "pi.fmu", pi_model(), find_compiler("tests"))
    assert list(tmp_path.iterdir()) == []
    write_fmu(tmp_path / "pi.fmu", pi_model(), None, sources_only=True)
    assert (tmp_path / "pi.fmu").is_file()


@pytest.mark.parametrize("name", ["pegel_höhe", "level 1", "a..b", "[1]", "a<b", ""])
def test_a_name_that_is_none_of_the_naming_convention_is_refused(name):
    program = pi_program()
    named = replace(program, outputs=(replace(program.outputs[0], name=name), *program.outputs[1:]))
    with refused(expected="a name that an FMU can have"):
        controller_model(named, origin("p", 1.0))
