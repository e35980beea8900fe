"""A client watches the tags of a rig."""

import asyncio

import pytest
from tools import missing

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from asyncua import ua
    from rig.opc_ua.clients import connected, node


class Heard:
    """What a subscription was told."""

    def __init__(self):
        self.values = []

    def datachange_notification(self, of, value, data):
        told = data.monitored_item.Value
        self.values.append(
            (of.nodeid.Identifier, value, told.StatusCode.value, told.SourceTimestamp)
        )

    async def until(self, holds):
        while not holds(self.values):
            await asyncio.sleep(0.01)


def filter_of(kind, deadband):
    return ua.DataChangeFilter(ua.DataChangeTrigger.StatusValue, kind, deadband)


async def asked(subscription, of, filter_, queue_size=100):
    """Watch a node, and return the identifier of the item or raise why not."""
    wanted = ua.MonitoredItemCreateRequest(
        ua.ReadValueId(of.nodeid, ua.AttributeIds.Value),
        ua.MonitoringMode.Reporting,
        ua.MonitoringParameters(1, 0.0, filter_, queue_size, True),
    )
    (found,) = await subscription.create_monitored_items([wanted])
    if isinstance(found, ua.StatusCode):
        found.check()
    return found


async def shown(rig, heard, **values):
    """Let the plant show values, and wait until who watches its counter has heard of them."""
    number = float(rig.sample)
    rig.show(plant__watchdog=number, **values)
    await heard.until(lambda told: any(each[:2] == ("plant.watchdog", number) for each in told))


def test_every_sample_is_told_with_its_time(rig):
    async def scenario():
        heard = Heard()
        async with connected(rig) as client:
            subscription = await client.create_subscription(20, heard)
            nodes = [node(client, name) for name in ("plant.watchdog", "level.pv")]
            await subscription.subscribe_data_change(nodes, queuesize=100)
            await heard.until(lambda told: len(told) == 2)
            for level in (10.0, 20.0, 20.0, 30.0):
                await shown(rig, heard, level__pv=level)
        return [each for each in heard.values if each[0] == "level.pv"]

    told = asyncio.run(scenario())
    assert [value for _, value, _, _ in told[-3:]] == [10.0, 20.0, 30.0]
    times = [time.timestamp() for *_, time in told[-3:]]
    assert [later - times[0] for later in times] == [0.0, 1.0, 3.0]


@pytest.mark.parametrize(("kind", "deadband"), [(1, 5.0), (2, 5.0)])
def test_slow_drift_is_told_at_last(rig, kind, deadband):
    async def scenario():
        heard = Heard()
        async with connected(rig) as client:
            subscription = await client.create_subscription(20, heard)
            await subscription.subscribe_data_change(node(client, "plant.watchdog"), queuesize=100)
            await heard.until(lambda told: len(told) == 1)
            await shown(rig, heard, level__pv=0.0)
            await subscription._subscribe(
                node(client, "level.pv"), mfilter=filter_of(kind, deadband), queuesize=100
            )
            for level in range(51):
                await shown(rig, heard, level__pv=float(level))
            await shown(rig, heard, level__good=0.0)
            await shown(rig, heard, level__good=1.0)
        return [each[1:3] for each in heard.values if each[0] == "level.pv"]

    codes = ua.StatusCodes
    assert asyncio.run(scenario()) == [
        *((float(level), codes.Good) for level in range(0, 51, 6)),
        (None, codes.BadSensorFailure),
        (50.0, codes.Good),
    ]


@pytest.mark.parametrize(
    ("name", "kind", "deadband", "code"),
    [
        ("flow.pv", 2, 5.0, "BadMonitoredItemFilterUnsupported"),
        ("level.pv", 2, 101.0, "BadDeadbandFilterInvalid"),
        ("level.good", 1, 0.5, "BadMonitoredItemFilterUnsupported"),
    ],
)
def test_a_deadband_of_no_range_is_refused(rig, name, kind, deadband, code):
    async def scenario():
        async with connected(rig) as client:
            subscription = await client.create_subscription(100, Heard())
            with pytest.raises(ua.UaStatusCodeError) as refused:
                await asked(subscription, node(client, name), filter_of(kind, deadband))
            return refused.value.code

    assert asyncio.run(scenario()) == getattr(ua.StatusCodes, code)
