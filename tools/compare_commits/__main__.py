"""``python tools/compare_commits OLD NEW``."""

import signal
import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).parents[1])  # the folder of this package, not the package
    from compare_commits.command import main

    signal.signal(signal.SIGTERM, signal.default_int_handler)  # what is checked out goes away too
    sys.exit(main())
