"""Clients of a door of OPC UA, made of asyncua."""

from contextlib import asynccontextmanager

from asyncua import Client, ua
from asyncua.crypto import security_policies

from clepsydra.rig.doors.opc_ua.address_space import NAMESPACE
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.trust import TrustList

POLICIES = {
    "Basic256Sha256": security_policies.SecurityPolicyBasic256Sha256,
    "Aes128Sha256RsaOaep": security_policies.SecurityPolicyAes128Sha256RsaOaep,
    "Aes256Sha256RsaPss": security_policies.SecurityPolicyAes256Sha256RsaPss,
}
BOTH = ua.MessageSecurityMode.SignAndEncrypt


def identity_of(rig, name="client", trusted=True):
    """Return the certificate of a client, and let the rig trust it or not."""
    identity = Identity(rig.folder / name, name)
    identity.make()
    if trusted:
        TrustList(rig.certificates).add(identity.certificate)
    return identity


def password_of(rig):
    return (rig.certificates / "operator.password").read_text()


@asynccontextmanager
async def connected(
    rig, policy="Basic256Sha256", mode=BOTH, identity=None, user="operator", password=None
):
    """Connect a client to a rig."""
    identity = identity or identity_of(rig)
    # By itself it leaves a server that does not answer within a second, as on a busy machine.
    client = Client(rig.address, timeout=60, watchdog_intervall=60)
    client.application_uri = identity.uri
    await client.set_security(
        POLICIES[policy],
        identity.certificate,
        identity.key,
        server_certificate=rig.certificates / "certificate.der",
        mode=mode,
    )
    if user:
        client.set_user(user)
        client.set_password(password_of(rig) if password is None else password)
    async with client:
        client.rig = await client.get_namespace_index(NAMESPACE)
        yield client


def node(client, name):
    return client.get_node(ua.NodeId(name, client.rig))
