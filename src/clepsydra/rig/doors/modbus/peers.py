"""Who may connect: addresses and networks."""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence

from clepsydra.base.errors import InputError

_Network = ipaddress.IPv4Network | ipaddress.IPv6Network


class Peers:
    """The addresses from which clients are accepted.

    Parameters
    ----------
    allowed : sequence of str, optional
        Addresses and networks; all where left out.

    Raises
    ------
    InputError
        One is no address.

    Examples
    --------
    >>> Peers(["192.168.7.0/24"]).allows("192.168.7.3"), Peers(["192.168.7.1"]).allows("10.0.0.1")
    (True, False)
    """

    def __init__(self, allowed: Sequence[str] | None) -> None:
        self._networks = None if allowed is None else [_network(each) for each in allowed]

    def allows(self, address: str) -> bool:
        """Return whether a client from an address is accepted."""
        if self._networks is None:
            return True
        try:
            found = ipaddress.ip_address(address.partition("%")[0])
        except ValueError:
            return False
        if isinstance(found, ipaddress.IPv6Address) and found.ipv4_mapped:
            found = found.ipv4_mapped
        return any(found in network for network in self._networks)


def _network(text: str) -> _Network:
    try:
        return ipaddress.ip_network(text, strict=False)
    except ValueError:
        raise InputError(
            "Modbus TCP, peers", text, "an address or a network",
            "write it as 192.168.7.20 or 192.168.7.0/24",
        ) from None  # fmt: skip
