"""The sessions of a server: who reads and writes what, and how much of it."""

from __future__ import annotations

import dataclasses
import secrets
import time
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.crypto.permission_rules import UserRole
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession

from clepsydra.rig.doors.opc_ua.address_space import data_type
from clepsydra.rig.doors.opc_ua.limits import NODES, WRITES
from clepsydra.rig.doors.opc_ua.watched_tags import WatchedTags
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import Refusal, Refused, TagTable

_CODES = ua.StatusCodes
_REFUSALS = {
    Refusal.NOT_WRITABLE: _CODES.BadNotWritable,
    Refusal.NO_NUMBER: _CODES.BadOutOfRange,
    Refusal.NO_WHOLE_NUMBER: _CODES.BadTypeMismatch,
    Refusal.OUT_OF_RANGE: _CODES.BadOutOfRange,
}
#: References that one request to browse returns at most.
_REFERENCES = 20_000


class RigSession(InternalSession):
    """A session of a client.

    Attributes
    ----------
    mode : ua.MessageSecurityMode
        Of the channel that it is on.
    certificate : bytes
        Of the client that made it.
    """

    table: TagTable
    watched: WatchedTags

    def __init__(self, server: InternalServer, *arguments: Any, **options: Any) -> None:
        super().__init__(server, *arguments, **options)
        self.mode, self.certificate = ua.MessageSecurityMode.Invalid, b""
        self._credit, self._credited = WRITES, time.monotonic()
        if self.external:
            # asyncua counts its tokens, so that any client could guess another's.
            server.unregister_external_session(self)
            self.auth_token = ua.NodeId(secrets.token_bytes(32), 0, ua.NodeIdType.ByteString)
            server.register_external_session(self)

    def activate_session(
        self, params: ua.ActivateSessionParameters, peer_certificate: bytes | None
    ) -> ua.ActivateSessionResult:
        """Let a user in; the certificate of the channel makes nobody a user."""
        token = params.UserIdentityToken
        named = isinstance(token, ua.UserNameIdentityToken | ua.X509IdentityToken)
        if named and self.mode == ua.MessageSecurityMode.None_:
            raise ServiceError(_CODES.BadIdentityTokenRejected)
        return super().activate_session(params, None)

    async def read(self, params: ua.ReadParameters) -> list[ua.DataValue]:
        """Read attributes; of tags what was seen of them last."""
        wanted = params.NodesToRead or []
        _bound(wanted)
        now = datetime.now(UTC)
        return [self._read(each, params.TimestampsToReturn, now) for each in wanted]

    def _read(
        self, wanted: ua.ReadValueId, stamps: ua.TimestampsToReturn, now: datetime
    ) -> ua.DataValue:
        if wanted.AttributeId != ua.AttributeIds.Value:
            return self.aspace.read_attribute_value(wanted.NodeId, wanted.AttributeId)
        if wanted.IndexRange:
            return ua.DataValue(StatusCode=ua.StatusCode(_CODES.BadIndexRangeInvalid))
        tag = self.watched.tag_of(wanted.NodeId)
        if tag is None:
            found = self.aspace.read_attribute_value(wanted.NodeId, wanted.AttributeId)
        else:
            found = self.watched.values.told(tag.name).data_value()
        source = stamps in (ua.TimestampsToReturn.Source, ua.TimestampsToReturn.Both)
        server = stamps in (ua.TimestampsToReturn.Server, ua.TimestampsToReturn.Both)
        return dataclasses.replace(
            found, SourceTimestamp=found.SourceTimestamp if source else None,
            ServerTimestamp=now if server else None,
        )  # fmt: skip

    async def write(self, params: ua.WriteParameters) -> list[ua.StatusCode]:
        """Write tags; nothing else of the server is written."""
        wanted = params.NodesToWrite or []
        _bound(wanted)
        return [ua.StatusCode(self._written(each)) for each in wanted]

    def _written(self, wanted: ua.WriteValue) -> int:
        tag = self.watched.tag_of(wanted.NodeId)
        if tag is None:
            known = wanted.NodeId in self.aspace
            return int(_CODES.BadNotWritable if known else _CODES.BadNodeIdUnknown)
        if self.user is None or self.user.role is not UserRole.User:
            return int(_CODES.BadUserAccessDenied)
        if wanted.AttributeId != ua.AttributeIds.Value:
            return int(_CODES.BadNotWritable)
        if wanted.IndexRange:
            return int(_CODES.BadIndexRangeInvalid)
        value = _scalar(tag, wanted.Value)
        if value is None:
            return int(_CODES.BadTypeMismatch)
        if not self._may_write():
            return int(_CODES.BadTooManyOperations)
        try:
            self.table.write(tag, value)
        except Refused as refused:
            return int(_REFUSALS[refused.why])
        # What is told is what stands there now, not what was sent.
        self.watched.look_at(tag)
        return int(_CODES.Good)

    def _may_write(self) -> bool:
        now = time.monotonic()
        self._credit = min(WRITES, self._credit + WRITES * (now - self._credited))
        self._credited = now
        if self._credit < 1.0:
            return False
        self._credit -= 1.0
        return True

    async def browse(self, params: ua.BrowseParameters) -> list[ua.BrowseResult]:
        """Browse nodes, as many references as go into one answer."""
        wanted = params.NodesToBrowse or []
        _bound(wanted)
        left, results = _REFERENCES, []
        for each in wanted:
            if left <= 0:
                full = ua.BrowseResult()
                full.StatusCode = ua.StatusCode(_CODES.BadNoContinuationPoints)
                results.append(full)
                continue
            found = self.iserver.view_service._browse(each)
            left -= len(found.References)
            results.append(found)
        return results

    async def translate_browsepaths_to_nodeids(
        self, params: list[ua.BrowsePath]
    ) -> list[ua.BrowsePathResult]:
        """Find nodes by the names on the way to them."""
        _bound(params or [])
        return await super().translate_browsepaths_to_nodeids(params or [])

    def _own(self, subscription: int) -> None:
        """Refuse a subscription of another session: asyncua gives any to any."""
        found = self.subscription_service.subscriptions.get(subscription)
        if found is None or found.session_id != self.session_id:
            raise ServiceError(_CODES.BadSubscriptionIdInvalid)

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        """Watch nodes by a subscription of this session."""
        self._own(params.SubscriptionId)
        return await self.subscription_service.create_monitored_items(params)

    async def modify_monitored_items(
        self, params: ua.ModifyMonitoredItemsParameters
    ) -> list[ua.MonitoredItemModifyResult]:
        """Watch nodes in another way."""
        self._own(params.SubscriptionId)
        return self.subscription_service.modify_monitored_items(params)

    async def set_monitoring_mode(
        self, params: ua.SetMonitoringModeParameters
    ) -> list[ua.StatusCode]:
        """Watch nodes or not."""
        self._own(params.SubscriptionId)
        return await super().set_monitoring_mode(params)

    async def set_publishing_mode(
        self, params: ua.SetPublishingModeParameters
    ) -> list[ua.StatusCode]:
        """Let subscriptions of this session tell what they know or not."""
        for number in params.SubscriptionIds:
            self._own(number)
        return await super().set_publishing_mode(params)

    def modify_subscription(
        self, params: ua.ModifySubscriptionParameters
    ) -> ua.ModifySubscriptionResult:
        """Say how a subscription of this session goes on: as it was made."""
        self._own(params.SubscriptionId)
        return super().modify_subscription(params)

    def republish(self, params: ua.RepublishParameters) -> ua.NotificationMessage:
        """Send a message of a subscription of this session once more."""
        self._own(params.SubscriptionId)
        return super().republish(params)

    async def delete_subscriptions(self, ids: list[int]) -> list[ua.StatusCode]:
        """End subscriptions of this session."""
        found = self.subscription_service.subscriptions
        own = [n for n in ids if n in found and found[n].session_id == self.session_id]
        ended = dict(zip(own, await super().delete_subscriptions(own), strict=True))
        invalid = ua.StatusCode(_CODES.BadSubscriptionIdInvalid)
        return [ended.get(number, invalid) for number in ids]

    async def delete_monitored_items(
        self, params: ua.DeleteMonitoredItemsParameters
    ) -> list[ua.StatusCode]:
        """Watch nodes no more."""
        self._own(params.SubscriptionId)
        return self.subscription_service.delete_monitored_items(params)

    async def transfer_subscriptions(
        self, params: ua.TransferSubscriptionsParameters, callback: Callable[..., Any]
    ) -> list[ua.TransferResult]:
        """Go on with subscriptions that another session of the same user has left."""
        allowed = ua.TransferSubscriptionsParameters(
            [n for n in params.SubscriptionIds if self._may_take(n)], params.SendInitialValues
        )
        taken = await super().transfer_subscriptions(allowed, callback)
        for number in allowed.SubscriptionIds:
            # asyncua goes on taking the requests of the connection that is gone
            # (findings/asyncua_transfers_half_a_subscription.sh).
            found = self.subscription_service.subscriptions[number]
            found.pub_request_callback = callback.__self__.get_publish_request  # type: ignore[attr-defined]
        results = dict(zip(allowed.SubscriptionIds, taken, strict=True))
        invalid = ua.TransferResult(ua.StatusCode(_CODES.BadSubscriptionIdInvalid))
        return [results.get(number, invalid) for number in params.SubscriptionIds]

    def _may_take(self, number: int) -> bool:
        found = self.subscription_service.subscriptions.get(number)
        if found is None:
            return False
        sessions = self.iserver._external_sessions.values()
        before = next((each for each in sessions if each.session_id == found.session_id), None)
        if not isinstance(before, RigSession) or before.user is None or self.user is None:
            return False
        same = before.certificate == self.certificate
        return same and before.user.role is self.user.role


def _bound(wanted: Iterable[object]) -> None:
    if len(tuple(wanted)) > NODES:
        raise ServiceError(_CODES.BadTooManyOperations)


def _scalar(tag: Tag, given: ua.DataValue | None) -> float | None:
    """Return the number of a value of a tag's own type; None for any other."""
    content = None if given is None else given.Value
    if content is None or content.VariantType is not data_type(tag) or content.is_array:
        return None
    if not isinstance(content.Value, int | float):
        return None
    return float(content.Value)
