"""A server of OPC UA for the tags of a rig."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
from collections.abc import Callable
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from asyncua import Server, ua
from asyncua.crypto import security_policies

from clepsydra.rig.doors.opc_ua.address_space import add_tags
from clepsydra.rig.doors.opc_ua.channels import RigBinaryServer, transport_limits
from clepsydra.rig.doors.opc_ua.decoding import guard
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.internal_server import RigInternalServer
from clepsydra.rig.doors.opc_ua.limits import MESSAGE
from clepsydra.rig.doors.opc_ua.sessions import RigSession
from clepsydra.rig.doors.opc_ua.tag_values import TagValues
from clepsydra.rig.doors.opc_ua.trust import TrustList
from clepsydra.rig.doors.opc_ua.users import Users
from clepsydra.rig.doors.opc_ua.watched_tags import WatchedTags
from clepsydra.rig.doors.wire_faults import WireFaults
from clepsydra.rig.tag_table import TagTable

_POLICIES = [
    getattr(ua.SecurityPolicyType, f"{policy}_{mode}")
    for policy in ("Basic256Sha256", "Aes128Sha256RsaOaep", "Aes256Sha256RsaPss")
    for mode in ("Sign", "SignAndEncrypt")
]
#: Between two looks at the plant: a share of the time between its samples [s].
_SHARE, _SHORTEST, _LONGEST = 0.05, 0.002, 0.02


class RigServer(Server):
    """A server of the tags of a rig.

    Parameters
    ----------
    table : TagTable
    identity : Identity
    users : Users
    trust : TrustList
    report : callable
        Takes words.
    silent_after : float
        Where the plant has told nothing for so long, its tags have no values [s].
    seed : int
        Of which requests are lost where an instructor lets requests be lost.
    """

    def __init__(
        self, table: TagTable, identity: Identity, users: Users, trust: TrustList,
        report: Callable[[str], None], silent_after: float = math.inf, seed: int = 1,
    ) -> None:  # fmt: skip
        guard()
        self._session = type("Session", (RigSession,), {"table": table})
        self._inside = RigInternalServer(users, self._session)
        super().__init__(iserver=self._inside)
        self._table, self._identity, self._users = table, identity, users
        self._trust, self._report, self._silent_after = trust, report, silent_after
        self._faults = WireFaults(table.image, seed)
        self.limits = transport_limits(MESSAGE)
        self.name = "Clepsydra rig"
        self.product_uri = "urn:clepsydra:rig"
        self.manufacturer_name = "Clepsydra"
        self.application_type = ua.ApplicationType.Server
        self._application_uri = identity.uri
        # What a user may do is asked where it is done: in channels and sessions.
        self._permission_ruleset = None

    async def init_rig(self, host: str, port: int) -> None:
        """Make its nodes and read its certificate, before it starts."""
        await self.init()
        with contextlib.suppress(PackageNotFoundError):
            release = version("clepsydra")
            await self.set_build_info(
                self.product_uri, self.manufacturer_name, self.name, release, release,
                datetime.now(UTC),
            )  # fmt: skip
        await self.load_certificate(self._identity.certificate, "der")
        await self.load_private_key(self._identity.key, format="pem")
        self.set_endpoint(f"opc.tcp://{host}:{port}/clepsydra")
        plain = [ua.SecurityPolicyType.NoSecurity] if self._users.anonymous else []
        self.set_security_policy([*_POLICIES, *plain])
        tokens: list[type] = [ua.UserNameIdentityToken, ua.X509IdentityToken]
        if self._users.anonymous:
            tokens.append(ua.AnonymousIdentityToken)
        self.set_identity_tokens(tokens)
        nodes = await add_tags(self, tuple(self._table.tags.values()))
        values = TagValues(self._table, self._silent_after)
        self.watched = WatchedTags(values, nodes, self._table.tags)
        self._session.watched = self.watched  # type: ignore[attr-defined]
        self._inside.rig_subscriptions.watched = self.watched

    def _set_endpoints(
        self, policy: type[security_policies.SecurityPolicy], mode: ua.MessageSecurityMode,
        level: int,
    ) -> None:  # fmt: skip
        super()._set_endpoints(policy, mode, level)
        if mode == ua.MessageSecurityMode.None_:
            offered = self._inside.endpoints[-1]
            offered.UserIdentityTokens = [
                token
                for token in offered.UserIdentityTokens
                if token.TokenType == ua.UserTokenType.Anonymous
            ]

    async def start(self) -> None:
        """Listen to clients."""
        await self._setup_server_nodes()
        await self._inside.start()
        host, port = self._get_bind_socket_info()
        options = {
            "trust": self._trust,
            "plain": self._users.anonymous,
            "faults": self._faults,
            "slow": self._report,
        }
        self.bserver = RigBinaryServer(self._inside, host, port, self.limits, options=options)
        self.bserver.set_policies(self._policies)
        try:
            await self.bserver.start()
        except BaseException:
            await self._inside.stop()
            raise

    async def follow(self) -> None:
        """Tell what the plant shows, each sample soon after it is there."""
        values, loop = self.watched.values, asyncio.get_running_loop()
        wait, since = _LONGEST, loop.time()
        while True:
            if self._faults.cut:
                for transport in self._inside.asyncio_transports:
                    transport.abort()
            before = values.sample
            self.watched.look()
            if values.sample != before:
                now = loop.time()
                wait = min(max(_SHARE * (now - since), _SHORTEST), _LONGEST)
                since = now
            await asyncio.sleep(wait)


def silence_asyncua() -> None:
    """Let asyncua write nothing of what strangers send it."""
    logger = logging.getLogger("asyncua")
    logger.addHandler(logging.NullHandler())
    logger.propagate = False
    logger.setLevel(logging.CRITICAL)
