"""The one place of the tests that reads a clock: to give up, never to judge how long it took."""

import time
from collections.abc import Callable

#: Far beyond what the slowest machine needs [s].
PATIENCE = 600.0


def wait_until(condition: Callable[[], bool]) -> None:
    """Return when the condition holds, and give up after ten minutes."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"waited {PATIENCE:g} s")
        time.sleep(0.02)
