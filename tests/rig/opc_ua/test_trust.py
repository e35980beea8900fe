"""Which certificates are taken, and what becomes of those that are not."""

from datetime import UTC, datetime

import pytest
from tools import missing, need

from clepsydra.rig.doors.opc_ua import trust as trust_module
from clepsydra.rig.doors.opc_ua.trust import TrustList

if not missing("asyncua", "cryptography"):
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes
    from cryptography.hazmat.primitives.asymmetric import rsa
    from cryptography.hazmat.primitives.serialization import Encoding


@pytest.fixture(autouse=True)
def _packages():
    need("asyncua", "cryptography")


@pytest.fixture
def told():
    return []


@pytest.fixture
def trust(tmp_path, told):
    found = TrustList(tmp_path, told.append)
    found.make()
    return found


def certificate(name="client", bits=2048, years=(2001, 2999)):
    key = rsa.generate_private_key(public_exponent=65537, key_size=bits)
    subject = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, name)])
    since, until = (datetime(year, 1, 1, tzinfo=UTC) for year in years)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject)
        .public_key(key.public_key())
        .serial_number(7)
        .not_valid_before(since)
        .not_valid_after(until)
        .sign(key, hashes.SHA256())
    )


def der(found):
    return found.public_bytes(Encoding.DER)


@pytest.mark.parametrize("encoding", ["DER", "PEM"])
def test_a_certificate_in_the_folder_is_taken(trust, told, encoding):
    known = certificate()
    (trust.trusted / "known").write_bytes(known.public_bytes(getattr(Encoding, encoding)))
    assert trust.refusal(der(known)) == ""
    assert told == []


def test_another_certificate_of_the_same_name_and_number_is_not(trust, told):
    (trust.trusted / "known.der").write_bytes(der(certificate()))
    stranger = der(certificate())
    assert trust.refusal(stranger) == "BadCertificateUntrusted"
    (kept,) = trust.rejected.iterdir()
    assert kept.read_bytes() == stranger
    assert len(told) == 1


def test_who_tries_again_is_told_of_once(trust, told):
    stranger = der(certificate())
    assert [trust.refusal(stranger) for _ in range(3)] == 3 * ["BadCertificateUntrusted"]
    assert len(told) == 1
    assert len([*trust.rejected.iterdir()]) == 1


@pytest.mark.parametrize("years", [(2001, 2002), (2901, 2902)])
def test_a_trusted_certificate_out_of_its_time_is_refused(trust, told, years):
    known = certificate(years=years)
    (trust.trusted / "known.der").write_bytes(der(known))
    assert trust.refusal(der(known)) == "BadCertificateTimeInvalid"
    assert f"{years[0]}-01-01 to {years[1]}-01-01" in told[0]


def test_a_key_that_is_too_short_is_refused_though_it_is_trusted(trust):
    known = certificate(bits=1024)
    (trust.trusted / "known.der").write_bytes(der(known))
    assert trust.refusal(der(known)) == "BadCertificatePolicyCheckFailed"


@pytest.mark.parametrize("content", [b"", b"no certificate", b"\x30\x03\x02\x01\x00"])
def test_what_is_no_certificate_is_refused_and_not_kept(trust, content):
    assert trust.refusal(content) == "BadCertificateInvalid"
    assert [*trust.rejected.iterdir()] == []


def test_what_is_no_certificate_in_the_folder_is_told_and_left_out(trust, told):
    (trust.trusted / "a note.txt").write_text("certificates of this plant")
    known = certificate()
    (trust.trusted / "known.der").write_bytes(der(known))
    assert trust.refusal(der(known)) == ""
    assert "a note.txt is no certificate" in told[0]


def test_no_more_are_kept_than_there_is_room_for(trust, told, monkeypatch):
    monkeypatch.setattr(trust_module, "REJECTED", 2)
    for name in ("one", "two", "three"):
        trust.refusal(der(certificate(name)))
    assert len([*trust.rejected.iterdir()]) == 2
    assert "is full" in told[-1]


def test_a_name_of_a_certificate_is_no_path(trust, tmp_path):
    trust.refusal(der(certificate("../../up\n")))
    (kept,) = trust.rejected.iterdir()
    assert kept.parent == trust.rejected
    assert "/" not in kept.name and "\n" not in kept.name
