"""What stands at a path of a user is asked in one way, and no error of the system escapes."""

import os
import re
from pathlib import Path

import pytest
from refusals import refused

from clepsydra.base.standing import Standing, standing_at

SOURCE = Path(__file__).parents[2] / "src" / "clepsydra"
#: The questions of `pathlib` and `os.path` that raise such an error, or answer no for one.
_ASKED = re.compile(r"\.(?:exists|is_file|is_dir|is_symlink|isfile|isdir|samefile)\(")


def standing(path):
    return standing_at(path, "the key", "a file", "look there", "as written")


def test_what_stands_there(tmp_path):
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("file")
    (tmp_path / "lost").symlink_to("nowhere")
    found = {
        name: standing(tmp_path / name)
        for name in ("file", "", "pipe", "link", "lost", "none", "file/below")
    }
    assert found == {
        "file": Standing.FILE,
        "": Standing.FOLDER,
        "pipe": Standing.OTHER,
        "link": Standing.FILE,
        "lost": Standing.NOTHING,
        "none": Standing.NOTHING,
        "file/below": Standing.NOTHING,
    }


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("x" * 300, "file name too long"),
        ("a\0b", "a null character in its name"),
        ("round", "too many levels of symbolic links"),
        ("forbidden/file", "permission denied"),
    ],
)
def test_a_path_that_cannot_be_looked_at_is_refused(tmp_path, forbidden, name, reason):
    (tmp_path / "round").symlink_to("round")
    forbidden(tmp_path / "forbidden")
    remedy = f"look there ({reason})"
    with refused(place="the key", value="as written", expected="a file", remedy=remedy):
        standing(tmp_path / name)


def test_no_other_code_asks_what_stands_at_a_path():
    asking = [
        f"{path.relative_to(SOURCE)}: {line.strip()}"
        for path in sorted(SOURCE.rglob("*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if _ASKED.search(line) and not re.search(r">>> |\.\.\. ", line)
    ]
    assert asking == []
    assert _ASKED.search("if path.is_dir():")  # so a line that asks is found
