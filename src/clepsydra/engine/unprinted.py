"""LLVM code that is printed only where what it becomes is not kept from before."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from clepsydra.engine.canonical_bytes import canonical_bytes

#: The packages that printing is made of: this one, and those that it imports.
_PACKAGES = "base", "engine", "program"


@dataclass(frozen=True)
class Unprinted:
    """LLVM code that is printed when it is asked for.

    Parameters
    ----------
    content : str
        Differs wherever the code might: part of the key under which machine code is kept.
    code : callable
        Prints the code.
    """

    content: str
    code: Callable[[], str]

    @classmethod
    def by(cls, printer: Callable[..., str], *given: object) -> Unprinted:
        """Return what a function of the engine prints of what it is given.

        Parameters
        ----------
        printer : callable
            Reads nothing but its arguments.
        *given
            Its arguments, see `clepsydra.engine.canonical_bytes`.

        Examples
        --------
        >>> def tripled(word: str) -> str:
        ...     return 3 * word
        >>> one, same, other = (Unprinted.by(tripled, word) for word in ("a", "a", "b"))
        >>> one.code(), one.content == same.content, one.content == other.content
        ('aaa', True, False)
        """
        name = f"{printer.__module__}.{printer.__qualname__}"
        digest = hashlib.sha256(f"{name} {_PRINTED_BY} ".encode())
        digest.update(canonical_bytes(given))
        return cls(digest.hexdigest(), partial(printer, *given))


def source_digest(packages: Path) -> str:
    """Return a digest of every file in those packages of a folder that printing is made of."""
    digest = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted(_files(packages / package)):
            content = path.read_bytes()
            digest.update(f"{path.relative_to(packages)} {len(content)} ".encode())
            digest.update(content)
    return digest.hexdigest()


def _files(package: Path) -> Iterator[Path]:
    """Yield the paths of the files of a package, but for the byte code that Python keeps."""
    for folder, _, names in os.walk(package):
        if not folder.endswith("__pycache__"):
            yield from (Path(folder, name) for name in names)


#: What prints. Read while the printers are loaded, so that it is of them, whatever becomes of
#: their files later.
_PRINTED_BY = f"{source_digest(Path(__file__).parent.parent)} {platform.python_version()}"
