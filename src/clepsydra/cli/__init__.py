"""The command line, one file a verb."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit: 0 done, 2 an input or usage error, 130 interrupted."""
    # The matrices are small: more threads of the linear algebra only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from clepsydra.base.errors import ClepsydraError
    from clepsydra.cli.application import application

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        application(args=arguments)
    except ClepsydraError as error:
        print(f"clepsydra: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("clepsydra: interrupted; nothing was left half-written", file=sys.stderr)
        sys.exit(130)
