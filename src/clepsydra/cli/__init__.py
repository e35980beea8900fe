"""The command line, one file a verb."""

from __future__ import annotations

import atexit
import gc
import io
import logging
import os
import signal
import sys
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

#: That of an internal error is the number that sysexits.h has for it.
_FAILED, _INTERNAL, _INTERRUPTED = 2, 70, 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit.

    The status is 0 where all is done, 1 where a proof does not hold, 2 where an input or the
    usage is wrong or the output cannot be written, 70 where Clepsydra itself is at fault, 130 where
    it was interrupted, and 128 and the signal's number where a signal ended it.
    """
    # The matrices are small: more threads of the linear algebra only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _keep_fonts_without_a_home()
    from clepsydra.base.errors import ClepsydraError
    from clepsydra.base.words import printable

    if arguments is None:
        # What is imported stays, and to look through it for garbage so often takes a while.
        gc.set_threshold(500_000)
        atexit.register(gc.freeze)  # nor is it looked through at the end, when it all goes anyway
        _end_cleanly_by_signals()
        _say_warnings_in_words()
        logging.basicConfig(format="clepsydra: %(message)s")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        _run(sys.argv[1:] if arguments is None else arguments)
    except ClepsydraError as error:
        _end(printable(str(error)), _FAILED)
    except KeyboardInterrupt:
        _end("interrupted; nothing was left half-written", _INTERRUPTED)
    except OSError as error:
        if error.filename is not None:  # a file, which is a fault of ours
            _end_by_fault()
        sys.stdout = None  # what it still holds cannot be written at the end either
        reason = error.strerror or str(error)
        _end(
            f"standard output cannot be written: {reason}; make room or send it elsewhere", _FAILED
        )
    except MemoryError:
        _end("not enough memory; ask for fewer samples, or close other programs", _FAILED)
    except Exception:
        _end_by_fault()


def _keep_fonts_without_a_home() -> None:
    """Let Matplotlib make a folder for its fonts where nobody has one, and say nothing of it.

    Its versions before 3.11 end without a home; where no folder can be made, all make their own.
    """
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    try:
        Path.home()
    except RuntimeError:
        os.environ.setdefault("MPLCONFIGDIR", os.devnull)


def _run(arguments: Sequence[str]) -> None:
    from clepsydra.base.errors import InputError
    from clepsydra.base.words import printable
    from clepsydra.cli.application import application

    for argument in arguments:
        if printable(argument) != argument:
            raise InputError("arguments", argument, "text without control characters", "retype it")
    try:
        application()(args=arguments)
    except SystemExit as ended:
        if ended.code == _INTERRUPTED:
            raise KeyboardInterrupt from None
        if sys.stdout is not None:
            sys.stdout.flush()
        raise


def _end(message: str, status: int) -> NoReturn:
    print(f"clepsydra: {message}", file=sys.stderr)
    sys.exit(status)


def _end_by_fault() -> NoReturn:
    """End by an error that no user should see: with all that a report of it needs."""
    traceback.print_exc()
    _end(
        "an internal error: this is a fault of Clepsydra and not of what you gave it; please "
        "report the lines above, with what you ran",
        _INTERNAL,
    )


def _say_warnings_in_words() -> None:
    """Say once that something is amiss, and not in which line of which library it was noticed.

    Python's own options, `-W` and PYTHONWARNINGS, show the warnings as they are.
    """
    if sys.warnoptions:
        return
    said = False

    def say(message: Warning | str, category: type[Warning], *_: object) -> None:
        nonlocal said
        if not said and issubclass(category, RuntimeWarning):
            said = True
            print(
                f"clepsydra: on the way a number could not be computed ({message}); results that "
                "need it are not a number",
                file=sys.stderr,
            )

    warnings.showwarning = say  # type: ignore[assignment]


def _end_cleanly_by_signals() -> None:
    """Let a terminating signal unwind, so that no part of a file stays; a closed pipe is an end."""

    def end(number: int, _: object) -> NoReturn:
        sys.exit(128 + number)

    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), end)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
