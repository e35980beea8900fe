"""What strangers send to a door of OPC UA: random bytes, and messages with bytes changed."""

import random
import struct

from asyncua import ua
from asyncua.common.connection import SecureConnection, TransportLimits
from asyncua.crypto.security_policies import SecurityPolicyNone
from asyncua.ua.ua_binary import struct_to_binary, uatcp_to_binary

HELLO = uatcp_to_binary(
    ua.MessageType.Hello,
    ua.Hello(0, 65535, 65535, 0, 0, "opc.tcp://127.0.0.1:4840/clepsydra"),
)
_TOKEN = ua.NodeId(1000)


class Frames:
    """Frames that are the same for the same seed."""

    def __init__(self, seed):
        self.draws = random.Random(seed)

    def random_bytes(self):
        return self.draws.randbytes(self.draws.choice((1, 7, 8, 12, 40, 300, 5000)))

    def with_a_head(self):
        """Random bytes behind a head that says how many there are, or nearly."""
        body = self.random_bytes()
        kind = self.draws.choice((b"HEL", b"OPN", b"MSG", b"CLO", b"ERR", b"ACK"))
        size = len(body) + 8 + self.draws.choice((0, 0, 0, 0, 1, -1, 1 << 20, -len(body)))
        return (
            kind
            + self.draws.choice(b"FCA").to_bytes(1, "little")
            + struct.pack("<I", size & 0xFFFFFFFF)
            + body
        )

    def changed(self, frame):
        """Change, double, leave out or move some bytes, and let the head say how many there are."""
        found = bytearray(frame)
        for _ in range(self.draws.choice((1, 1, 2, 5, 20))):
            if len(found) < 9:
                break
            at = self.draws.randrange(8, len(found))
            way = self.draws.randrange(6)
            if way == 0:
                found[at] = self.draws.randrange(256)
            elif way == 1:
                found[at] ^= 1 << self.draws.randrange(8)
            elif way == 2:
                del found[at : at + self.draws.randrange(1, 9)]
            elif way == 3:
                found[at:at] = self.draws.randbytes(self.draws.randrange(1, 9))
            elif way == 4:
                found[at : at + 4] = struct.pack(
                    "<i", self.draws.choice((-1, 0, 1, 255, 1 << 16, (1 << 31) - 1))
                )
            else:
                found[at:at] = found[at : at + self.draws.randrange(1, 60)]
        if self.draws.random() < 0.9 and len(found) >= 8:
            found[4:8] = struct.pack("<I", len(found))
        return bytes(found)


class Talk:
    """The messages of a client without security, one after the other."""

    def __init__(self):
        self.connection = SecureConnection(SecurityPolicyNone(), TransportLimits())
        self.number, self.token = 0, _TOKEN

    def message(self, request, kind=ua.MessageType.SecureMessage):
        self.number += 1
        request.RequestHeader.RequestHandle = self.number
        request.RequestHeader.AuthenticationToken = self.token
        request.RequestHeader.TimeoutHint = 1000
        return self.connection.message_to_binary(struct_to_binary(request), kind, self.number)

    def open(self):
        request = ua.OpenSecureChannelRequest()
        request.Parameters.SecurityMode = ua.MessageSecurityMode.None_
        request.Parameters.RequestedLifetime = 60_000
        request.Parameters.ClientNonce = b""
        return self.message(request, ua.MessageType.SecureOpen)

    def opened(self, answer):
        """Take the number of the channel from the answer of the server."""
        self.connection.security_token.ChannelId = int.from_bytes(answer[8:12], "little")
        self.connection.security_token.TokenId = 13

    def session(self):
        request = ua.CreateSessionRequest()
        request.Parameters.RequestedSessionTimeout = 5000.0
        request.Parameters.EndpointUrl = "opc.tcp://127.0.0.1:4840/clepsydra"
        request.Parameters.SessionName = "stranger"
        return self.message(request)

    def activation(self):
        request = ua.ActivateSessionRequest()
        request.Parameters.UserIdentityToken = ua.AnonymousIdentityToken("anonymous")
        return self.message(request)

    def requests(self, index):
        """Return a request of each kind that a session makes, of tags in a namespace."""
        node = ua.NodeId("level.pv", index)
        read, write, browse = ua.ReadRequest(), ua.WriteRequest(), ua.BrowseRequest()
        read.Parameters.NodesToRead = [ua.ReadValueId(node, ua.AttributeIds.Value)]
        write.Parameters.NodesToWrite = [
            ua.WriteValue(
                ua.NodeId("pump.out", index), ua.AttributeIds.Value, Value=ua.DataValue(1.0)
            )
        ]
        browse.Parameters.NodesToBrowse = [
            ua.BrowseDescription(ua.NodeId(ua.ObjectIds.ObjectsFolder))
        ]
        paths = ua.TranslateBrowsePathsToNodeIdsRequest()
        element = ua.RelativePathElement(TargetName=ua.QualifiedName("Rig", index))
        paths.Parameters.BrowsePaths = [
            ua.BrowsePath(ua.NodeId(ua.ObjectIds.ObjectsFolder), ua.RelativePath([element]))
        ]
        subscription = ua.CreateSubscriptionRequest()
        subscription.Parameters.RequestedPublishingInterval = 50.0
        items = ua.CreateMonitoredItemsRequest()
        items.Parameters.SubscriptionId = 78
        passing = ua.DataChangeFilter(ua.DataChangeTrigger.StatusValue, 1, 5.0)
        items.Parameters.ItemsToCreate = [
            ua.MonitoredItemCreateRequest(
                ua.ReadValueId(node, ua.AttributeIds.Value), ua.MonitoringMode.Reporting,
                ua.MonitoringParameters(1, 0.0, passing, 10, True),
            )
        ]  # fmt: skip
        return [
            read,
            write,
            browse,
            paths,
            subscription,
            items,
            ua.PublishRequest(),
            ua.GetEndpointsRequest(),
        ]
