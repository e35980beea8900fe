"""Who gets the page of a rig: names, origins, tokens, and what browsers are told to keep to."""

import re

import pytest
from refusals import refused
from websockets.exceptions import InvalidStatus

from clepsydra.rig.doors.page.door import PageDoor, token_for
from clepsydra.rig.doors.page.gate import Asked, Gate

TOKEN = "correct-horse"


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8010", "localhost:8010", "LOCALHOST:8010", "[::1]:8010", "127.0.0.2:8010"]
)
def test_names_of_the_loopback_are_let_in(host):
    assert Gate(8010).doubt(Asked("/", (host,))) == ""


@pytest.mark.parametrize(
    "hosts",
    [
        (),
        ("127.0.0.1:8010", "evil.example"),
        ("evil.example:8010",),
        ("127.0.0.1.evil.example:8010",),
        ("127.0.0.1:8011",),
        ("127.0.0.1",),
        ("192.168.1.5:8010",),
        ("localhost:",),
        ("localhost:+8010",),
        ("[::1]x:8010",),
        ("",),
    ],
)
def test_other_names_are_turned_away(hosts):
    assert Gate(8010).doubt(Asked("/", hosts)) != ""


def test_with_a_token_the_machines_own_addresses_and_names_are_let_in():
    gate = Gate(8010, TOKEN, ("plant-pc",))
    for host in ("192.168.1.5:8010", "[fe80::1]:8010", "plant-pc:8010", "Plant-PC:8010"):
        assert gate.doubt(Asked("/", (host,))) == ""
    assert gate.doubt(Asked("/", ("other-pc:8010",))) != ""


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "https://localhost:8010", "http://localhost:8011", "null",
     "http://localhost:8010.evil.example"],
)  # fmt: skip
def test_pages_of_other_origins_are_turned_away(origin):
    own = Asked("/rig", ("localhost:8010",), ("http://localhost:8010",))
    assert Gate(8010).doubt(own) == ""
    assert "origin" in Gate(8010).doubt(Asked("/rig", ("localhost:8010",), (origin,)))


def test_the_page_comes_with_what_a_browser_has_to_keep_to(serving):
    with serving() as served:
        status, headers, text = served.ask()
        assert status == 200
        assert "run()" in text
        policy = headers["Content-Security-Policy"]
        assert "frame-ancestors 'none'" in policy
        assert re.search(r"script-src 'wasm-unsafe-eval' 'sha256-[\w+/]{43}='", policy)
        assert f"connect-src ws://127.0.0.1:{served.port};" in policy
        assert headers["Cache-Control"] == "no-store"
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "Server" not in headers
        assert served.ask("/etc/passwd")[0] == 404
        assert served.ask("/../page.html")[0] == 404


def test_another_name_or_origin_gets_neither_page_nor_samples(serving):
    with serving() as served:
        assert served.ask(Host="evil.example")[0] == 403
        assert served.ask(Origin="http://evil.example")[0] == 403
        for options in ({"origin": "http://evil.example"}, {"origin": "null"}):
            with pytest.raises(InvalidStatus) as found, served.connect(**options):
                pass
            assert found.value.response.status_code == 403
        with served.connect(origin=f"http://127.0.0.1:{served.port}"):
            pass


def test_a_token_becomes_a_cookie_that_no_script_reads(serving):
    with serving(token=TOKEN) as served:
        assert served.ask()[0] == 401
        with pytest.raises(InvalidStatus) as found, served.connect():
            pass
        assert found.value.response.status_code == 401
        status, headers, _ = served.ask(f"/?token={TOKEN}")
        assert (status, headers["Location"]) == (303, "/")
        cookie, *rules = headers["Set-Cookie"].split("; ")
        assert {"HttpOnly", "SameSite=Strict"} <= set(rules)
        assert served.ask(Cookie=f"theme=dark; {cookie}")[0] == 200
        with served.connect(additional_headers={"Cookie": cookie}):
            pass
        assert served.told == []


def test_wrong_tokens_are_refused_and_told_once(serving):
    with serving(token=TOKEN) as served:
        for given in ("wrong", TOKEN[:-1], f"{TOKEN}x"):
            assert served.ask(f"/?token={given}")[0] == 401
        assert served.ask(f"/?token={TOKEN}&token={TOKEN}")[0] == 401
        assert served.told == ["a wrong token from 127.0.0.1, 1 in all"]


def test_beyond_this_machine_a_token_is_needed(tmp_path):
    assert token_for("127.0.0.1") == ""
    assert len(token_for("192.168.1.5")) >= 32
    door = PageDoor(tmp_path / "page.html", "", (), host="0.0.0.0", port=0)
    with refused(place="page, token"):
        door.check()
    token = token_for("0.0.0.0")
    open_door = PageDoor(tmp_path / "page.html", "", (), host="0.0.0.0", port=0, token=token)
    open_door.check()
    assert open_door.address.endswith(f"/?token={token}")
    assert token not in repr(open_door)


def test_a_port_in_use_is_refused_before_anything_starts(serving, tmp_path):
    with serving() as served, refused(place="page"):
        PageDoor(tmp_path / "page.html", "", (), port=served.port).check()
