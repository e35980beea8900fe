"""What waits for who watches a tag, and how much of it."""

import asyncio

import pytest
from tools import missing, need

if not missing("asyncua", "cryptography"):
    from asyncua import ua
    from asyncua.common.utils import Buffer
    from asyncua.ua.ua_binary import struct_from_binary
    from rig.opc_ua.clients import connected, identity_of, node
    from rig.opc_ua.held_rig import KNOWN_LEVEL

    from clepsydra.rig.doors.opc_ua.deadband import ChangeFilter
    from clepsydra.rig.doors.opc_ua.told_value import OVERFLOW, ToldValue
    from clepsydra.rig.doors.opc_ua.watched_tags import WatchedTag


@pytest.fixture(autouse=True)
def _packages():
    need("asyncua", "cryptography")


def watching(queue_size, discard_oldest, mode="Reporting"):
    return WatchedTag(
        KNOWN_LEVEL, 1, 77, ua.MonitoringMode[mode], ChangeFilter(), queue_size, discard_oldest
    )


def told(level):
    return ToldValue(ua.VariantType.Double, float(level), 0, 1.8e9)


def taken(item):
    """Return the values that were taken, each with whether some before it were lost."""
    found = []
    for each in item.taken():
        assert each[:4] == (77).to_bytes(4, "little")
        read = struct_from_binary(ua.DataValue, Buffer(each[4:]))
        found.append((read.Value.Value, read.StatusCode.value == OVERFLOW))
    return found


@pytest.mark.parametrize(
    ("queue_size", "discard_oldest", "expected"),
    [
        # OPC 10000-4 1.05, 5.13.1.5: the mark is on the value next to those that were lost, and
        # a queue of one has none.
        (3, True, [(3.0, True), (4.0, False), (5.0, False)]),
        (3, False, [(1.0, False), (2.0, False), (5.0, True)]),
        (1, True, [(5.0, False)]),
        (1, False, [(5.0, False)]),
        (9, True, [(1.0, False), (2.0, False), (3.0, False), (4.0, False), (5.0, False)]),
    ],
)
def test_a_full_queue_loses_values_and_says_so(queue_size, discard_oldest, expected):
    item = watching(queue_size, discard_oldest)
    assert all(item.tell(told(level)) for level in (1, 2, 3, 4, 5))
    assert taken(item) == expected
    assert taken(item) == []


def test_who_only_samples_has_no_news_but_keeps_values():
    item = watching(5, True, "Sampling")
    assert not item.tell(told(1))
    assert item.waits
    assert taken(item) == [(1.0, False)]


def test_who_is_switched_off_keeps_nothing_and_begins_anew():
    item = watching(5, True)
    item.tell(told(1))
    item.mode = ua.MonitoringMode.Disabled
    item.forget()
    assert not item.tell(told(2))
    item.mode = ua.MonitoringMode.Reporting
    # The same value is told once more, for it is the first one.
    assert item.tell(told(1))
    assert taken(item) == [(1.0, False)]


class Heard(list):
    def datachange_notification(self, of, value, data):
        self.append(value)


@pytest.mark.thorough
def test_an_item_is_changed_switched_off_and_on_and_deleted(rig):
    async def heard_until(heard, value):
        while not heard or heard[-1] != value:
            await asyncio.sleep(0.01)

    async def scenario():
        rig.show(level__pv=10.0, level__good=1.0)
        heard = Heard()
        async with connected(rig) as client:
            subscription = await client.create_subscription(20, heard)
            item = await subscription.subscribe_data_change(node(client, "level.pv"))
            await heard_until(heard, 10.0)
            await subscription.modify_monitored_item(item, 0.0, mod_filter_val=5.0)
            for level in (14.0, 15.0, 15.5):
                rig.show(level__pv=level)
                await asyncio.sleep(0.1)
            await heard_until(heard, 15.5)
            await subscription.set_monitoring_mode(ua.MonitoringMode.Disabled)
            rig.show(level__pv=80.0)
            await asyncio.sleep(0.1)
            disabled = list(heard)
            await subscription.set_monitoring_mode(ua.MonitoringMode.Reporting)
            await heard_until(heard, 80.0)
            await subscription.unsubscribe(item)
            rig.show(level__pv=20.0)
            await asyncio.sleep(0.1)
        return disabled, list(heard)

    disabled, heard = asyncio.run(scenario())
    assert disabled == [10.0, 15.5]
    assert heard == [10.0, 15.5, 80.0]


@pytest.mark.thorough
def test_a_subscription_is_of_its_session_alone(rig):
    async def scenario():
        codes = []
        async with connected(rig) as owner, connected(rig) as other:
            subscription = await owner.create_subscription(100, Heard())
            number = subscription.subscription_id
            wanted = ua.CreateMonitoredItemsParameters(number, ua.TimestampsToReturn.Both, [])
            modified = ua.ModifyMonitoredItemsParameters(number, ua.TimestampsToReturn.Both, [])
            for request in (
                lambda: other.uaclient.create_monitored_items(wanted),
                lambda: other.uaclient.delete_monitored_items(
                    ua.DeleteMonitoredItemsParameters(number, [1])
                ),
                lambda: other.uaclient.modify_monitored_items(modified),
            ):
                with pytest.raises(ua.UaStatusCodeError) as refused:
                    await request()
                codes.append(refused.value.code)
            (deleted,) = await other.uaclient.delete_subscriptions([number])
            codes.append(deleted.value)
            # It is still there.
            await subscription.subscribe_data_change(node(owner, "level.pv"))
        return codes

    assert set(asyncio.run(scenario())) == {ua.StatusCodes.BadSubscriptionIdInvalid}


@pytest.mark.thorough
def test_a_subscription_goes_on_by_the_next_connection_of_its_client(rig):
    async def scenario(identity_of_second):
        rig.show(level__pv=10.0, level__good=1.0)
        heard, told = Heard(), []
        async with connected(rig) as second_client:
            first = connected(rig)
            owner = await first.__aenter__()
            subscription = await owner.create_subscription(20, heard)
            await subscription.subscribe_data_change(node(owner, "level.pv"))
            while not heard:
                await asyncio.sleep(0.01)
            wanted = ua.TransferSubscriptionsParameters([subscription.subscription_id], True)
            if identity_of_second:
                other = identity_of(rig, identity_of_second)
                async with connected(rig, identity=other) as stranger:
                    (refused,) = await stranger.uaclient.transfer_subscriptions(wanted)
                    told.append(refused.StatusCode.value)
            (taken,) = await second_client.uaclient.transfer_subscriptions(wanted)
            assert taken.StatusCode.is_good()
            for level in (20.0, 30.0):
                rig.show(level__pv=level)
                while level not in told:
                    answer = await second_client.uaclient.publish([])
                    told += [
                        item.Value.Value.Value
                        for data in answer.Parameters.NotificationMessage.NotificationData
                        for item in data.MonitoredItems
                    ]
            await first.__aexit__(None, None, None)
        return list(heard), told

    assert asyncio.run(scenario("")) == ([10.0], [20.0, 30.0])
    invalid = ua.StatusCodes.BadSubscriptionIdInvalid
    assert asyncio.run(scenario("another-client")) == ([10.0], [invalid, 20.0, 30.0])
