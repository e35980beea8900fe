"""What answers at once: help, the version and the list of processes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import clepsydra as cl

HEAVY = {
    "numpy", "casadi", "scipy", "control", "matplotlib", "pandas", "pyarrow", "llvmlite", "xarray",
    "pint", "jinja2",
}  # fmt: skip
LIGHT = [
    ["--help"], ["-h"], ["--version"], ["study", "--help"], ["analyse", "--help"],
    ["identify", "--help"], ["simulate", "--help"], ["new", "--help"], ["draw", "--help"],
    ["processes"],
]  # fmt: skip
OPTIONS = {
    "study": ("--json", "--output", "PROCESS"),
    "identify": ("--manipulated", "--measured", "--process", "--parameters", "--write"),
    "simulate": ("--input", "--profile", "--duration", "--start", "--state", "--solver"),
}
#: Runs one after the other; says for each its status, how much it printed and what is loaded.
CODE = """
import contextlib, io, json, sys
from clepsydra.cli import main
for arguments in json.loads(sys.argv[1]):
    status, said = 0, io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            main(arguments)
    except SystemExit as ending:
        status = ending.code or 0
    loaded = sorted({name.partition(".")[0] for name in sys.modules})
    print(json.dumps([arguments, status, len(said.getvalue()), loaded]))
"""


def test_they_load_nothing_numeric(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", CODE, json.dumps(LIGHT)],
        cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", timeout=600,
        env={**os.environ, "PYTHONPATH": str(Path(cl.__file__).parents[1])},
    )  # fmt: skip
    found = [json.loads(line) for line in done.stdout.splitlines()]
    assert [arguments for arguments, *_ in found] == LIGHT, done.stderr
    for arguments, status, printed, loaded in found:
        assert (status, printed > 0) == (0, True), arguments
        assert not HEAVY & set(loaded), arguments
        assert "typer" in loaded, arguments


def test_help_names_the_verbs_and_their_options(command):
    status, output, _ = command("--help")
    assert status == 0 and "study" in output and "analyse" in output
    for verb, words in OPTIONS.items():
        status, output, _ = command(verb, "--help")
        assert status == 0, verb
        assert [word for word in words if word not in output] == [], verb


def test_the_version(command):
    assert command("--version") == (0, f"clepsydra {cl.__version__}\n", "")
