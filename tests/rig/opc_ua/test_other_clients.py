"""Clients of other makers read, write and watch the tags of a rig."""

import pytest
from tools import missing
from waiting import wait_until

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from rig.opc_ua.clients import password_of
    from rig.opc_ua.driven_client import Failed, driven, gopcua, node_opcua


CLIENTS = {"node-opcua": lambda: node_opcua(), "gopcua": lambda: gopcua()}


@pytest.fixture(params=CLIENTS)
def maker(request):
    return request.param, CLIENTS[request.param]()


@pytest.fixture
def client(rig, maker):
    """A client that has come in."""
    name, command = maker
    with driven(command, rig, name) as found:
        opened(found, rig)
        yield found
        found("close")


def opened(client, rig, policy="Basic256Sha256", mode="SignAndEncrypt", **changes):
    given = {"user": "operator", "password": password_of(rig), "own": client.uri} | changes
    return client("open", policy=policy, mode=mode, **given)


def shown(rig, client, **values):
    """Let the plant show values, and wait until a client that watches its counter knows of them."""
    number = rig.sample
    rig.show(plant__watchdog=float(number), **values)
    wait_until(lambda: [number, "Good"] in client("told", tag="plant.watchdog"))


@pytest.mark.parametrize(
    "policy", ["Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"]
)
@pytest.mark.parametrize("mode", ["Sign", "SignAndEncrypt"])
def test_every_policy_lets_the_operator_write(rig, maker, policy, mode):
    name, command = maker
    with driven(command, rig, name) as client:
        opened(client, rig, policy, mode)
        assert client("write", tag="pump.out", type="Double", value=8.5) == "Good"
        assert client("read", tag="pump.out")["value"] == 8.5
        client("close")


def test_a_value_has_its_status_its_time_and_its_range(rig, client):
    rig.show(level__pv=101.0, level__good=1.0)
    wait_until(lambda: client("read", tag="level.pv")["value"] == 101.0)
    found = client("read", tag="level.pv")
    assert found == {
        "value": 101.0, "status": "UncertainEngineeringUnitsExceeded", "time": rig.time - 1.0
    }  # fmt: skip
    rig.show(level__good=0.0)
    wait_until(lambda: client("read", tag="level.pv")["status"] == "BadSensorFailure")
    assert client("read", tag="level.pv", property="EURange")["value"] == {
        "low": 0.0,
        "high": 100.0,
    }
    assert {"LEVEL_PV", "LEVEL_GOOD", "LEVEL_SP"} <= set(client("browse", tag="level"))


@pytest.mark.parametrize(
    ("tag", "type_", "value", "status"),
    [
        ("pump.status", "UInt16", 77, "Good"),
        ("operator.remote", "Boolean", True, "Good"),
        ("pump.out", "Double", 130.0, "BadOutOfRange"),
        ("pump.out", "Int32", 13, "BadTypeMismatch"),
        ("level.pv", "Double", 13.0, "BadNotWritable"),
        ("nothing", "Double", 13.0, "BadNodeIdUnknown"),
    ],
)
def test_what_is_written_is_taken_or_refused(client, tag, type_, value, status):
    assert client("write", tag=tag, type=type_, value=value) == status
    if status == "Good":
        assert client("read", tag=tag)["value"] == value


@pytest.mark.parametrize(("type_", "deadband"), [("Absolute", 5.0), ("Percent", 5.0)])
def test_slow_drift_is_told_at_last(rig, client, type_, deadband):
    assert client("watch", tag="plant.watchdog") == "Good"
    shown(rig, client, level__pv=0.0, level__good=1.0)
    assert client("watch", tag="level.pv", type=type_, deadband=deadband) == "Good"
    for level in range(20):
        shown(rig, client, level__pv=float(level))
    shown(rig, client, level__good=0.0)
    assert client("told", tag="level.pv") == [
        [0.0, "Good"], [6.0, "Good"], [12.0, "Good"], [18.0, "Good"], [None, "BadSensorFailure"]
    ]  # fmt: skip


def test_a_percent_deadband_of_no_range_is_refused(client):
    try:
        found = client("watch", tag="flow.pv", type="Percent", deadband=5.0)
    except Failed as failed:
        found = str(failed)
    assert "BadMonitoredItemFilterUnsupported" in found


def test_who_is_not_known_does_not_come_in(rig, maker):
    name, command = maker
    with driven(command, rig, f"unknown-{name}", trusted=False) as client, pytest.raises(Failed):
        opened(client, rig)
    with driven(command, rig, name) as client, pytest.raises(Failed, match=r"(?i)user"):
        opened(client, rig, password="wrong")
    assert any(name in path.name for path in (rig.certificates / "rejected").iterdir())
