"""One client of a Modbus server: frames in, answers out, within its limits."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from typing import cast

from clepsydra.rig.doors.modbus.limits import Limits
from clepsydra.rig.doors.wire_faults import WireFaults

#: The header: transaction, protocol, length of what follows, unit (MODBUS Messaging on TCP/IP
#: Implementation Guide V1.0b, section 3.1.3); a request has 253 bytes at most behind it.
_HEADER, _BEFORE_LENGTH, _SHORTEST, _LONGEST = 7, 6, 2, 254
#: From a unit and a request to its answer.
_Answer = Callable[[int, bytes], bytes]


class Connection(asyncio.Protocol):
    """A client.

    Parameters
    ----------
    answer : callable
        Takes unit and request, and returns its answer.
    accept : callable
        Takes the connection, and says whether it may stay.
    leave : callable
        Is told when it is over.
    report : callable
        Is told in words what is out of the ordinary.
    limits : Limits
    faults : WireFaults
    """

    def __init__(
        self, answer: _Answer, accept: Callable[[Connection], bool],
        leave: Callable[[Connection], None], report: Callable[[str], None],
        limits: Limits, faults: WireFaults,
    ) -> None:  # fmt: skip
        self._answer, self._accept, self._leave, self._report = answer, accept, leave, report
        self._limits, self._faults = limits, faults
        self._loop = asyncio.get_running_loop()
        self._buffer = bytearray()
        self._late: deque[bytes] = deque()
        self._last_late = 0.0
        self._blocked = self._hurried = self._going_on = False
        self._allowance = float(limits.at_once)
        self.heard = self._counted = self._loop.time()
        self.peer = ""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin, or end at once."""
        self._transport = cast(asyncio.Transport, transport)
        self._transport.set_write_buffer_limits(high=self._limits.unread)
        self.peer = str((transport.get_extra_info("peername") or ("unknown",))[0])
        if not self._accept(self):
            self._transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """End."""
        self._buffer.clear()
        self._leave(self)

    def end(self) -> None:
        """Let the client go, whether it takes what is still to be sent or not."""
        self._transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take what has come, and answer what is whole."""
        self._buffer += data
        self._go_on()

    def pause_writing(self) -> None:
        """Answer no more until the client takes what it was answered."""
        self._blocked = True

    def resume_writing(self) -> None:
        """Go on."""
        self._blocked = False
        self._go_on()

    def _go_on(self) -> None:
        """Answer requests until none is whole, or it is the turn of others."""
        for _ in range(self._limits.at_once):
            if self._transport.is_closing() or self._blocked or self._late_ones():
                break
            frame = self._next_frame()
            if frame is None:
                break
            if not self._may_go_on():
                return
            del self._buffer[: len(frame)]
            self._answer_frame(bytes(frame))
        else:
            self._again(0.0)
        self._listen(waiting=self._blocked or self._going_on or self._late_ones())

    def _again(self, wait: float) -> None:
        """Go on after a wait [s], and read nothing before."""
        if not self._going_on:
            self._going_on = True
            self._loop.call_later(wait, self._turn)
        self._listen(waiting=True)

    def _turn(self) -> None:
        self._going_on = False
        if not self._transport.is_closing():
            self._go_on()

    def _listen(self, *, waiting: bool) -> None:
        if self._transport.is_closing():
            return
        if waiting:
            self._transport.pause_reading()
        else:
            self._transport.resume_reading()

    def _late_ones(self) -> bool:
        return len(self._late) >= self._limits.at_once

    def _next_frame(self) -> bytearray | None:
        """Return the next frame once it is whole; who sends something else is let go."""
        if len(self._buffer) < _BEFORE_LENGTH:
            return None
        protocol = int.from_bytes(self._buffer[2:4], "big")
        length = int.from_bytes(self._buffer[4:6], "big")
        if protocol != 0 or not _SHORTEST <= length <= _LONGEST:
            self._report(f"{self.peer} sends what is not Modbus TCP, and is let go")
            self.end()
            return None
        end = _BEFORE_LENGTH + length
        return self._buffer[:end] if len(self._buffer) >= end else None

    def _may_go_on(self) -> bool:
        """Count a request against the rate; where it is too early, wait."""
        limits, now = self._limits, self._loop.time()
        earned = (now - self._counted) * limits.requests_per_second
        self._allowance = min(self._allowance + earned, float(limits.at_once))
        self._counted = now
        if self._allowance < 1.0:
            if not self._hurried:
                self._hurried = True
                self._report(
                    f"{self.peer} asks more than {limits.requests_per_second:g} times a second, "
                    "and is answered no faster"
                )
            self._again((1.0 - self._allowance) / limits.requests_per_second)
            return False
        self._allowance -= 1.0
        self.heard = now
        return True

    def _answer_frame(self, frame: bytes) -> None:
        faults = self._faults
        if faults.loses():
            return
        found = self._answer(frame[6], frame[_HEADER:])
        sent = frame[:4] + (1 + len(found)).to_bytes(2, "big") + frame[6:7] + found
        delay = faults.delay
        if delay or self._late:
            # An answer never overtakes the one before it.
            self._last_late = max(self._loop.time() + delay, self._last_late)
            self._late.append(sent)
            self._loop.call_at(self._last_late, self._send_late)
        else:
            self._transport.write(sent)

    def _send_late(self) -> None:
        sent = self._late.popleft()
        if not self._transport.is_closing():
            self._transport.write(sent)
            self._go_on()
