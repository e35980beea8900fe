"""What a worker process of this machine does as it starts; dask asks for it by this name."""

import signal


def dask_setup(worker: object) -> None:
    """Leave control-C, which reaches all processes of a terminal, to the one that asked for work.

    It ends its workers; they would each print where they were.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
