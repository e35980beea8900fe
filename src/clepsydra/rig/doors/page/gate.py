"""Who may have the page of a rig: by the name that was asked for, by its origin, by a token."""

from __future__ import annotations

import hmac
import ipaddress
import socket
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

_HTTP_PORT = 80


def is_loopback(host: str) -> bool:
    """Return whether an address is seen by this machine alone.

    Examples
    --------
    >>> is_loopback("127.0.0.1"), is_loopback("localhost"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class Asked:
    """What a request says of who sent it.

    Parameters
    ----------
    target : str
        Path and query.
    hosts, origins, cookies : tuple of str
        Each header of the name.
    """

    target: str
    hosts: tuple[str, ...]
    origins: tuple[str, ...] = ()
    cookies: tuple[str, ...] = ()

    @property
    def path(self) -> str:
        """Without its query."""
        return urlsplit(self.target).path

    def given(self, name: str) -> str:
        """Return what the query says; "" where it does not, or twice."""
        found = parse_qs(urlsplit(self.target).query, max_num_fields=4).get(name, [])
        return found[0] if len(found) == 1 else ""

    def kept(self, name: str) -> str:
        """Return what a cookie holds; "" where there is none."""
        for cookie in ";".join(self.cookies).split(";"):
            key, _, value = cookie.strip().partition("=")
            if key == name:
                return value
        return ""


@dataclass(frozen=True)
class Gate:
    """The rules by which requests are let in.

    A page of somebody else that a browser has open reaches what listens on this machine too: under
    a name that it lets point here, or as another origin. So the name that was asked for must be
    one of this machine's, and the origin, where there is one, the rig's own. Addresses in digits
    need no list: no name can be made to point there unseen.

    Parameters
    ----------
    port : int
        At which it is reached.
    token : str
        What opens it; "" where nothing is needed.
    names : tuple of str
        What this machine is called, beside its loopback names.

    Examples
    --------
    >>> gate = Gate(8010)
    >>> gate.doubt(Asked("/", ("localhost:8010",)))
    ''
    >>> gate.doubt(Asked("/", ("evil.example:8010",)))
    'evil.example:8010 is no name of this machine'
    """

    port: int
    token: str = ""
    names: tuple[str, ...] = ()

    def doubt(self, asked: Asked) -> str:
        """Return why a request is turned away, whoever sent it; "" where it is not."""
        if len(asked.hosts) != 1:
            return "one Host is needed"
        (host,) = asked.hosts
        name, port = _parted(host)
        if port != self.port or not self._is_own(name):
            return f"{host[:80]} is no name of this machine"
        if any(origin.lower() != f"http://{host.lower()}" for origin in asked.origins):
            return "the page of another origin has no business here"
        return ""

    def _is_own(self, name: str) -> bool:
        if name.lower() in ("localhost", *self.names):
            return True
        try:
            address = ipaddress.ip_address(name)
        except ValueError:
            return False
        # Without a token only who is on this machine is let in.
        return address.is_loopback or bool(self.token)

    @property
    def cookie(self) -> str:
        """What the cookie is called: one machine may have several rigs."""
        return f"clepsydra_rig_{self.port}"

    def knows(self, token: str) -> bool:
        """Return whether a token opens it; how long that takes tells nothing of the token."""
        return hmac.compare_digest(token.encode(), self.token.encode())


def own_names() -> tuple[str, ...]:
    """Return what others call this machine."""
    name = socket.gethostname().lower()
    return tuple(dict.fromkeys([name, f"{name.partition('.')[0]}.local", *_known([name])]))


def _known(names: Iterable[str]) -> list[str]:
    return [socket.getfqdn(name).lower() for name in names]


def _parted(host: str) -> tuple[str, int]:
    """Return name and port of a Host; port −1 where it is none."""
    name, colon, port = host.rpartition(":")
    if not colon or host.endswith("]"):
        name, port = host, str(_HTTP_PORT)
    number = int(port) if port.isascii() and port.isdigit() and len(port) < 6 else -1
    return name.strip("[]"), number
