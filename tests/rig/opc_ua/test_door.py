"""What a door refuses before it starts, and what its tags are without a plant."""

import asyncio
import socket
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from refusals import refused
from rig.opc_ua.held_rig import TAGS, HeldRig, held_rig
from tools import missing, need

from clepsydra.rig.doors.opc_ua.door import OpcUaDoor
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.users import password_in
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag_table import TagTable

if not missing("asyncua", "cryptography"):
    from asyncua import ua
    from rig.opc_ua.clients import connected, node

    from clepsydra.rig.doors.opc_ua.tag_values import TagValues


def made(folder, since, until):
    """Put a certificate with its key into a folder."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes
    from cryptography.hazmat.primitives.serialization import Encoding, load_pem_private_key

    identity = Identity(folder, "rig")
    identity.make()
    key = load_pem_private_key(identity.key.read_bytes(), None)
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "rig")])
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(1)
        .not_valid_before(since)
        .not_valid_after(until)
        .sign(key, hashes.SHA256())
    )
    identity.certificate.write_bytes(certificate.public_bytes(Encoding.DER))
    return identity


@pytest.mark.parametrize(
    ("since", "until", "words"),
    [(2001, 2002, "expired on 2002-01-01"), (2901, 2902, "is valid from 2901-01-01")],
)
def test_a_certificate_out_of_its_time_is_refused(tmp_path, since, until, words):
    need("cryptography", "asyncua")
    identity = made(tmp_path, *(datetime(year, 1, 1, tzinfo=UTC) for year in (since, until)))
    with refused(place=str(identity.certificate)) as told:
        OpcUaDoor(tmp_path, port=0).check()
    assert words in str(told.value)
    assert "a new one is made" in told.value.remedy


def test_a_certificate_of_another_key_is_refused(tmp_path):
    need("cryptography", "asyncua")
    other = Identity(tmp_path / "other", "rig")
    other.make()
    identity = Identity(tmp_path, "rig")
    identity.make()
    identity.certificate.write_bytes(other.certificate.read_bytes())
    with refused(place=str(identity.certificate), value="that of another key"):
        OpcUaDoor(tmp_path, port=0).check()


@pytest.mark.parametrize("name", ["certificate.der", "private_key.pem"])
@pytest.mark.parametrize("content", [b"", b"no certificate", None])
def test_what_cannot_be_read_is_refused(tmp_path, name, content):
    need("cryptography", "asyncua")
    Identity(tmp_path, "rig").make()
    path = tmp_path / name
    if content is None:
        path.unlink()
    else:
        path.write_bytes(content)
    with refused(place=str(path), value="what cannot be read"):
        OpcUaDoor(tmp_path, port=0).check()


def test_a_password_that_others_may_read_is_refused(tmp_path):
    need("asyncua", "cryptography")
    password_in(tmp_path)
    path = tmp_path / "operator.password"
    path.chmod(0o640)
    with refused(place=str(path)) as told:
        OpcUaDoor(tmp_path, port=0).check()
    assert told.value.remedy == f"chmod 600 {path}"


def test_a_port_in_use_is_refused(tmp_path):
    need("asyncua", "cryptography")
    with socket.create_server(("127.0.0.1", 0)) as there:
        port = there.getsockname()[1]
        with refused(place="OPC UA", value=f"port {port} of 127.0.0.1, which is in use"):
            OpcUaDoor(tmp_path, port=port).check()


def test_tags_that_opc_ua_cannot_tell_apart_are_refused(tmp_path):
    need("asyncua", "cryptography")
    level, *others = TAGS
    alike = (level, *(replace(tag, label=level.label) for tag in others if tag.name == "level.sp"))
    with refused(place="tags of level.pv and level.sp", value="LEVEL_PV"):
        OpcUaDoor(tmp_path, alike, port=0).check()
    long = "L" * 513
    with refused(place="tag of level.pv", value=long):
        OpcUaDoor(tmp_path, (replace(level, label=long),), port=0).check()


def test_before_its_first_sample_a_plant_has_no_values(tmp_path):
    need("asyncua", "cryptography")
    rig = HeldRig(tmp_path)
    values = TagValues(rig.table)
    values.look()
    assert {values.told(tag.name).status for tag in TAGS} == {
        ua.StatusCodes.BadWaitingForInitialData
    }
    rig.show(level__pv=5.0)
    assert {name for name, _ in values.look()} == {tag.name for tag in TAGS}
    assert (values.told("level.pv").value, values.told("level.pv").status) == (5.0, 0)


def test_a_plant_that_tells_nothing_more_has_no_values(tmp_path):
    need("asyncua", "cryptography")
    rig = HeldRig(tmp_path)
    rig.show(level__pv=5.0)
    values = TagValues(rig.table, silent_after=0.0)
    values.look()
    values.look()
    assert values.told("level.pv").status == ua.StatusCodes.BadNoCommunication
    rig.show(level__pv=5.0)
    values.look()
    assert values.told("level.pv").value == 5.0


def test_only_what_has_changed_is_told(tmp_path):
    need("asyncua", "cryptography")
    rig = HeldRig(tmp_path)
    rig.show(level__pv=5.0)
    values = TagValues(rig.table)
    values.look()
    rig.show(level__pv=6.0)
    assert [name for name, _ in values.look()] == ["level.pv"]
    rig.show(level__good=0.0)
    assert [name for name, _ in values.look()] == ["level.pv", "level.good"]
    rig.image.write("pump.out", 3.0)
    assert [(name, told.value) for name, told in values.look()] == [("pump.out", 3.0)]
    assert values.look() == []


def test_values_are_those_of_the_table_where_a_name_is_told_and_written(tmp_path):
    need("asyncua", "cryptography")
    tag = next(tag for tag in TAGS if tag.name == "pump.out")
    image = ProcessImage(tmp_path / "image", ImageLayout((tag.cell,), (tag.cell,), 1), new=True)
    table = TagTable([tag], image)
    image.write(tag.cell, 3.0)
    image.publish(0, 1.8e9, np.array([4.0]))
    values = TagValues(table)
    values.look()
    assert values.told(tag.name).value == table.read(tag).value == 4.0


@pytest.mark.thorough
def test_a_rig_goes_on_with_the_certificate_and_the_password_that_it_made(tmp_path):
    async def scenario(rig):
        async with connected(rig) as client:
            return await node(client, "level.pv").read_value()

    found = []
    for level in (1.0, 2.0):
        with held_rig(tmp_path) as rig:
            rig.show(level__pv=level)
            kept = [
                (rig.certificates / name).read_bytes()
                for name in ("certificate.der", "operator.password")
            ]
            found.append((asyncio.run(scenario(rig)), kept))
    assert [read for read, _ in found] == [1.0, 2.0]
    assert found[0][1] == found[1][1]


@pytest.mark.thorough
def test_a_port_that_was_taken_since_it_was_checked_is_told(tmp_path):
    need("asyncua", "cryptography")
    rig = HeldRig(tmp_path)
    with socket.create_server(("127.0.0.1", 0)) as there:
        port = there.getsockname()[1]
        door = OpcUaDoor(rig.certificates, TAGS, port=port)
        with refused(place="OPC UA", value=f"port {port} of 127.0.0.1, which is in use"):
            asyncio.run(door.serve(rig.table, Reporter(door.title, rig.reports.append)))
    assert rig.reports == []
