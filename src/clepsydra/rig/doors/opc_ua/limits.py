"""What one door of OPC UA holds at most, whatever its clients ask for."""

from __future__ import annotations

#: Connections, sessions, subscriptions, and monitored items of all clients together.
CONNECTIONS, SESSIONS, SUBSCRIPTIONS, ITEMS = 128, 100, 200, 40_000
#: Values that wait for one monitored item, and messages of one subscription without a receipt.
QUEUED_VALUES, UNACKNOWLEDGED = 100, 10
#: Of a publishing interval [ms].
FASTEST_PUBLISHING, SLOWEST_PUBLISHING = 20.0, 3_600_000.0
#: Publishing intervals without a request of its client, after which a subscription ends; and those
#: without news, after which it says that it is there.
LIFETIME, KEEP_ALIVE = 1_000, 300
#: For how long a session may be silent, and a connection without a session [ms], [s].
SHORTEST_SESSION, LONGEST_SESSION, UNUSED_CONNECTION = 5_000, 120_000, 15.0
#: Of a message and of one of its chunks [bytes]; OPC 10000-6, 7.1.2.3 asks for 8192 and more.
MESSAGE, CHUNK, SMALLEST_CHUNK = 4 << 20, 65_536, 8_192
#: Messages that wait on one connection, nodes that are named in one of them.
WAITING_MESSAGES, NODES = 100, 5_000
#: What waits for a slow client before it is let go [bytes].
UNSENT = 8 << 20
#: Values that one session writes [1/s], and as many more at once after a rest.
WRITES = 2_000.0
#: Certificates that were refused and are kept to be looked at.
REJECTED = 100
