"""What an earlier study of the same plant has designed and tuned, kept by what it follows from."""

from __future__ import annotations

import hashlib
import io
import os
import pickle
import platform
import stat
import sys
import zlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple, TypeVar, cast

import casadi as ca
import numpy as np
import scipy

import clepsydra
from clepsydra.designs.applicability import NotApplicable
from clepsydra.engine.host import host
from clepsydra.engine.object_cache import ObjectCache, default_cache
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.program.step_law import StepLaw

T = TypeVar("T")

#: What the process stands for itself as.
_PROCESS = "process"
#: Packages whose code is known by their versions.
_KNOWN = frozenset(("casadi", "clepsydra", "numpy", "scipy"))
#: Arrays that are views are written as whole ones are up to this one.
_PROTOCOL = 4
#: What cannot be pickled says so in one of these ways.
_UNPICKLABLE = (pickle.PicklingError, AttributeError, TypeError)


class KeptWork:
    """Results of studies of a plant, in a private folder beside the compiled kernels.

    A result is found again by a digest of everything that it follows from: what is asked, the
    operating point with all of its process, the source of Clepsydra, the versions of the
    libraries and the processor. What code from elsewhere has a part in is not kept, since that
    code may change. Neither is anything where the folder cannot be used, as for kernels; the
    folder is guarded as theirs is, and what is damaged is computed anew.

    A law stands in a file of its own, and comes out as one object: controllers of one law have
    one kernel.

    Parameters
    ----------
    point : OperatingPoint
    store : ObjectCache, optional
        `default_store()` if left out.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = ObjectCache(Path(folder) / "studies")
    ...     first = KeptWork(plant.point, store).outcome("SIMC", lambda: cl.design.simc(plant))
    ...     again = KeptWork(plant.point, store).outcome("SIMC", lambda: 1 / 0)
    >>> again.values == first.values
    True
    """

    def __init__(self, point: OperatingPoint, store: ObjectCache | None = None) -> None:
        self._point = point
        self._store = default_store() if store is None else store
        self._laws: dict[str, StepLaw] = {}
        self._names: dict[int, str] = {}

    def outcome(
        self, asked: object, compute: Callable[[], T], *, lasts: Callable[[T], bool] | None = None
    ) -> T:
        """Return what came of the same question, or find out and keep it.

        Parameters
        ----------
        asked : object
            What tells this question about the plant from any other; None for one that cannot be
            told, whose answer is not kept.
        compute : callable
            Finds the answer.
        lasts : callable, optional
            Takes an answer and returns whether it is worth keeping; every one if left out.

        Raises
        ------
        NotApplicable
            From `compute`, now or when the question was asked first.
        """
        key = None if asked is None else self._key(asked)
        if key is None:
            return compute()
        found = self._load(key)
        if found is None:
            found = _answer_of(compute)
            if isinstance(found, _Refusal) or lasts is None or lasts(found):
                self._keep(key, found)
        if isinstance(found, _Refusal):
            raise NotApplicable(found.reason, found.method)
        return cast(T, found)

    def _key(self, asked: object) -> str | None:
        """Return the key of a question; None where code from elsewhere has a part in it."""
        if self._plant is None:
            return None
        try:
            question = _digest(_pickled(asked, self._name_of, canonical=True))
        except _UNPICKLABLE:
            return None
        return f"{_computed_by()} {self._plant} {question}"

    @cached_property
    def _plant(self) -> str | None:
        """A digest of the operating point with its process; None as of a key."""
        try:
            return _digest(_pickled(self._point, lambda _: None, canonical=True))
        except _UNPICKLABLE:
            return None

    def _load(self, key: str) -> Any:
        body = self._store.load(key)
        try:
            return None if body is None else _Reader(body, self._named).load()
        except pickle.UnpicklingError:  # one of its laws is gone
            return None

    def _keep(self, key: str, found: object) -> None:
        with suppress(*_UNPICKLABLE):
            self._store.store(key, zlib.compress(_pickled(found, self._name_of), level=1))

    def _name_of(self, item: object) -> str | None:
        """Return the name of what is kept apart, or there already: the process, and a law."""
        if item is self._point.process:
            return _PROCESS
        return self._law_name(item) if isinstance(item, StepLaw) else None

    def _law_name(self, law: StepLaw) -> str:
        if id(law) not in self._names:
            body = _pickled(law, lambda item: None if item is law else self._name_of(item))
            name = _digest(body)
            self._store.store(_law_key(name), zlib.compress(body, level=1))
            self._laws[name], self._names[id(law)] = law, name
        return self._names[id(law)]

    def _named(self, name: str) -> object:
        """Return what has a name."""
        if name == _PROCESS:
            return self._point.process
        if name not in self._laws:
            body = self._store.load(_law_key(name))
            if body is None:
                raise pickle.UnpicklingError("a law is gone")
            law: StepLaw = _Reader(body, self._named).load()
            self._laws[name], self._names[id(law)] = law, name
        return self._laws[name]


def default_store() -> ObjectCache:
    """Return the folder of studies beside the compiled kernels, or one that keeps nothing."""
    kernels = default_cache().folder
    return ObjectCache(None if kernels is None else kernels / "studies", "results of studies")


class _Refusal(NamedTuple):
    """Why a design does not apply."""

    reason: str
    method: str


def _answer_of(compute: Callable[[], T]) -> T | _Refusal:
    try:
        return compute()
    except NotApplicable as refusal:
        return _Refusal(refusal.reason, refusal.method)


class _Writer(pickle.Pickler):
    """Refuses what code from elsewhere has defined: it may be another tomorrow."""

    def __init__(self, stream: io.BytesIO, name_of: Callable[[object], str | None]) -> None:
        super().__init__(stream, _PROTOCOL)
        self._name_of = name_of

    def persistent_id(self, item: object) -> str | None:
        return self._name_of(item)

    def reducer_override(self, item: object) -> Any:
        if isinstance(item, (type, FunctionType)):
            package = item.__module__.partition(".")[0]
            if package not in _KNOWN and package not in sys.stdlib_module_names:
                raise pickle.PicklingError(f"{item.__qualname__} is from elsewhere")
        return NotImplemented


class _Reader(pickle.Unpickler):
    def __init__(self, body: bytes, named: Callable[[str], object]) -> None:
        super().__init__(io.BytesIO(zlib.decompress(body)))
        self._named = named

    def persistent_load(self, name: str) -> object:
        return self._named(name)


def _pickled(
    item: object, name_of: Callable[[object], str | None], *, canonical: bool = False
) -> bytes:
    """Return what an object is as bytes.

    Parameters
    ----------
    canonical : bool
        Whether equal parts are written alike, be they one object or two.
    """
    stream = io.BytesIO()
    writer = _Writer(stream, name_of)
    writer.fast = canonical
    writer.dump(item)
    return stream.getvalue()


def _digest(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()


def _law_key(name: str) -> str:
    return f"{_computed_by()} law {name}"


@cache
def _computed_by() -> str:
    """Return text that differs wherever the same question might have another answer."""
    source = sorted(_source(Path(clepsydra.__file__).parent))
    versions = (clepsydra.__version__, np.__version__, scipy.__version__, ca.CasadiMeta.version())
    python = f"{sys.implementation.cache_tag} {platform.python_version()}"
    return f"{_digest(chr(10).join(source).encode())} {versions} {python} {host().fingerprint}"


def _source(folder: str | Path) -> Iterator[str]:
    """Yield name, size and time of each file of Python; as paths they would take 7 ms."""
    with os.scandir(folder) as entries:
        for entry in entries:
            status = entry.stat()
            if stat.S_ISDIR(status.st_mode):
                yield from _source(entry.path)
            elif entry.path.endswith(".py"):
                yield f"{entry.path} {status.st_size} {status.st_mtime_ns}"
