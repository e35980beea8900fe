"""A process that runs command lines of one commit, each in a child of its own.

It is started with PYTHONPATH at the commit's sources and imports nothing of the comparison. Each
line that it reads is a request, each line that it prints the answer. A child is a copy of a
process that has imported what commands import and has run nothing, so it needs no second for its
start; from there it is ``python -m clepsydra ARGUMENTS``.
"""

import contextlib
import importlib
import json
import os
import runpy
import select
import signal
import sys
import time
import traceback
from pathlib import Path
from typing import Any

COMMAND = "clepsydra"
_MODULES = ".modules.json"


def main() -> None:
    """Answer requests until there are none."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        request = json.loads(line)
        answer = _warm_up(request) if "modules" in request else _run(request)
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _warm_up(request: dict[str, Any]) -> dict[str, Any]:
    """Import what some commands import; answer what that was and where the command was found."""
    folder, modules = Path(request["folder"]), list(request["modules"])
    for number, arguments in enumerate([] if modules else request["warm_up"]):
        own = folder / str(number)
        own.mkdir()
        _run({**request, "folder": str(own), "arguments": arguments}, own / _MODULES)
        with contextlib.suppress(OSError, ValueError):  # it did not get so far
            modules += json.loads((own / _MODULES).read_text(encoding="utf-8"))
    for name in modules:
        if name not in sys.modules and not name.startswith("__"):
            with contextlib.suppress(Exception):  # a module that only another one can make
                importlib.import_module(name)
    return {"source": importlib.import_module(COMMAND).__file__, "modules": modules}


def _command(arguments: list[str]) -> int:
    sys.argv = [COMMAND, *arguments]
    try:
        runpy.run_module(COMMAND, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
            return 1
        return end.code or 0
    return 0


def _run(request: dict[str, Any], modules: Path | None = None) -> dict[str, Any]:
    """Run a command in a child, in its folder; stop it with all its own where it takes too long.

    What it has imported at its end is written to a file where one is named.
    """
    folder, began = Path(request["folder"]), time.monotonic()
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        _be_child(folder, request["arguments"], modules)
    waiting = os.pidfd_open(child)
    ended, _, _ = select.select([waiting], [], [], request["limit"])
    os.close(waiting)
    with contextlib.suppress(ProcessLookupError, PermissionError):  # nothing of it is left
        os.killpg(child, signal.SIGKILL)
    if not ended:
        with contextlib.suppress(ProcessLookupError):  # where it was no group's leader yet
            os.kill(child, signal.SIGKILL)
    _, status, used = os.wait4(child, 0)
    return {
        "status": os.waitstatus_to_exitcode(status) if ended else None,
        "seconds": time.monotonic() - began,
        "processor_seconds": used.ru_utime + used.ru_stime,
    }


def _be_child(folder: Path, arguments: list[str], modules: Path | None) -> None:
    status = 1
    try:
        os.setpgid(0, 0)
        os.chdir(folder)
        for target, name in ((1, ".stdout"), (2, ".stderr")):
            file = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
            os.dup2(file, target)
            os.close(file)
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        status = _command(arguments)
        if modules:
            modules.write_text(json.dumps(list(sys.modules)), encoding="utf-8")
    except BaseException:
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(Exception):
                stream.flush()
        os._exit(status)


if __name__ == "__main__":
    main()
