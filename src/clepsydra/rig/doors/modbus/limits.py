"""What one client, and all together, may take of a Modbus server."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Bounds that keep one client from holding up others.

    Parameters
    ----------
    clients : int
        Most that are connected at once; more are turned away.
    requests_per_second : float
        Of one client; a faster one is read from no sooner [1/s].
    idle : float
        A client that asks for nothing for so long, or takes no answer, is let go [s].
    at_once : int
        Requests of one client that are answered before the others have their turn, and that may
        wait for a late answer; the most that a server is expected to have
        (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, section 4.4.1).
    unread : int
        Answers that a client has not taken, before no more of it is read [bytes].
    """

    clients: int = 64
    requests_per_second: float = 5000.0
    idle: float = 300.0
    at_once: int = 16
    unread: int = 16384
