"""Shared by all tests: compiled kernels go to a folder of their own, the same in every worker.

What several workers need and one is to make, they make under a lock in a folder of all of them.
"""

import errno
import fcntl
import hashlib
import os
import pickle
import tempfile
from collections import defaultdict
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Read when NumPy is loaded. The workers take all cores already, and the threads of the linear
# algebra would only spin beside them: a study then costs half as much again.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# A deadline for an example, or for drawing it, would be a clock that fails a test.
settings.register_profile("no clock", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("no clock")

#: Cases of a function marked `sampled` that stay in the fast tier.
SAMPLE = 3

_folder = None
if "PYTEST_XDIST_WORKER" not in os.environ:  # a worker inherits the folder of its parent
    _folder = tempfile.TemporaryDirectory(prefix="clepsydra-test-")
    kernels = Path(_folder.name, "kernels")
    kernels.mkdir(mode=0o700)
    os.environ["CLEPSYDRA_CACHE"] = str(kernels)
    # A file in the place of the folder of studies: no test sees what another one has designed.
    (kernels / "studies").touch()


def pytest_unconfigure(config: pytest.Config) -> None:
    if _folder is not None:
        _folder.cleanup()


@pytest.hookimpl(tryfirst=True)  # before cases are left out by their tier
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave a sample of the cases of each function marked `sampled` in the fast tier.

    The sample looks random and is always the same: it goes by the digests of the cases' names.
    """
    functions = defaultdict(list)
    for item in items:
        if item.get_closest_marker("sampled"):
            functions[item.nodeid.partition("[")[0]].append(item)
    for cases in functions.values():
        cases.sort(key=lambda case: hashlib.sha256(case.nodeid.encode()).digest())
        for case in cases[SAMPLE:]:
            case.add_marker("thorough")


@pytest.fixture(scope="session")
def alone(tmp_path_factory):
    """Return a folder of all workers, while no other works there on what has this name."""
    folder = tmp_path_factory.getbasetemp()
    folder = folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder

    @contextmanager
    def locked(name):
        with (folder / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield folder

    return locked


@pytest.fixture(scope="session")
def studied(alone):
    """Return a function: a process, or a file of the folder -> its whole study, made once.

    The worker that is first makes it, and the others read what it found.
    """

    @cache
    def found(name):
        import clepsydra as cl

        with alone(f"study-{name}") as folder:
            file = folder / f"study-{name}.pickle"
            if not file.exists():
                file.write_bytes(pickle.dumps(cl.study(name)))
            return pickle.loads(file.read_bytes())

    return found


@pytest.fixture
def forbidden(monkeypatch):
    """Return a function: makes a folder that the user may not enter, not even who may do all."""
    folders: list[Path] = []

    def below(path):
        above = Path(path).absolute().parents if isinstance(path, (str, os.PathLike)) else ()
        return any(folder in above for folder in folders)

    def refusing(asked):
        def ask(path, *rest, **options):
            if below(path):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), os.fspath(path))
            return asked(path, *rest, **options)

        return ask

    for name in ("stat", "lstat", "open", "mkdir", "scandir", "listdir", "unlink", "rename"):
        monkeypatch.setattr(os, name, refusing(getattr(os, name)))

    def forbid(folder):
        folder.mkdir()
        folders.append(folder)
        return folder

    return forbid
