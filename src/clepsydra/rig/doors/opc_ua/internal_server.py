"""The inside of a server: its bounds, its sessions, and how users prove who they are."""

from __future__ import annotations

from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.crypto import uacrypto
from asyncua.crypto.permission_rules import User, UserRole
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession

from clepsydra.rig.doors.opc_ua import limits
from clepsydra.rig.doors.opc_ua.sessions import RigSession
from clepsydra.rig.doors.opc_ua.subscriptions import RigSubscriptions
from clepsydra.rig.doors.opc_ua.users import Users

_OAEP = {
    "http://www.w3.org/2001/04/xmlenc#rsa-oaep": uacrypto.decrypt_rsa_oaep,
    "http://opcfoundation.org/UA/security/rsa-oaep-sha2-256": uacrypto.decrypt_rsa_oaep_sha256,
}
_SIGNATURES = {
    "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
    "http://opcfoundation.org/UA/security/rsa-pss-sha2-256",
}
_NOBODY = User(role=UserRole.Anonymous)


class RigInternalServer(InternalServer):
    """The inside of a server.

    Parameters
    ----------
    users : Users
    session : type of RigSession
        With the tags of the rig.
    """

    def __init__(self, users: Users, session: type[RigSession]) -> None:
        super().__init__(user_manager=users)
        self._session = session
        self.allow_remote_admin = False
        self.min_session_timeout_ms = limits.SHORTEST_SESSION
        self.max_session_timeout_ms = limits.LONGEST_SESSION
        self.max_unacked_messages_per_subscription = limits.UNACKNOWLEDGED
        self.max_monitored_item_queue_size = limits.QUEUED_VALUES
        self.max_pending_messages_per_connection = limits.WAITING_MESSAGES
        self.max_connections = limits.CONNECTIONS
        self.max_pending_activation_seconds = limits.UNUSED_CONNECTION
        self.max_lifetime_count = limits.LIFETIME
        self.max_keep_alive_count = limits.KEEP_ALIVE
        self.max_subscriptions = limits.SUBSCRIPTIONS
        self.rig_subscriptions = RigSubscriptions(self.aspace, self)
        self.subscription_service = self.rig_subscriptions

    def create_session(
        self, name: str, user: User = _NOBODY, external: bool = False
    ) -> InternalSession:
        """Make a session, as long as there is room for one."""
        if len(self._external_sessions) >= limits.SESSIONS:
            raise ServiceError(ua.StatusCodes.BadTooManySessions)
        return self._session(
            self, self.aspace, self.subscription_service, name, user=user, external=external
        )

    def decrypt_user_token(
        self, isession: RigSession, token: ua.UserNameIdentityToken
    ) -> tuple[str, str]:
        """Return the name and the password of a user (OPC 10000-4 1.05, 7.40.2.2).

        A password that is not encrypted comes in through an encrypted channel alone, one that is
        ends in the last nonce of the server, so that it cannot be sent a second time.
        """
        secret = bytes(token.Password or b"")
        if not token.EncryptionAlgorithm:
            if isession.mode != ua.MessageSecurityMode.SignAndEncrypt:
                raise ServiceError(ua.StatusCodes.BadIdentityTokenInvalid)
        elif token.EncryptionAlgorithm in _OAEP:
            plain = _OAEP[token.EncryptionAlgorithm](self.private_key, secret)
            length = int.from_bytes(plain[:4], "little")
            nonce = isession.nonce or b""
            if length != len(plain) - 4 or not plain.endswith(nonce) or length < len(nonce):
                raise ServiceError(ua.StatusCodes.BadIdentityTokenInvalid)
            secret = plain[4 : len(plain) - len(nonce)]
        else:
            raise ServiceError(ua.StatusCodes.BadIdentityTokenInvalid)
        return str(token.UserName or ""), secret.decode("utf-8")

    def verify_x509_token(
        self, isession: Any, token: ua.X509IdentityToken, signature: ua.SignatureData
    ) -> bytes:
        """Return the certificate of a user, who has signed with its key, and not by SHA-1."""
        if signature.Algorithm not in _SIGNATURES:
            raise ServiceError(ua.StatusCodes.BadUserSignatureInvalid)
        return super().verify_x509_token(isession, token, signature)
