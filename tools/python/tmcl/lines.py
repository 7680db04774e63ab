"""How messages are told apart on a unix socket: one a line. Does no I/O."""

from __future__ import annotations

from collections.abc import Iterator

from .errors import garbage

#: The daemon's longest line, from docs/PROTOCOL.md.
MOST_BYTES = 1_048_576
MOST_BYTES_TO_DAEMON = 65_536


class Lines:
    def __init__(self) -> None:
        self._received = bytearray()

    def frame(self, message: bytes) -> bytes:
        return message + b"\n"

    def receive(self, data: bytes) -> Iterator[bytes]:
        """The messages that are complete now. Raises ProtocolError for one that is too long."""
        self._received += data
        *complete, self._received = self._received.split(b"\n")
        for line in complete:
            if len(line) > MOST_BYTES:
                break
            yield bytes(line)
        else:
            if len(self._received) <= MOST_BYTES:
                return
        raise garbage(f"a line is longer than {MOST_BYTES} bytes")

    def to_send(self) -> bytes:
        return b""
