"""Who a program is to others of OPC UA: its certificate and its key, made where there are none."""

from __future__ import annotations

import ipaddress
import os
import socket
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.files import make_folder
from clepsydra.base.standing import Standing, standing_at

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey
    from cryptography.x509 import Certificate, GeneralName

#: For how long a certificate is valid, and since when: a client's clock may be late.
_VALID, _BEFORE = timedelta(days=5 * 365), timedelta(days=1)
_BITS = 2048
#: Of what it is called, in the certificate.
_LONGEST_NAME = 64


@dataclass(frozen=True)
class Identity:
    """A certificate and its key, in a folder.

    Parameters
    ----------
    folder : Path
    application : str
        "rig", "controller": what the program is, in its application URI.
    """

    folder: Path
    application: str

    @property
    def certificate(self) -> Path:
        """The certificate, in DER."""
        return self.folder / "certificate.der"

    @property
    def key(self) -> Path:
        """The private key, in PEM; nobody else may read it."""
        return self.folder / "private_key.pem"

    @property
    def uri(self) -> str:
        """The application URI, which the certificate holds too (OPC 10000-6, 6.2.2)."""
        return f"urn:{socket.gethostname()}:clepsydra:{self.application}"

    @property
    def _is_there(self) -> bool:
        paths = (self.certificate, self.key)
        return any(
            standing_at(path, str(path), "a certificate and its key") is not Standing.NOTHING
            for path in paths
        )

    def check(self) -> None:
        """Refuse what stands in the folder and cannot be used.

        Raises
        ------
        InputError
            The certificate has expired or is not yet valid, is of another key or cannot be read.
        """
        if self._is_there:
            self._check(self._read(), datetime.now(UTC))

    def make(self, host: str = "") -> None:
        """Make the certificate and its key where neither is there.

        Parameters
        ----------
        host : str
            An address or a name under which others reach the program, beside that of the machine.
        """
        if not self._is_there:
            make_folder(self.folder, "folder of certificates")
            self._make(host)
        self.check()

    def _read(self) -> tuple[Certificate, RSAPrivateKey]:
        from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey
        from cryptography.hazmat.primitives.serialization import load_pem_private_key
        from cryptography.x509 import load_der_x509_certificate

        place: Path = self.certificate
        try:
            certificate = load_der_x509_certificate(self.certificate.read_bytes())
            place = self.key
            key = load_pem_private_key(self.key.read_bytes(), password=None)
            if not isinstance(key, RSAPrivateKey):
                raise ValueError("not of RSA")
        except (OSError, ValueError, TypeError):
            raise InputError(
                str(place), Finding("what cannot be read"), "a certificate in DER, a key in PEM",
                "put it right, or move both away: new ones are made",
            ) from None  # fmt: skip
        return certificate, key

    def _check(self, read: tuple[Certificate, RSAPrivateKey], now: datetime) -> None:
        certificate, key = read
        place = str(self.certificate)
        remedy = f"move it and {self.key.name} away, and a new one is made, or put yours there"
        since, until = certificate.not_valid_before_utc, certificate.not_valid_after_utc
        if now > until:
            found = Finding(f"a certificate that expired on {until:%Y-%m-%d %H:%M} UTC")
            raise InputError(place, found, "one that is valid", remedy)
        if now < since:
            found = Finding(f"a certificate that is valid from {since:%Y-%m-%d %H:%M} UTC only")
            raise InputError(place, found, "one that is valid", f"set the clock, or {remedy}")
        if certificate.public_key() != key.public_key():
            raise InputError(place, Finding("that of another key"), f"that of {self.key}", remedy)

    def _make(self, host: str) -> None:
        from cryptography.hazmat.primitives.asymmetric import rsa
        from cryptography.hazmat.primitives.serialization import (
            Encoding,
            NoEncryption,
            PrivateFormat,
        )

        key = rsa.generate_private_key(public_exponent=65537, key_size=_BITS)
        certificate = _signed(key, self.uri, f"clepsydra {self.application}", host)
        text = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
        write_secret(self.key, text)
        self.certificate.write_bytes(certificate.public_bytes(Encoding.DER))


def write_secret(path: Path, content: bytes) -> None:
    """Write a new file that its owner alone may read."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(handle, "wb") as stream:
        stream.write(content)


def _signed(key: RSAPrivateKey, uri: str, title: str, host: str) -> Certificate:
    """Return a certificate that its own key has signed (OPC 10000-6, 6.2.2)."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    machine = socket.gethostname()
    name = x509.Name(
        [x509.NameAttribute(NameOID.COMMON_NAME, f"{title} on {machine}"[:_LONGEST_NAME])]
    )
    others = [_general_name(each) for each in dict.fromkeys((machine, host)) if each]
    now = datetime.now(UTC)
    builder = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _BEFORE)
        .not_valid_after(now + _VALID)
        .add_extension(
            x509.SubjectAlternativeName([x509.UniformResourceIdentifier(uri), *others]), False
        )
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), False)
        .add_extension(
            x509.KeyUsage(
                digital_signature=True, content_commitment=True, key_encipherment=True,
                data_encipherment=True, key_agreement=False, key_cert_sign=True, crl_sign=False,
                encipher_only=False, decipher_only=False,
            ),
            True,
        )
        .add_extension(
            x509.ExtendedKeyUsage(
                [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]
            ),
            False,
        )
    )  # fmt: skip
    return builder.sign(key, hashes.SHA256())


def _general_name(host: str) -> GeneralName:
    from cryptography import x509

    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)
