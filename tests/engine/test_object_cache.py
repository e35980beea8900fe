"""Compiled objects on disk: found again, never trusted when damaged or open to others."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from random_laws import random_law

from clepsydra import Kernel, program_of
from clepsydra.engine.object_cache import ObjectCache, default_cache

posix = pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")


def compiled(folder: Path, seed: int = 1) -> tuple[bool, np.ndarray]:
    """Return whether a kernel came from a cache, and what it computes."""
    kernel = Kernel(program_of(random_law(seed)), cache=ObjectCache(folder))
    was_cached = kernel.function(1).was_cached
    return was_cached, kernel.run(20).record_of(0)


def files(folder: Path) -> list[Path]:
    return sorted(folder.iterdir())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "deep" / "kernels"


def test_the_second_compilation_is_read_from_disk(folder):
    first, computed = compiled(folder)
    second, again = compiled(folder)
    assert (first, second) == (False, True)
    assert np.array_equal(computed, again, equal_nan=True)
    assert len(files(folder)) == 1


def test_another_program_has_another_file(folder):
    compiled(folder, 1)
    assert compiled(folder, 2)[0] is False
    assert len(files(folder)) == 2


def truncate_to_nothing(content: bytes) -> bytes:
    return b""


def truncate_inside_the_digest(content: bytes) -> bytes:
    return content[:20]


def truncate_to_the_digest(content: bytes) -> bytes:
    return content[:32]


def truncate_to_half(content: bytes) -> bytes:
    return content[: len(content) // 2]


def lose_the_last_byte(content: bytes) -> bytes:
    return content[:-1]


def flip_a_bit_of_the_code(content: bytes) -> bytes:
    place = len(content) - 100
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


def flip_a_bit_of_the_digest(content: bytes) -> bytes:
    return bytes([content[0] ^ 128]) + content[1:]


def append_a_byte(content: bytes) -> bytes:
    return content + b"\0"


@pytest.mark.parametrize(
    "damage",
    [
        truncate_to_nothing,
        truncate_inside_the_digest,
        truncate_to_the_digest,
        truncate_to_half,
        lose_the_last_byte,
        flip_a_bit_of_the_code,
        flip_a_bit_of_the_digest,
        append_a_byte,
    ],
)
def test_a_damaged_object_is_compiled_again_and_replaced(folder, damage):
    _, computed = compiled(folder)
    (file,) = files(folder)
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    was_cached, again = compiled(folder)
    assert was_cached is False
    assert np.array_equal(computed, again, equal_nan=True)
    assert files(folder) == [file]
    assert file.read_bytes() == whole
    assert compiled(folder)[0] is True


def test_load_gives_back_what_was_stored_and_nothing_else(folder):
    cache = ObjectCache(folder)
    assert cache.load("key") is None
    cache.store("key", b"body")
    cache.store("empty", b"")
    assert (cache.load("key"), cache.load("empty")) == (b"body", b"")
    assert cache.load("other key") is None
    cache.store("key", b"another body")
    assert cache.load("key") == b"another body"
    assert len(files(folder)) == 2


@posix
@pytest.mark.parametrize("mask", [0o000, 0o022, 0o277, 0o777])
def test_the_folders_are_made_for_their_owner_alone(folder, mask):
    before = os.umask(mask)
    try:
        ObjectCache(folder).store("key", b"body")
    finally:
        os.umask(before)
    for made in (folder, folder.parent):
        assert stat.S_IMODE(made.stat().st_mode) == 0o700
    (file,) = files(folder)
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert ObjectCache(folder).load("key") == b"body"


@posix
@pytest.mark.parametrize("mode", [0o777, 0o720, 0o702, 0o1777])
def test_a_folder_that_others_can_write_to_is_not_used(folder, mode):
    compiled(folder, 1)
    before = {file: file.read_bytes() for file in files(folder)}
    folder.chmod(mode)
    assert ObjectCache(folder).load("key") is None
    assert compiled(folder, 1)[0] is False
    assert compiled(folder, 2)[0] is False
    assert {file: file.read_bytes() for file in files(folder)} == before
    folder.chmod(0o700)
    assert compiled(folder, 1)[0] is True


@posix
def test_a_folder_that_is_open_to_others_is_told_once(folder, caplog):
    ObjectCache(folder).store("key", b"body")
    assert caplog.messages == []
    folder.chmod(0o755)
    for key in ("key", "another"):
        ObjectCache(folder).store(key, b"body")
        assert ObjectCache(folder).load(key) is None
    (said,) = caplog.messages
    assert f"{folder} is open to others (mode 755)" in said and f"chmod 700 {folder}" in said


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() != 0, reason="only root can give a folder away"
)
def test_a_folder_of_somebody_else_is_not_used(folder, caplog):
    compiled(folder)
    os.chown(folder, 12345, -1)
    assert compiled(folder)[0] is False
    (said,) = caplog.messages
    assert f"{folder} belongs to another user" in said and "CLEPSYDRA_CACHE" in said


def the_object(folder: Path) -> Path:
    """Return the file of an object that is stored under "key"."""
    ObjectCache(folder).store("key", b"body")
    (file,) = files(folder)
    return file


@posix
@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666, 0o640])
def test_a_file_that_is_open_to_others_is_not_loaded(folder, mode):
    file = the_object(folder)
    file.chmod(mode)
    assert ObjectCache(folder).load("key") is None
    file.chmod(0o600)
    assert ObjectCache(folder).load("key") == b"body"


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() != 0, reason="only root can give a file away"
)
def test_a_file_of_somebody_else_is_not_loaded(folder):
    os.chown(the_object(folder), 12345, -1)
    assert ObjectCache(folder).load("key") is None


@posix
def test_a_link_to_an_object_is_not_followed(folder, tmp_path):
    file = the_object(folder)
    elsewhere = file.rename(tmp_path / "elsewhere.o")
    file.symlink_to(elsewhere)
    assert ObjectCache(folder).load("key") is None


@posix
def test_a_fifo_neither_waits_nor_loads(folder):
    file = the_object(folder)
    file.unlink()
    os.mkfifo(file, 0o600)
    assert ObjectCache(folder).load("key") is None


def test_a_folder_in_place_of_an_object_is_not_loaded(folder):
    file = the_object(folder)
    file.unlink()
    file.mkdir(mode=0o700)
    assert ObjectCache(folder).load("key") is None


def test_the_object_of_another_key_in_its_place_is_not_loaded(folder):
    file = the_object(folder)
    ObjectCache(folder).store("other key", b"other body")
    (other,) = set(files(folder)) - {file}
    other.replace(file)
    assert ObjectCache(folder).load("key") is None


@posix
def test_a_folder_that_is_swapped_after_the_check_gives_none_of_its_own(folder, monkeypatch):
    """What is checked is what is read: the folder is asked by the descriptor that reads it."""
    the_object(folder)
    planted = folder.with_name("planted")
    ObjectCache(planted).store("key", b"planted body")
    asked = os.fstat
    swapped = []

    def swap_after_the_check(descriptor: int) -> os.stat_result:
        status = asked(descriptor)
        if not swapped:
            swapped.append(folder.rename(folder.with_name("checked")))
            planted.rename(folder)
        return status

    monkeypatch.setattr(os, "fstat", swap_after_the_check)
    assert ObjectCache(folder).load("key") == b"body"
    assert swapped


def test_what_a_killed_process_left_half_written_is_removed(folder):
    the_object(folder)
    for name, time in (("old.part", 0.0), ("fresh.part", None)):
        (folder / name).write_bytes(b"half")
        if time is not None:
            os.utime(folder / name, (time, time))
    ObjectCache(folder).store("key", b"body")
    assert [file.name for file in files(folder) if file.suffix == ".part"] == ["fresh.part"]


@posix
def test_a_user_without_a_home_keeps_nothing(monkeypatch):
    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("CLEPSYDRA_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    cache = default_cache()
    cache.store("key", b"body")
    assert cache.load("key") is None


@posix
def test_a_link_to_a_folder_is_not_followed(tmp_path, folder):
    compiled(folder)
    link = tmp_path / "link"
    link.symlink_to(folder)
    assert compiled(link)[0] is False


def test_a_folder_that_cannot_be_made_costs_only_a_compilation(tmp_path, folder):
    in_the_way = tmp_path / "file"
    in_the_way.write_text("in the way")
    was_cached, computed = compiled(in_the_way / "kernels")
    assert was_cached is False
    assert np.array_equal(computed, compiled(folder)[1], equal_nan=True)
    assert in_the_way.read_text() == "in the way"
    assert compiled(in_the_way)[0] is False


@posix
def test_a_full_disk_leaves_no_part_of_a_file(folder):
    import resource

    ObjectCache(folder).store("small", b"body")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        ObjectCache(folder).store("large", bytes(100_000))
        was_cached, computed = compiled(folder)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert was_cached is False
    assert len(files(folder)) == 1
    assert ObjectCache(folder).load("small") == b"body"
    assert ObjectCache(folder).load("large") is None
    assert np.array_equal(computed, compiled(folder)[1], equal_nan=True)


def test_the_environment_chooses_the_folder(folder, monkeypatch):
    monkeypatch.setenv("CLEPSYDRA_CACHE", str(folder))
    kernel = Kernel(program_of(random_law(3)))
    kernel.run(1)
    assert len(files(folder)) == 1
    assert default_cache().folder == folder
    monkeypatch.delenv("CLEPSYDRA_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    assert default_cache().folder.is_relative_to(folder)


CHILD = """
import hashlib, sys
from clepsydra import Kernel
from clepsydra import program_of
sys.path.insert(0, sys.argv[1])
from random_laws import random_law
kernel = Kernel(program_of(random_law(1)))
sys.stdin.readline()
record = kernel.run(20).record_of(0) + 0.0
print(kernel.function(1).was_cached, hashlib.sha256(record.tobytes()).hexdigest())
"""


@pytest.mark.thorough
def test_processes_that_start_together_share_a_fresh_folder(folder):
    """Which of them find the object is open; all compute the same and leave one whole file."""
    environment = {
        **os.environ,
        "CLEPSYDRA_CACHE": str(folder),
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }

    def start() -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, "-c", CHILD, str(Path(__file__).parent)],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def answer(process: subprocess.Popen) -> list[str]:
        output, errors = process.communicate(timeout=600)
        assert process.returncode == 0, errors
        assert errors == ""
        return output.split()

    processes = [start() for _ in range(3)]
    for process in processes:
        process.stdin.write("go\n")
        process.stdin.flush()
    answers = [answer(process) for process in processes]
    assert len({digest for _, digest in answers}) == 1
    assert "False" in {was_cached for was_cached, _ in answers}
    assert len(files(folder)) == 1
    later = start()
    later.stdin.write("go\n")
    assert answer(later) == ["True", answers[0][1]]
