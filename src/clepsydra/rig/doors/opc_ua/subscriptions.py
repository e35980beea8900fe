"""The subscriptions of a server: bounded, and with the monitored items of a rig."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server.address_space import AddressSpace
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_subscription import InternalSubscription
from asyncua.server.subscription_service import SubscriptionService

from clepsydra.rig.doors.opc_ua.limits import (
    FASTEST_PUBLISHING,
    ITEMS,
    QUEUED_VALUES,
    SLOWEST_PUBLISHING,
    SUBSCRIPTIONS,
    UNACKNOWLEDGED,
)
from clepsydra.rig.doors.opc_ua.monitored_items import RigItems
from clepsydra.rig.doors.opc_ua.watched_tags import WatchedTags

_NOTIFICATION = ua.NodeId(ua.ObjectIds.DataChangeNotification_Encoding_DefaultBinary)


class RigSubscription(InternalSubscription):
    """A subscription whose tags are told as a rig tells them."""

    def __init__(self, *arguments: Any, watched: WatchedTags, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.items = RigItems(self, arguments[1], watched)
        self.monitored_item_srv = self.items

    def has_published_results(self) -> bool:
        """Whether there is something to say; asks once a publishing interval."""
        if self._publishing_enabled and self.items.has_news:
            return True
        return super().has_published_results()

    def _pop_triggered_datachanges(self, result: ua.PublishResult) -> None:
        super()._pop_triggered_datachanges(result)
        if self.items.has_news:
            news = ua.ExtensionObject(TypeId=_NOTIFICATION, Body=self.items.news())
            result.NotificationMessage.NotificationData.append(news)


class RigSubscriptions(SubscriptionService):
    """All subscriptions of a server.

    Parameters
    ----------
    space : AddressSpace
    server : InternalServer
    """

    def __init__(self, space: AddressSpace, server: InternalServer) -> None:
        super().__init__(space, server)
        self.watched: WatchedTags | None = None

    async def create_subscription(
        self,
        params: ua.CreateSubscriptionParameters,
        callback: Callable[..., Any],
        session_id: ua.NodeId,
        request_callback: Callable[..., Any] | None = None,
    ) -> ua.CreateSubscriptionResult:
        """Make a subscription; its publishing interval is one that a server can keep."""
        if len(self.subscriptions) >= SUBSCRIPTIONS:
            raise ServiceError(ua.StatusCodes.BadTooManySubscriptions)
        assert self.watched is not None
        wanted = float(params.RequestedPublishingInterval)
        interval = wanted if math.isfinite(wanted) else FASTEST_PUBLISHING
        result = ua.CreateSubscriptionResult()
        result.RevisedPublishingInterval = min(
            max(interval, FASTEST_PUBLISHING), SLOWEST_PUBLISHING
        )
        result.RevisedMaxKeepAliveCount = self._clamp_keep_alive_count(
            params.RequestedMaxKeepAliveCount
        )
        result.RevisedLifetimeCount = max(
            self._clamp_lifetime_count(params.RequestedLifetimeCount),
            3 * result.RevisedMaxKeepAliveCount,
        )
        self._sub_id_counter += 1
        number = result.SubscriptionId = self._sub_id_counter
        made = RigSubscription(
            result, self.aspace, callback, session_id, watched=self.watched,
            request_callback=request_callback,
            delete_callback=lambda: self.subscriptions.pop(number, None),
            no_acks_limit=UNACKNOWLEDGED, max_queue_size=QUEUED_VALUES,
            publishing_enabled=params.PublishingEnabled,
        )  # fmt: skip
        await made.start()
        self.subscriptions[number] = made
        return result

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        """Make monitored items, as long as there is room for them."""
        there = sum(len(each.items) for each in self.subscriptions.values())
        if there + len(params.ItemsToCreate or []) > ITEMS:
            raise ServiceError(ua.StatusCodes.BadTooManyMonitoredItems)
        return await super().create_monitored_items(params)

    def republish(self, params: ua.RepublishParameters) -> ua.NotificationMessage:
        """Send a message once more that was not acknowledged (OPC 10000-4 1.05, 5.14.6)."""
        found = self.subscriptions[params.SubscriptionId]
        if params.RetransmitSequenceNumber not in found._not_acknowledged_results:
            raise ServiceError(ua.StatusCodes.BadMessageNotAvailable)
        return found.republish(params.RetransmitSequenceNumber)
