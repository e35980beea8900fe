"""Files of a user: what is no regular file, too large or changed meanwhile is never read."""

import os
from pathlib import Path

import pytest

from clepsydra import InputError
from clepsydra.base.input_file import input_text, read_input


def refused(path, **options):
    with pytest.raises(InputError) as refusal:
        read_input(path, "a CSV file", **options)
    return refusal.value


def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    assert refused(tmp_path / "pipe.csv").value == "no regular file"


def test_a_pipe_that_takes_the_place_of_a_file_is_refused_too(tmp_path, monkeypatch):
    """The file is looked at, exchanged, and opened: what was opened is what counts."""
    path = tmp_path / "raced.csv"
    path.write_text("0,1\n")
    really = os.open

    def exchanged(name, flags, *rest, **options):
        if os.fspath(name) == os.fspath(path):
            path.unlink()
            os.mkfifo(path)
        return really(name, flags, *rest, **options)

    monkeypatch.setattr(os, "open", exchanged)
    assert refused(path).value == "no regular file"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("/dev/zero", "no regular file"),
        (".", "a folder"),
        ("none.csv", "no such file"),
        ("a\0b.csv", "a null character in its name"),
        ("x" * 5000, "file name too long"),
    ],
)
def test_what_is_no_file(tmp_path, name, value):
    error = refused(tmp_path / name)
    assert str(error.value).startswith(value)
    assert error.expected == "a CSV file" and error.place.isprintable()


def test_a_folder_says_what_to_name(tmp_path):
    assert refused(tmp_path, inside="the .toml file").remedy == "name the .toml file in it"


def test_the_largest_is_read_and_one_byte_more_is_not(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"x" * 2_000_000)
    assert len(read_input(path, "a CSV file", largest=2_000_000)) == 2_000_000
    path.write_bytes(b"x" * 2_000_001)
    error = refused(path, largest=2_000_000)
    assert (error.value, error.expected) == ("more than 2 MB", "a CSV file of at most 2 MB")


def test_what_the_kernel_counts_as_empty_is_bounded_too():
    """Files of /proc have size 0 and go on."""
    path = Path("/proc/self/maps")
    if not path.exists():
        pytest.skip("no /proc here")
    assert refused(path, largest=100).value == "more than 0.0001 MB"


def test_text_in_another_encoding_is_refused_with_its_line():
    with pytest.raises(InputError) as refusal:
        input_text(b"a\nb \xb5\n", "a.csv", "a CSV file", 80)
    assert (refusal.value.place, refusal.value.value) == ("a.csv, line 2", "byte 0xb5")


def test_a_line_without_end_is_refused():
    assert input_text(b"1\n" + b"2" * 80, "a.csv", "a CSV file", 80).endswith("2")
    with pytest.raises(InputError) as refusal:
        input_text(b"1\n" + b"2" * 81, "a.csv", "a CSV file", 80)
    assert (refusal.value.place, refusal.value.value) == ("a.csv, line 2", "81 characters")


def test_a_misspelt_file_leads_to_the_one_that_is_there(tmp_path):
    (tmp_path / "quanser.toml").touch()
    (tmp_path / "quansr.csv").touch()
    (tmp_path / "tank.toml").touch()
    assert refused(tmp_path / "quansr.toml").remedy == "perhaps 'quanser.toml' was meant"
    assert refused(tmp_path / "cascade.toml").remedy == "check the path"
