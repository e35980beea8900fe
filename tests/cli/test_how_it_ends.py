"""How the command ends: interrupted, terminated, without a place to write to, without a home."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and devices of POSIX")
COMMAND = "from clepsydra.cli import main; main()"
PATHS = os.pathsep.join(str(Path(path).resolve()) for path in sys.path if path)
FULL = Path("/dev/full")


def start(folder: Path, *arguments: str, code: str = COMMAND, **options) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": PATHS},
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        **options,
    )


def end(process: subprocess.Popen) -> tuple[int, str]:
    _, errors = process.communicate(timeout=600)
    return process.returncode, errors


def in_the_foreground() -> None:
    """What a shell starts in the background ignores Control-C; this does not."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("number", "status", "message"),
    [
        (signal.SIGINT, 130, "clepsydra: interrupted; nothing was left half-written\n"),
        (signal.SIGTERM, 143, ""),
        (signal.SIGHUP, 129, ""),
    ],
)
def test_a_signal_ends_it_with_its_status_and_leaves_nothing(tmp_path, number, status, message):
    """It is in the midst of a file that is being written when the signal comes."""
    code = (
        "import time; from pathlib import Path; from clepsydra.base import files; "
        "from clepsydra.cli import main, analyse\n"
        "def writes(*_, **__):\n"
        "    with files.whole_file(Path('result.txt')) as part:\n"
        "        part.write_text('half'); time.sleep(600)\n"
        "import clepsydra.process.reader as reader; reader.load_process = writes\n"
        "main()\n"
    )
    process = start(tmp_path, "analyse", "quadruple-tank", code=code, preexec_fn=in_the_foreground)
    while not any(path.read_text() for path in tmp_path.glob("*.part")):
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    process.send_signal(number)
    assert end(process) == (status, message)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["processes", "--json"], pytest.param(["processes"], marks=pytest.mark.thorough)],
)
def test_full_standard_output_is_a_message(tmp_path, arguments):
    with FULL.open("w") as full:
        status, errors = end(start(tmp_path, *arguments, stdout=full))
    assert status == 2
    assert errors.startswith("clepsydra: standard output cannot be written: No space left")
    assert errors.count("\n") == 1


def test_an_internal_error_has_a_status_of_its_own(tmp_path):
    """One that no user can mend is neither a proof that fails nor a mistake in an input."""
    for error in ("KeyError('own')", "OSError(5, 'own', 'file')"):
        code = (
            "from clepsydra.cli import main\n"
            "def fails(*_, **__): raise " + error + "\n"
            "import clepsydra.process.reader as reader; reader.load_process = fails\n"
            "main()\n"
        )
        status, errors = end(start(tmp_path, "analyse", "quadruple-tank", code=code))
        assert status == 70
        *reported, last = errors.splitlines()
        assert reported[0].startswith("Traceback") and "own" in reported[-1]
        assert last.startswith("clepsydra: an internal error") and "report" in last


def test_too_little_memory_is_a_message(tmp_path):
    code = (
        "from clepsydra.cli import main\n"
        "def fails(*_, **__): raise MemoryError('65 GiB')\n"
        "import clepsydra.process.reader as reader; reader.load_process = fails\n"
        "main()\n"
    )
    status, errors = end(start(tmp_path, "analyse", "quadruple-tank", code=code))
    assert status == 2 and errors.startswith("clepsydra: not enough memory")
    assert errors.count("\n") == 1


def test_a_reader_that_closes_its_pipe_ends_it_like_any_other_program(tmp_path):
    process = start(tmp_path, "processes", stdout=subprocess.PIPE)
    process.stdout.close()
    process.stdout = None
    assert end(process) == (-signal.SIGPIPE, "")


@pytest.mark.parametrize(
    "arguments",
    [["analyse", "a\x1b[31mred.toml"], ["analyse", "--\x1b[2J"], ["\x9b2J"], ["study", "a\nb"]],
)
def test_control_characters_of_an_argument_never_reach_the_terminal(command, arguments):
    status, _, errors = command(*arguments)
    assert status == 2
    assert all(each == "\n" or each.isprintable() for each in errors)


def test_control_characters_of_a_file_never_reach_the_terminal(command, tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('name = "mine"\n["tanks"."a\\u001b[31m"]\n"\\u001b[2J" = "\\u0007"\n')
    status, _, errors = command("analyse", "mine.toml")
    assert status == 2
    assert all(each == "\n" or each.isprintable() for each in errors)


@pytest.mark.thorough
def test_a_user_without_home_and_entry_simulates(tmp_path):
    """As in a container that runs under a number: no folder for kernels, none for fonts."""
    code = (
        "import pwd\n"
        "def no_entry(number): raise KeyError(number)\n"
        "pwd.getpwuid = no_entry\n"
        "from clepsydra.cli import main; main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "simulate", "quadruple-tank", "--input", "pump_1=3.5V@2s"],
        cwd=tmp_path,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": PATHS},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert {path.suffix for path in tmp_path.iterdir()} == {".html", ".parquet"}
