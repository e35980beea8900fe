"""Who may write: the operator with a password, and whoever has a trusted certificate."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.standing import Standing, standing_at
from clepsydra.rig.doors.opc_ua.identity import write_secret
from clepsydra.rig.doors.opc_ua.trust import TrustList

if TYPE_CHECKING:
    from asyncua.crypto.permission_rules import User

#: The one user with a password, and the file that it is in.
OPERATOR, PASSWORD = "operator", "operator.password"
_EXPECTED = "the file of its password"
#: Of a password [random bytes]; what its file may be for its owner alone.
_BYTES, _OTHERS = 18, 0o077


def password_in(folder: Path) -> str:
    """Return the password of the operator, made where there is none.

    Raises
    ------
    InputError
        Others may read its file, or it is empty.
    """
    path = folder / PASSWORD
    if standing_at(path, str(path), _EXPECTED) is Standing.NOTHING:
        write_secret(path, secrets.token_urlsafe(_BYTES).encode())
    check_password(folder)
    return path.read_text("utf-8").strip()


def check_password(folder: Path) -> None:
    """Refuse a file of the password that is empty or that others may read."""
    path = folder / PASSWORD
    if standing_at(path, str(path), _EXPECTED) is Standing.NOTHING:
        return
    if path.stat().st_mode & _OTHERS:
        raise InputError(
            str(path), Finding("a password that others may read"), "one of its owner alone",
            f"chmod 600 {path}",
        )  # fmt: skip
    if not path.read_text("utf-8", errors="replace").strip():
        raise InputError(
            str(path), Finding("no password"), "one", "write one, or remove the file: one is made"
        )


@dataclass(frozen=True)
class Users:
    """Who comes in, and as whom.

    Parameters
    ----------
    password : str
        Of the operator.
    trust : TrustList
        Of certificates.
    anonymous : bool
        Whether somebody without a name may read.
    """

    password: str
    trust: TrustList
    anonymous: bool

    def get_user(
        self, iserver: Any, username: str | None = None, password: str | None = None,
        certificate: bytes | None = None,
    ) -> User | None:  # fmt: skip
        """Return who it is, as asyncua asks for it; None where nobody is known by that."""
        from asyncua.crypto.permission_rules import User, UserRole

        if username is not None:
            # Both are compared, so that how long it takes says nothing of either.
            same = hmac.compare_digest(username.encode(), OPERATOR.encode())
            right = hmac.compare_digest((password or "").encode(), self.password.encode())
            return User(role=UserRole.User, name=OPERATOR) if same and right else None
        if certificate is not None:
            known = not self.trust.refusal(certificate)
            return User(role=UserRole.User, name="certificate") if known else None
        return User(role=UserRole.Anonymous) if self.anonymous else None
