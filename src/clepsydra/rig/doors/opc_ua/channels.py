"""One connection of a client: which messages are taken in it, and from whom."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from typing import Any

from asyncua import ua
from asyncua.common.connection import TransportLimits
from asyncua.common.utils import Buffer, ServiceError
from asyncua.server.binary_server_asyncio import BinaryServer, OPCUAProtocol
from asyncua.server.internal_session import SessionState
from asyncua.server.uaprocessor import UaProcessor
from asyncua.ua.ua_binary import header_from_binary, struct_from_binary, uatcp_to_binary

from clepsydra.rig.doors.opc_ua.internal_server import RigInternalServer
from clepsydra.rig.doors.opc_ua.limits import CHUNK, SMALLEST_CHUNK, UNSENT
from clepsydra.rig.doors.opc_ua.sessions import RigSession
from clepsydra.rig.doors.opc_ua.trust import TrustList
from clepsydra.rig.doors.wire_faults import WireFaults

_CODES, _MODES = ua.StatusCodes, ua.MessageSecurityMode
#: Of a channel: for how long its keys are good [ms], and the random bytes of one that is secured.
_SHORTEST, _LONGEST, _NONCE = 10_000, 3_600_000, 32
#: Messages begin in one of these ways, and then have their size.
_KINDS, _HEAD = {b"HEL", b"OPN", b"CLO", b"MSG"}, 8


def _requests(*names: str) -> dict[ua.NodeId, str]:
    return {
        ua.NodeId(getattr(ua.ObjectIds, f"{name}Request_Encoding_DefaultBinary")): name
        for name in names
    }


#: What anybody may ask, to find out how to connect.
_OPEN = _requests("GetEndpoints", "FindServers", "CloseSecureChannel")
_SESSION = _requests("CreateSession", "ActivateSession", "CloseSession")
_SERVICES = _requests(
    *("Read", "Write", "Browse", "TranslateBrowsePathsToNodeIds", "RegisterNodes"),
    *("UnregisterNodes", "CreateSubscription", "ModifySubscription", "DeleteSubscriptions"),
    *("TransferSubscriptions", "SetPublishingMode", "CreateMonitoredItems"),
    *("ModifyMonitoredItems", "DeleteMonitoredItems", "SetMonitoringMode", "Publish", "Republish"),
)


class RigProcessor(UaProcessor):
    """What is done with the messages of one connection.

    Parameters
    ----------
    server : RigInternalServer
    transport : asyncio.Transport
    limits : TransportLimits
    trust : TrustList
    plain : bool
        Whether sessions are made in channels without security.
    faults : WireFaults
        What an instructor does to the wires.
    slow : callable
        Called with words where a client is let go because it does not take what it is sent.
    """

    def __init__(
        self, server: RigInternalServer, transport: asyncio.Transport, limits: TransportLimits, *,
        trust: TrustList, plain: bool, faults: WireFaults, slow: Callable[[str], None],
    ) -> None:  # fmt: skip
        super().__init__(server, transport, limits)
        self._trust, self._plain, self._faults, self._slow = trust, plain, faults, slow

    @property
    def _mode(self) -> ua.MessageSecurityMode:
        return self._connection.security_policy.Mode

    @property
    def _peer(self) -> bytes:
        return bytes(self._connection.security_policy.peer_certificate or b"")

    async def process(self, header: Any, body: Buffer) -> bool:
        """Take one message; what is none ends the connection (OPC 10000-6, 7.1.5)."""
        # Whoever sends without a pause lets others have their turn, without a delay too.
        await asyncio.sleep(self._faults.delay)
        if self._faults.cut:
            self._transport.abort()
            return False
        active = self.session is not None and self.session.is_activated()
        try:
            if not active and header.ChunkType != ua.ChunkType.Single:
                raise ServiceError(_CODES.BadTcpMessageTooLarge)
            return bool(await super().process(header, body))
        except Exception as error:
            code = getattr(error, "code", _CODES.BadSecurityChecksFailed)
            self._end(int(code))
            return False

    def _end(self, code: int) -> None:
        words = ua.ErrorMessage(ua.StatusCode(code), "")
        self._transport.write(uatcp_to_binary(ua.MessageType.Error, words))

    def open_secure_channel(
        self, algohdr: ua.AsymmetricAlgorithmHeader, seqhdr: ua.SequenceHeader, body: Buffer
    ) -> None:
        """Open a channel, or give it new keys, where its client is trusted."""
        request = struct_from_binary(ua.OpenSecureChannelRequest, body)
        wanted = request.Parameters
        if not self._connection.is_open():
            self._connection.select_policy(
                algohdr.SecurityPolicyURI, algohdr.SenderCertificate, wanted.SecurityMode
            )
        if self._mode != _MODES.None_:
            refusal = self._trust.refusal(self._peer)
            if refusal:
                raise ServiceError(getattr(_CODES, refusal))
            if len(wanted.ClientNonce or b"") != _NONCE:
                raise ServiceError(_CODES.BadNonceInvalid)
        wanted.RequestedLifetime = min(max(int(wanted.RequestedLifetime), _SHORTEST), _LONGEST)
        response = ua.OpenSecureChannelResponse()
        response.Parameters = self._connection.open(wanted, self.iserver)
        self.send_response(
            request.RequestHeader.RequestHandle, seqhdr, response, ua.MessageType.SecureOpen
        )

    async def _process_message(
        self, typeid: ua.NodeId, requesthdr: ua.RequestHeader, seqhdr: ua.SequenceHeader,
        body: Buffer,
    ) -> bool:  # fmt: skip
        if self._faults.loses():
            return True
        if typeid not in _OPEN:
            if self._mode == _MODES.None_ and not (self._plain and self._connection.is_open()):
                raise ServiceError(_CODES.BadSecurityModeInsufficient)
            if typeid in _SESSION:
                self._check_session(_SESSION[typeid], requesthdr, body.copy())
            elif typeid not in _SERVICES:
                raise ServiceError(_CODES.BadServiceUnsupported)
            elif self.session is None or requesthdr.AuthenticationToken != self.session.auth_token:
                raise ServiceError(_CODES.BadSessionIdInvalid)
            else:
                self._forget_transferred()
        going_on = bool(await super()._process_message(typeid, requesthdr, seqhdr, body))
        if _SESSION.get(typeid) == "CreateSession" and isinstance(self.session, RigSession):
            self.session.certificate = self._peer
        return going_on

    def _forget_transferred(self) -> None:
        """Answer no request of this connection for subscriptions that went to another."""
        known = self.iserver.subscription_service.subscriptions
        for number in [*self._publish_results_subs]:
            found = known.get(number)
            if found is None or found.session_id != self.session.session_id:
                del self._publish_results_subs[number]

    def _check_session(self, name: str, requesthdr: ua.RequestHeader, body: Buffer) -> None:
        if name == "CreateSession":
            there = self.session is not None and self.session.state is not SessionState.Closed
            if there:
                raise ServiceError(_CODES.BadTooManySessions)
            named = struct_from_binary(ua.CreateSessionParameters, body).ClientCertificate
            # The certificate that is named has to be the one that the channel was opened with.
            if self._mode != _MODES.None_ and bytes(named or b"") != self._peer:
                raise ServiceError(_CODES.BadCertificateInvalid)
            return
        session = self.session or self.iserver.lookup_external_session(
            requesthdr.AuthenticationToken
        )
        if session is None or session.auth_token != requesthdr.AuthenticationToken:
            raise ServiceError(_CODES.BadSessionIdInvalid)
        if name == "ActivateSession" and isinstance(session, RigSession):
            if self.session is None and session.certificate != self._peer:
                raise ServiceError(_CODES.BadSecurityChecksFailed)
            session.mode = self._mode

    def send_response(self, *arguments: Any, **options: Any) -> None:
        """Send an answer, and let a client go that takes none of them."""
        if self._transport.is_closing():
            return
        super().send_response(*arguments, **options)
        if self._transport.get_write_buffer_size() > UNSENT:
            self._transport.abort()
            self._slow(f"{self.name} did not take what it had asked for, and was let go")


class RigConnection(OPCUAProtocol):
    """A connection, whose bytes become messages."""

    processor: RigProcessor | None

    def __init__(self, *arguments: Any, options: dict[str, Any], **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._options = options
        self._received = bytearray()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin with a client."""
        if self._options["faults"].cut:
            transport.close()
            return
        super().connection_made(transport)
        if self.processor is not None:
            assert isinstance(self.iserver, RigInternalServer)
            assert self.transport is not None
            self.processor = RigProcessor(
                self.iserver, self.transport, self.limits, **self._options
            )
            self.processor.set_policies(self.policies)

    def data_received(self, data: bytes) -> None:
        """Take bytes; none are kept that cannot become a message."""
        if self.transport is None or self.transport.is_closing():
            return
        self._received += data
        position = 0
        while len(self._received) - position >= _HEAD:
            kind = bytes(self._received[position : position + 3])
            size = int.from_bytes(self._received[position + 4 : position + _HEAD], "little")
            if kind not in _KINDS or not _HEAD + 4 < size <= CHUNK:
                self.transport.close()
                return
            if len(self._received) - position < size:
                break
            self._take(bytes(self._received[position : position + size]))
            position += size
        del self._received[:position]

    def _take(self, message: bytes) -> None:
        assert self.transport is not None
        try:
            content = Buffer(message)
            header = header_from_binary(content)
            if header.MessageType == ua.MessageType.Hello:
                _check_hello(content.copy())
            self.messages.put_nowait((header, content))
        except Exception:  # too many that wait, or what cannot be read
            self.transport.close()


def _check_hello(content: Buffer) -> None:
    """Refuse sizes of chunks in which no answer fits (OPC 10000-6, 7.1.2.3)."""
    hello = struct_from_binary(ua.Hello, content)
    if min(hello.ReceiveBufferSize, hello.SendBufferSize) < SMALLEST_CHUNK:
        raise ServiceError(_CODES.BadConnectionRejected)


class RigBinaryServer(BinaryServer):
    """The socket of a server, and its connections.

    Parameters
    ----------
    options : dict
        Of each connection's `RigProcessor`.
    """

    def __init__(self, *arguments: Any, options: dict[str, Any]) -> None:
        super().__init__(*arguments)
        self._options = options

    def _make_protocol(self) -> OPCUAProtocol:
        return RigConnection(
            iserver=self.iserver, policies=self._policies, clients=self.clients,
            closing_tasks=self.closing_tasks, limits=self.limits, options=self._options,
        )  # fmt: skip


def transport_limits(message: int) -> TransportLimits:
    """Return how large messages and their chunks are at most [bytes]."""
    return TransportLimits(
        max_recv_buffer=CHUNK, max_send_buffer=CHUNK, max_message_size=message,
        max_chunk_count=math.ceil(message / SMALLEST_CHUNK),
    )  # fmt: skip
