"""How much one door of OPC UA holds, and what it reads of a stranger's bytes."""

import asyncio

import pytest
from tools import missing, need

if not missing("asyncua", "cryptography"):
    from asyncua import Client, ua
    from asyncua.common.utils import Buffer
    from asyncua.ua import ua_binary
    from asyncua.ua.uaerrors import UaError
    from rig.opc_ua.clients import POLICIES, connected, identity_of, node

    from clepsydra.rig.doors.opc_ua import subscriptions
    from clepsydra.rig.doors.opc_ua.decoding import guard


class Heard:
    def datachange_notification(self, of, value, data):
        pass


def code_of(scenario):
    with pytest.raises(ua.UaStatusCodeError) as refused:
        asyncio.run(scenario())
    return refused.value.code


@pytest.mark.thorough
def test_there_are_no_more_subscriptions_than_there_is_room_for(rig, monkeypatch):
    monkeypatch.setattr(subscriptions, "SUBSCRIPTIONS", 3)

    async def scenario():
        async with connected(rig) as client:
            for _ in range(4):
                await client.create_subscription(1000, Heard())

    assert code_of(scenario) == ua.StatusCodes.BadTooManySubscriptions


@pytest.mark.thorough
def test_there_are_no_more_items_than_there_is_room_for(rig, monkeypatch):
    monkeypatch.setattr(subscriptions, "ITEMS", 5)

    async def scenario():
        async with connected(rig) as client:
            for _ in range(2):
                subscription = await client.create_subscription(1000, Heard())
                await subscription.subscribe_data_change(3 * [node(client, "level.pv")])

    assert code_of(scenario) == ua.StatusCodes.BadTooManyMonitoredItems


@pytest.mark.thorough
@pytest.mark.parametrize("asked", [-5.0, 0.0, 1e-9, float("nan"), float("inf")])
def test_a_publishing_interval_is_one_that_can_be_kept(rig, asked):
    async def revised():
        async with connected(rig) as client:
            params = ua.CreateSubscriptionParameters(asked, 100, 10, 0, True, 0)
            found = await client.uaclient.create_subscription(params, lambda *told: None)
            return found.RevisedPublishingInterval

    assert 20.0 <= asyncio.run(revised()) <= 3_600_000.0


@pytest.mark.thorough
def test_too_many_nodes_in_one_request_are_refused(rig):
    async def scenario():
        async with connected(rig) as client:
            await client.read_values(5001 * [node(client, "level.pv")])

    assert code_of(scenario) == ua.StatusCodes.BadTooManyOperations


@pytest.mark.thorough
def test_the_certificate_of_a_session_is_that_of_its_channel(rig):
    """A certificate is no secret: who names that of another has no session for it."""

    async def scenario():
        mine, other = identity_of(rig), identity_of(rig, "somebody")
        client = Client(rig.address)
        client.application_uri = mine.uri
        await client.set_security(
            POLICIES["Basic256Sha256"], mine.certificate, mine.key,
            server_certificate=rig.certificates / "certificate.der",
        )  # fmt: skip
        await client.connect_socket()
        try:
            await client.send_hello()
            await client.open_secure_channel()
            client.security_policy.host_certificate = other.certificate.read_bytes()
            await client.create_session()
        finally:
            client.disconnect_socket()

    assert code_of(scenario) == ua.StatusCodes.BadCertificateInvalid


def test_an_array_is_not_longer_than_its_message():
    need("asyncua", "cryptography")
    guard()
    guard()
    kind = ua.VariantType.Null
    nothing = Buffer((100).to_bytes(4, "little"))
    with pytest.raises(UaError, match="longer than its message"):
        ua_binary.unpack_uatype_array(kind, nothing)
    numbers = ua.Variant([1, 2, 3], ua.VariantType.Byte)
    read = ua_binary.variant_from_binary(Buffer(ua_binary.variant_to_binary(numbers)))
    assert read.Value == [1, 2, 3]
