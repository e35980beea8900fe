"""The monitored items of one subscription: tags are told as they are here, all else by asyncua."""

from __future__ import annotations

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server.address_space import AddressSpace
from asyncua.server.internal_subscription import InternalSubscription
from asyncua.server.monitored_item_service import MonitoredItemService

# What is read from a message is of this class, `ua.DataChangeFilter` is below it
# (findings/asyncua_reads_filters_as_another_class.sh).
from asyncua.ua.uaprotocol_auto import DataChangeFilter

from clepsydra.rig.doors.opc_ua.deadband import ChangeFilter, RefusedFilter, change_filter
from clepsydra.rig.doors.opc_ua.limits import NODES, QUEUED_VALUES
from clepsydra.rig.doors.opc_ua.watched_tags import WatchedTag, WatchedTags
from clepsydra.rig.tag import Tag

_CODES = ua.StatusCodes


class RigItems(MonitoredItemService):
    """The monitored items of a subscription.

    asyncua compares a deadband with the value that it saw last, accepts one in percent of no range,
    and writes each value anew for each client: tags have what is here in its place.

    Parameters
    ----------
    subscription : InternalSubscription
    space : AddressSpace
    watched : WatchedTags
    """

    def __init__(
        self, subscription: InternalSubscription, space: AddressSpace, watched: WatchedTags
    ) -> None:
        super().__init__(subscription, space)
        self._watched = watched
        self._tags: dict[int, WatchedTag] = {}
        self._with_news: dict[WatchedTag, None] = {}

    def __len__(self) -> int:
        return len(self._monitored_items) + len(self._tags)

    @property
    def has_news(self) -> bool:
        """Whether values of tags wait to be told."""
        return bool(self._with_news)

    def news(self) -> bytes:
        """Return the values that wait as one notification (OPC 10000-4 1.05, 7.25.2)."""
        values = [value for item in self._with_news for value in item.taken()]
        self._with_news.clear()
        return b"".join([len(values).to_bytes(4, "little"), *values, b"\xff\xff\xff\xff"])

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        """Make monitored items, of tags and of others."""
        wanted = params.ItemsToCreate or []
        if len(wanted) > NODES:
            raise ServiceError(_CODES.BadTooManyOperations)
        results = []
        for item in wanted:
            of = item.ItemToMonitor
            tag = self._watched.tag_of(of.NodeId)
            if tag is not None and of.AttributeId == ua.AttributeIds.Value:
                results.append(self._create(tag, item))
            else:
                results.append(await self._create_other(params, item))
        return results

    async def _create_other(
        self, params: ua.CreateMonitoredItemsParameters, item: ua.MonitoredItemCreateRequest
    ) -> ua.MonitoredItemCreateResult:
        asked = item.RequestedParameters.Filter
        if isinstance(asked, DataChangeFilter) and asked.DeadbandType != 0:
            return _refused_item(_CODES.BadFilterNotAllowed)
        one = ua.CreateMonitoredItemsParameters(
            params.SubscriptionId, params.TimestampsToReturn, [item]
        )
        return (await super().create_monitored_items(one))[0]

    def _create(
        self, tag: Tag, asked: ua.MonitoredItemCreateRequest
    ) -> ua.MonitoredItemCreateResult:
        wanted = asked.RequestedParameters
        try:
            passing = _filter(tag, wanted.Filter)
        except RefusedFilter as refused:
            return _refused_item(getattr(_CODES, refused.code))
        self._monitored_item_counter += 1
        item = WatchedTag(
            tag, self._monitored_item_counter, int(wanted.ClientHandle), asked.MonitoringMode,
            passing, _queue_size(wanted.QueueSize), bool(wanted.DiscardOldest),
        )  # fmt: skip
        self._tags[item.number] = item
        self._watched.watch(item, self._note)
        result = ua.MonitoredItemCreateResult()
        result.MonitoredItemId = item.number
        # The plant is looked at with each of its samples, whatever was asked for.
        result.RevisedSamplingInterval = 0.0
        result.RevisedQueueSize = item.queue_size
        return result

    def _note(self, item: WatchedTag) -> None:
        self._with_news[item] = None

    def modify_monitored_items(
        self, params: ua.ModifyMonitoredItemsParameters
    ) -> list[ua.MonitoredItemModifyResult]:
        """Change monitored items of tags; others stay as they are."""
        return [self._modify(each) for each in params.ItemsToModify or []]

    def _modify(self, asked: ua.MonitoredItemModifyRequest) -> ua.MonitoredItemModifyResult:
        result = ua.MonitoredItemModifyResult()
        item = self._tags.get(asked.MonitoredItemId)
        wanted = asked.RequestedParameters
        if item is None:
            known = asked.MonitoredItemId in self._monitored_items
            code = _CODES.BadNotSupported if known else _CODES.BadMonitoredItemIdInvalid
            result.StatusCode = ua.StatusCode(code)
            return result
        try:
            item.passing = _filter(item.tag, wanted.Filter)
        except RefusedFilter as refused:
            result.StatusCode = ua.StatusCode(getattr(_CODES, refused.code))
            return result
        item.client_handle = int(wanted.ClientHandle)
        item.discard_oldest = bool(wanted.DiscardOldest)
        item.resize(_queue_size(wanted.QueueSize))
        result.RevisedSamplingInterval = 0.0
        result.RevisedQueueSize = item.queue_size
        return result

    async def _set_monitoring_mode(self, mode: ua.MonitoringMode, mid: int) -> ua.StatusCode:
        item = self._tags.get(mid)
        if item is None:
            return await super()._set_monitoring_mode(mode, mid)
        before, item.mode = item.mode, mode
        if mode == ua.MonitoringMode.Disabled:
            item.forget()
        if mode != ua.MonitoringMode.Reporting:
            self._with_news.pop(item, None)
        elif item.waits:
            self._note(item)
        if before == ua.MonitoringMode.Disabled:
            self._watched.tell(item, self._note)
        return ua.StatusCode()

    def _delete_monitored_items(self, mid: int) -> ua.StatusCode:
        item = self._tags.pop(mid, None)
        if item is None:
            return super()._delete_monitored_items(mid)
        self._watched.leave(item)
        self._with_news.pop(item, None)
        return ua.StatusCode()

    def delete_all_monitored_items(self) -> None:
        """Delete all, as when the subscription ends."""
        self.delete_monitored_items([*self._tags, *self._monitored_items])


def _filter(tag: Tag, asked: object) -> ChangeFilter:
    if asked is None or (isinstance(asked, ua.ExtensionObject) and asked.Body is None):
        return ChangeFilter()
    if not isinstance(asked, DataChangeFilter):
        raise RefusedFilter("BadFilterNotAllowed")
    return change_filter(
        tag, int(asked.Trigger), int(asked.DeadbandType), float(asked.DeadbandValue)
    )


def _queue_size(asked: int) -> int:
    return min(max(int(asked), 1), QUEUED_VALUES)


def _refused_item(code: int) -> ua.MonitoredItemCreateResult:
    result = ua.MonitoredItemCreateResult()
    result.StatusCode = ua.StatusCode(code)
    return result
