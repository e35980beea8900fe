"""Channels get new keys, and sessions go on by new channels."""

import asyncio

import pytest
from tools import missing

from clepsydra.rig.tag import WIRE_CUT

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from asyncua import Client, ua
    from rig.opc_ua.clients import POLICIES, connected, identity_of, node, password_of


@pytest.mark.parametrize("policy", POLICIES)
def test_a_channel_gets_new_keys_again_and_again(rig, policy):
    async def scenario():
        async with connected(rig, policy=policy) as client:
            for value in (1.0, 2.0, 3.0):
                await client.open_secure_channel(renew=True)
                await node(client, "pump.out").write_value(value)
                assert await node(client, "pump.out").read_value() == value
            return client.uaclient.protocol._connection.security_token.TokenId

    # 13 is that of the first keys, and each renewal counts on.
    assert asyncio.run(scenario()) == 16


class Heard(list):
    def datachange_notification(self, of, value, data):
        self.append(value)


def test_a_client_comes_back_after_the_cable_was_pulled(rig):
    async def scenario():
        identity, heard = identity_of(rig), Heard()
        client = Client(rig.address, timeout=10, watchdog_intervall=60)
        client.application_uri = identity.uri
        await client.set_security(
            POLICIES["Basic256Sha256"], identity.certificate, identity.key,
            server_certificate=rig.certificates / "certificate.der",
        )  # fmt: skip
        client.set_user("operator")
        client.set_password(password_of(rig))
        await client.connect(auto_reconnect=True, reconnect_max_delay=0.2)
        client.rig = await client.get_namespace_index("urn:clepsydra:rig")
        rig.show(level__pv=1.0)
        subscription = await client.create_subscription(50, heard)
        await subscription.subscribe_data_change(node(client, "level.pv"))
        while 1.0 not in heard:
            await asyncio.sleep(0.01)
        rig.image.write(WIRE_CUT, 1.0)
        await asyncio.sleep(0.3)
        rig.image.write(WIRE_CUT, 0.0)
        rig.show(level__pv=2.0)
        while 2.0 not in heard:
            await asyncio.sleep(0.01)
        value = await node(client, "level.pv").read_value()
        await client.disconnect()
        return value

    assert asyncio.run(scenario()) == 2.0


def test_a_session_is_no_other_clients(rig):
    """Who knows the token of a session, but has another certificate, does not get it."""

    async def scenario():
        stranger = identity_of(rig, "somebody")
        async with connected(rig) as owner:
            token = owner.uaclient.protocol.authentication_token
            client = Client(rig.address)
            client.application_uri = stranger.uri
            await client.set_security(
                POLICIES["Basic256Sha256"], stranger.certificate, stranger.key,
                server_certificate=rig.certificates / "certificate.der",
            )  # fmt: skip
            await client.connect_socket()
            try:
                await client.send_hello()
                await client.open_secure_channel()
                client.uaclient.protocol.authentication_token = token
                params = ua.ActivateSessionParameters()
                params.UserIdentityToken = ua.AnonymousIdentityToken("anonymous")
                with pytest.raises(ua.UaStatusCodeError) as refused:
                    await client.uaclient.activate_session(params)
            finally:
                client.disconnect_socket()
            return refused.value.code, await node(owner, "level.pv").read_value()

    code, value = asyncio.run(scenario())
    assert code == ua.StatusCodes.BadSecurityChecksFailed
    assert value is not None
