"""Files that are written whole or not at all."""

import os
import stat
from pathlib import Path

import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.base.files import whole_file, write_together


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_the_file_appears_only_when_it_is_whole(tmp_path):
    path = tmp_path / "result.txt"
    with whole_file(path) as part:
        assert part.parent == tmp_path  # else renaming could not be one step
        part.write_text("half")
        assert not path.exists()
        part.write_text("whole")
        assert not path.exists()
    assert path.read_text() == "whole"
    assert names(tmp_path) == ["result.txt"]


def test_an_old_file_is_replaced_at_once(tmp_path):
    path = tmp_path / "result.txt"
    path.write_text("old")
    with path.open() as reader, whole_file(path) as part:
        part.write_text("new")
        assert path.read_text() == "old"
        assert reader.read() == "old"
    assert path.read_text() == "new"


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (ValueError, ValueError),
        (OSError, InputError),  # a full disk is the user's to mend
        (KeyboardInterrupt, KeyboardInterrupt),
        (SystemExit, SystemExit),
    ],
)
@pytest.mark.parametrize("there_before", [True, False])
def test_after_a_failure_nothing_is_left_and_the_old_file_stays(
    tmp_path, error, told, there_before
):
    path = tmp_path / "result.txt"
    if there_before:
        path.write_text("old")
    with pytest.raises(told), whole_file(path) as part:
        part.write_text("half")
        raise error("in the middle")
    assert names(tmp_path) == (["result.txt"] if there_before else [])
    assert not there_before or path.read_text() == "old"


def test_a_part_that_was_renamed_away_is_no_reason_to_hide_the_error(tmp_path):
    with pytest.raises(ValueError, match="first"), whole_file(tmp_path / "a") as part:
        part.unlink()
        raise ValueError("first")
    assert names(tmp_path) == []


def test_a_missing_folder_is_refused_in_words(tmp_path):
    path = tmp_path / "missing" / "result.txt"
    with pytest.raises(InputError) as refusal, whole_file(path):
        pytest.fail("there is no folder to write to")
    message = str(refusal.value)
    assert str(path) in message and "folder" in message
    assert names(tmp_path) == []


def test_a_file_in_place_of_the_folder_is_refused_in_words(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with refused(remedy="folder"), whole_file(tmp_path / "file" / "result.txt"):
        pytest.fail("there is no folder to write to")


def test_a_name_that_no_file_can_have_is_refused_in_words(tmp_path):
    with refused(remedy="null character"), whole_file(tmp_path / "a\0b"):
        pytest.fail("there is no such name")


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission_is_refused_in_words(tmp_path):
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(InputError, match="folder"), whole_file(tmp_path / "result.txt"):
            pytest.fail("the folder cannot be written to")
    finally:
        tmp_path.chmod(0o700)


def test_a_folder_of_that_name_is_never_replaced(tmp_path):
    path = tmp_path / "result.txt"
    path.mkdir()
    with pytest.raises((OSError, InputError)), whole_file(path) as part:
        part.write_text("whole")
    assert names(tmp_path) == ["result.txt"] and path.is_dir() and names(path) == []


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
@pytest.mark.parametrize(("mask", "mode"), [(0o022, 0o644), (0o077, 0o600)])
def test_the_permissions_are_those_of_any_new_file(tmp_path, mask, mode):
    before = os.umask(mask)
    try:
        with whole_file(tmp_path / "result.txt") as part:
            part.write_text("whole")
        assert os.umask(mask) == mask
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "result.txt").stat().st_mode) == mode


NEW = {"law.h": b"new h", "law.c": b"new c", "law.txt": b"new text"}


def test_files_that_are_written_together_all_appear(tmp_path):
    (tmp_path / "law.c").write_bytes(b"old c")
    assert write_together(tmp_path, NEW) == [tmp_path / name for name in NEW]
    assert contents(tmp_path) == NEW


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("failing", [1, 2, 3])
def test_where_one_file_cannot_be_put_in_its_place_all_are_as_before(
    tmp_path, monkeypatch, error, failing
):
    """Two of three stood there before; the first, second or third is refused by the system."""
    before = {"law.h": b"old h", "law.c": b"old c", "other.txt": b"another"}
    for name, content in before.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "law.c").chmod(0o640)
    replace, put = Path.replace, []

    def refusing(self, target):
        if self.suffix == ".part":
            put.append(target.name)
            if len(put) == failing:
                raise error
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", refusing)
    with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt):
        write_together(tmp_path, NEW)
    assert len(put) >= failing
    assert contents(tmp_path) == before
    if os.name == "posix":
        assert stat.S_IMODE((tmp_path / "law.c").stat().st_mode) == 0o640


def test_files_of_a_folder_that_is_not_there_are_refused_in_words(tmp_path):
    with refused(remedy="choose another folder"):
        write_together(tmp_path / "missing", NEW)
    assert names(tmp_path) == []


def test_a_folder_in_the_place_of_one_file_leaves_the_others_alone(tmp_path):
    (tmp_path / "law.c").mkdir()
    (tmp_path / "law.h").write_bytes(b"old h")
    with refused(remedy="a folder has that name"):
        write_together(tmp_path, NEW)
    assert names(tmp_path) == ["law.c", "law.h"]
    assert (tmp_path / "law.h").read_bytes() == b"old h"


def test_parts_that_a_killed_process_left_are_removed_by_the_next_writing(tmp_path):
    """Those of the same file, and not what another process is writing at this moment."""
    old, fresh, other = (
        tmp_path / name for name in (".a.txt.1.part", ".a.txt.2.part", ".b.1.part")
    )
    for part in (old, fresh, other):
        part.write_text("half")
    for part in (old, other):
        os.utime(part, (0, 0))
    with whole_file(tmp_path / "a.txt") as part:
        part.write_text("whole")
    assert names(tmp_path) == [".a.txt.2.part", ".b.1.part", "a.txt"]


def test_copies_that_a_killed_process_left_are_removed_by_the_next_writing(tmp_path):
    """Not those of a process at work, and nothing of another name: that is the user's."""
    old, fresh, own = (tmp_path / f".before.{ending}" for ending in ("a1b2c3d4", "w_rk1ng0", "me"))
    for copy in (old, fresh, own):
        copy.mkdir()
        (copy / "law.c").write_bytes(b"of before")
    for copy in (old, own):
        os.utime(copy, (0, 0))
    write_together(tmp_path, {"law.c": b"new"})
    assert names(tmp_path) == [".before.me", ".before.w_rk1ng0", "law.c"]
    assert (fresh / "law.c").read_bytes() == (own / "law.c").read_bytes() == b"of before"
