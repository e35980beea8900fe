"""Who comes in, who does not, and who may write."""

import asyncio

import pytest
from tools import missing

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from asyncua import Client, ua
    from asyncua.crypto import security_policies
    from rig.opc_ua.clients import POLICIES, connected, identity_of, node
    from rig.opc_ua.held_rig import held_rig


@pytest.fixture(scope="module")
def open_rig(tmp_path_factory):
    """A rig that anybody may read."""
    with held_rig(tmp_path_factory.mktemp("open"), anonymous=True) as found:
        found.show(level__pv=12.0)
        yield found


def written(rig, **options):
    async def scenario():
        async with connected(rig, **options) as client:
            await node(client, "pump.out").write_value(7.0)
            return await node(client, "pump.out").read_value()

    return asyncio.run(scenario())


@pytest.mark.parametrize("policy", ["Basic256Sha256", "Aes128Sha256RsaOaep", "Aes256Sha256RsaPss"])
@pytest.mark.parametrize("mode", ["Sign", "SignAndEncrypt"])
def test_the_operator_writes_by_every_policy_that_is_offered(rig, policy, mode):
    assert written(rig, policy=policy, mode=ua.MessageSecurityMode[mode]) == 7.0


def test_what_is_offered_has_no_policy_that_is_deprecated(rig, open_rig):
    async def offered(of):
        found = await Client(of.address).connect_and_get_server_endpoints()
        return {
            (each.SecurityPolicyUri.rpartition("#")[2], each.SecurityMode.name): {
                token.TokenType.name for token in each.UserIdentityTokens
            }
            for each in found
        }

    secured = {
        (policy, mode): {"UserName", "Certificate"}
        for policy in ("Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss")
        for mode in ("Sign", "SignAndEncrypt")
    }
    assert asyncio.run(offered(rig)) == secured
    with_anybody = {of: {*tokens, "Anonymous"} for of, tokens in secured.items()}
    assert asyncio.run(offered(open_rig)) == {**with_anybody, ("None", "None_"): {"Anonymous"}}


@pytest.mark.parametrize("policy", ["Basic128Rsa15", "Basic256"])
def test_a_policy_that_is_deprecated_is_refused(rig, policy):
    POLICIES[policy] = getattr(security_policies, f"SecurityPolicy{policy}")
    with pytest.raises(Exception, match=r"(?i)security|policy|refused|connection"):
        written(rig, policy=policy)


def test_without_security_nobody_has_a_session(rig):
    async def scenario():
        async with Client(rig.address):
            pass

    with pytest.raises(ua.UaStatusCodeError) as refused:
        asyncio.run(scenario())
    assert refused.value.code == ua.StatusCodes.BadSecurityModeInsufficient


def test_anybody_reads_where_that_was_asked_for_and_writes_nothing(open_rig):
    async def scenario():
        async with Client(open_rig.address) as client:
            client.rig = await client.get_namespace_index("urn:clepsydra:rig")
            read = await node(client, "level.pv").read_value()
            with pytest.raises(ua.UaStatusCodeError) as refused:
                await node(client, "pump.out").write_value(1.0)
            return read, refused.value.code

    assert asyncio.run(scenario()) == (12.0, ua.StatusCodes.BadUserAccessDenied)


def test_a_name_is_not_taken_without_security(open_rig):
    async def scenario():
        client = Client(open_rig.address)
        client.set_user("operator")
        client.set_password((open_rig.certificates / "operator.password").read_text())
        async with client:
            pass

    with pytest.raises(ua.UaStatusCodeError) as refused:
        asyncio.run(scenario())
    assert refused.value.code == ua.StatusCodes.BadIdentityTokenRejected


def test_a_trusted_certificate_alone_is_no_user(rig, open_rig):
    with pytest.raises(ua.UaStatusCodeError) as refused:
        written(rig, user="")
    assert refused.value.code == ua.StatusCodes.BadIdentityTokenRejected
    with pytest.raises(ua.UaStatusCodeError) as refused:
        written(open_rig, user="")
    assert refused.value.code == ua.StatusCodes.BadUserAccessDenied


@pytest.mark.parametrize(("user", "password"), [("operator", "wrong"), ("admin", None)])
def test_a_wrong_name_or_password_is_refused(rig, user, password):
    with pytest.raises(ua.UaStatusCodeError) as refused:
        written(rig, user=user, password=password)
    assert refused.value.code == ua.StatusCodes.BadUserAccessDenied


def test_a_user_with_a_trusted_certificate_writes(rig):
    async def scenario(identity):
        channel = identity_of(rig)
        client = Client(rig.address)
        client.application_uri = channel.uri
        await client.set_security(
            POLICIES["Basic256Sha256"], channel.certificate, channel.key,
            server_certificate=rig.certificates / "certificate.der",
        )  # fmt: skip
        await client.load_client_certificate(str(identity.certificate))
        await client.load_private_key(str(identity.key))
        async with client:
            client.rig = await client.get_namespace_index("urn:clepsydra:rig")
            await node(client, "pump.out").write_value(9.0)
            return await node(client, "pump.out").read_value()

    assert asyncio.run(scenario(identity_of(rig, "somebody"))) == 9.0
    with pytest.raises(ua.UaStatusCodeError) as refused:
        asyncio.run(scenario(identity_of(rig, "nobody", trusted=False)))
    assert refused.value.code == ua.StatusCodes.BadUserAccessDenied


def test_an_unknown_certificate_is_kept_and_the_report_says_what_to_do(rig):
    stranger = identity_of(rig, "stranger", trusted=False)
    with pytest.raises(Exception):  # noqa: B017, what the client says depends on its version
        written(rig, identity=stranger)
    (kept,) = [p for p in (rig.certificates / "rejected").iterdir() if "stranger" in p.name]
    assert kept.read_bytes() == stranger.certificate.read_bytes()
    (words,) = [words for words in rig.words() if "stranger" in words]
    assert f"move {kept} to {rig.certificates / 'trusted'}" in words
    kept.rename(rig.certificates / "trusted" / kept.name)
    assert written(rig, identity=stranger) == 7.0


def test_no_report_and_no_file_that_others_read_has_the_password(rig):
    path = rig.certificates / "operator.password"
    assert path.stat().st_mode & 0o777 == 0o600
    assert (rig.certificates / "private_key.pem").stat().st_mode & 0o777 == 0o600
    assert not any(path.read_text() in report.words for report in rig.reports)


def test_a_password_that_was_encrypted_for_another_time_is_refused(rig):
    async def scenario(other_nonce):
        identity = identity_of(rig)
        client = Client(rig.address)
        client.application_uri = identity.uri
        await client.set_security(
            POLICIES["Basic256Sha256"], identity.certificate, identity.key,
            server_certificate=rig.certificates / "certificate.der",
            mode=ua.MessageSecurityMode.Sign,
        )  # fmt: skip
        client.set_user("operator")
        client.set_password((rig.certificates / "operator.password").read_text())
        encrypt = client._encrypt_password

        def encrypted(password, policy):
            nonce, client._server_nonce = client._server_nonce, other_nonce or client._server_nonce
            try:
                return encrypt(password, policy)
            finally:
                client._server_nonce = nonce

        client._encrypt_password = encrypted
        async with client:
            pass

    asyncio.run(scenario(b""))
    with pytest.raises(ua.UaStatusCodeError) as refused:
        asyncio.run(scenario(bytes(32)))
    assert refused.value.code == ua.StatusCodes.BadIdentityTokenInvalid
