"""The certificates of clients: those that are trusted, and those that were refused."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.standing import Standing, standing_at
from clepsydra.rig.doors.opc_ua.limits import REJECTED

if TYPE_CHECKING:
    from cryptography.x509 import Certificate

_SMALLEST_KEY = 2048
_NO_LETTERS = re.compile(r"[^A-Za-z0-9._-]+")


@dataclass
class TrustList:
    """What stands in `trusted`, byte by byte; what did not is kept in `rejected`.

    No authority is asked: whoever may connect has a certificate of its own in the folder.

    Parameters
    ----------
    folder : Path
        With the two in it.
    report : callable
        Takes words.
    """

    folder: Path
    report: Callable[[str], None] = field(default=lambda words: None, repr=False)

    def __post_init__(self) -> None:
        self._told: set[str] = set()

    @property
    def trusted(self) -> Path:
        """The certificates of those who may connect, in DER or PEM."""
        return self.folder / "trusted"

    @property
    def rejected(self) -> Path:
        """The certificates of those who tried to."""
        return self.folder / "rejected"

    def make(self) -> None:
        """Make the folders where they are missing."""
        for folder in (self.trusted, self.rejected):
            folder.mkdir(parents=True, exist_ok=True)

    def add(self, certificate: Path) -> None:
        """Trust a certificate in DER."""
        self.make()
        content = certificate.read_bytes()
        (self.trusted / f"{_thumbprint(content)}.der").write_bytes(content)

    def refusal(self, content: bytes) -> str:
        """Return why the certificate of a client is not taken; empty where it is.

        What is returned is the name of a status code of OPC UA (OPC 10000-4, 6.1.3).
        """
        from cryptography.x509 import load_der_x509_certificate

        try:
            certificate = load_der_x509_certificate(content)
            since, until = certificate.not_valid_before_utc, certificate.not_valid_after_utc
            bits = getattr(certificate.public_key(), "key_size", 0)
        except ValueError:
            return "BadCertificateInvalid"
        who = _NO_LETTERS.sub(" ", certificate.subject.rfc4514_string()).strip()
        if bits < _SMALLEST_KEY:
            self._tell(content, f"the key of {who} has less than {_SMALLEST_KEY} bits")
            return "BadCertificatePolicyCheckFailed"
        if not any(content == each for each in self._all_trusted()):
            self._reject(content, who)
            return "BadCertificateUntrusted"
        if not since <= datetime.now(UTC) <= until:
            self._tell(
                content, f"the certificate of {who} is valid from {since:%Y-%m-%d} to "
                f"{until:%Y-%m-%d}: let the client make a new one",
            )  # fmt: skip
            return "BadCertificateTimeInvalid"
        return ""

    def _all_trusted(self) -> list[bytes]:
        found = []
        for path in sorted(self.trusted.glob("*")):
            try:
                found.append(_der(path.read_bytes()))
            except (OSError, ValueError):
                self._tell(str(path).encode(), f"{path} is no certificate in DER or PEM")
        return found

    def _reject(self, content: bytes, who: str) -> None:
        path = self.rejected / f"{who[:60]} {_thumbprint(content)[:16]}.der"
        if standing_at(path, str(path), "a certificate") is Standing.NOTHING:
            if sum(1 for _ in self.rejected.iterdir()) >= REJECTED:
                self._tell(b"", f"{self.rejected} is full: remove what is not needed")
                return
            path.write_bytes(content)
        self._tell(
            content, f"a client with the certificate of {who} was refused: to trust it, move "
            f"{path} to {self.trusted}",
        )  # fmt: skip

    def _tell(self, content: bytes, words: str) -> None:
        """Say something of a certificate, once: who is refused tries again and again."""
        key = _thumbprint(content)
        if key not in self._told and len(self._told) <= REJECTED:
            self._told.add(key)
            self.report(words)


def _der(content: bytes) -> bytes:
    from cryptography.hazmat.primitives.serialization import Encoding
    from cryptography.x509 import load_der_x509_certificate, load_pem_x509_certificate

    found: Certificate
    if content.lstrip().startswith(b"-----BEGIN"):
        found = load_pem_x509_certificate(content)
    else:
        found = load_der_x509_certificate(content)
    return found.public_bytes(Encoding.DER)


def _thumbprint(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
