"""Whether a server can listen at an address of this machine."""

from __future__ import annotations

import errno
import socket

from clepsydra.base.errors import Finding, InputError

#: Ports below are for root alone on most systems.
_FIRST_FREE = 1024


def check_listening(place: str, host: str, port: int) -> None:
    """Refuse an address at which nobody can listen now.

    Parameters
    ----------
    place : str
        Who is to listen, for messages.
    host : str
    port : int
        0 for any that is free.

    Raises
    ------
    InputError
        The port is in use, is for root alone, or is none; or the host is not this machine.

    Examples
    --------
    >>> check_listening("Modbus TCP", "127.0.0.1", 70000)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: Modbus TCP: got 70000, expected a port from 1 to 65535; \
give another port.
    """
    if not 0 <= port <= 0xFFFF:
        raise InputError(place, port, "a port from 1 to 65535", "give another port")
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.create_server(address[:2], family=family):
            pass
    except (OSError, UnicodeError) as error:
        raise not_listening(place, error, host, port) from None


def not_listening(place: str, error: OSError | UnicodeError, host: str, port: int) -> InputError:
    """Return what to tell where nobody can listen at an address."""
    number = error.errno if isinstance(error, OSError) else None
    found, expected, remedy = _told(number, host, port)
    return InputError(place, Finding(found), expected, remedy)


def _told(number: int | None, host: str, port: int) -> tuple[str, str, str]:
    if number == errno.EADDRINUSE:
        return (
            f"port {port} of {host}, which is in use", "a port that is free",
            "give another port, or end what listens there: ss -ltnp names it",
        )  # fmt: skip
    if number == errno.EACCES and port < _FIRST_FREE:
        return (
            f"port {port}, which is for root alone", f"a port from {_FIRST_FREE} on",
            "give a higher port, or allow it by net.ipv4.ip_unprivileged_port_start",
        )  # fmt: skip
    return (
        f"{host}, which is no address of this machine", "127.0.0.1, 0.0.0.0 or one of its own",
        "give the address of the network card to which the PLC is connected: ip address lists them",
    )  # fmt: skip
