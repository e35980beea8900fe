"""Shared by all tests: compiled kernels go to a folder of their own."""

import os
import tempfile

import pytest

_folder = tempfile.TemporaryDirectory(prefix="clepsydra-test-")
os.environ["CLEPSYDRA_CACHE"] = _folder.name + "/kernels"


def pytest_unconfigure(config: pytest.Config) -> None:
    _folder.cleanup()
