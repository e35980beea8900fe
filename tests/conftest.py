"""Shared by all tests: compiled kernels go to a folder of their own, the same in every worker."""

import os
import tempfile

import pytest

# Read when NumPy is loaded. The workers take all cores already, and the threads of the linear
# algebra would only spin beside them: a study then costs half as much again.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

_folder = None
if "PYTEST_XDIST_WORKER" not in os.environ:  # a worker inherits the folder of its parent
    _folder = tempfile.TemporaryDirectory(prefix="clepsydra-test-")
    os.environ["CLEPSYDRA_CACHE"] = _folder.name + "/kernels"


def pytest_unconfigure(config: pytest.Config) -> None:
    if _folder is not None:
        _folder.cleanup()
