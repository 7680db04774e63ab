"""The client's side of a WebSocket (RFC 6455): handshake and frames. Does no I/O."""

from __future__ import annotations

import base64
import hashlib
import json
import os
from collections.abc import Callable, Iterator

from .errors import NOT_SENT, ConnectionLost, Error, NotConnected, error_of, garbage
from .lines import MOST_BYTES

MOST_HEADER_BYTES = 16_384
_MOST_CONTROL_BYTES = 125
_GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_CONTINUATION, _TEXT, _BINARY, _CLOSE, _PING, _PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
_HINT = "Is it a tmcld that listens there?"


class WebSocket:
    """Before anything else goes out, `opening()`; `opened` says whether the answer has come, and
    `missing` how much of a refusal has not."""

    def __init__(
        self,
        host: str,
        path: str,
        token: str | None,
        random_bytes: Callable[[int], bytes] = os.urandom,
    ) -> None:
        self._host, self._path, self._token = host, path, token
        self._random_bytes = random_bytes
        self._key = base64.b64encode(random_bytes(16)).decode()
        self._received = bytearray()
        self._fragments: bytearray | None = None
        self._to_send = bytearray()
        self.opened = False
        self.missing = 0

    def opening(self) -> bytes:
        lines = [
            f"GET {self._path} HTTP/1.1",
            f"Host: {self._host}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            f"Sec-WebSocket-Key: {self._key}",
            "Sec-WebSocket-Version: 13",
        ]
        if self._token is not None:
            lines.append(f"Authorization: Bearer {self._token}")
        return "\r\n".join([*lines, "", ""]).encode("latin-1")

    def frame(self, message: bytes) -> bytes:
        return self._frame(_TEXT, message)

    def to_send(self) -> bytes:
        """What the protocol itself has to say, such as a pong; once."""
        waiting = bytes(self._to_send)
        self._to_send.clear()
        return waiting

    def receive(self, data: bytes) -> Iterator[bytes]:
        """The messages that are complete now. Raises NotConnected for a refused handshake,
        ConnectionLost when the server closes, ProtocolError for what is no WebSocket."""
        self._received += data
        if not self.opened and not self._open():
            return
        while (frame := self._take_frame()) is not None:
            message = self._message_of(*frame)
            if message is not None:
                yield message

    def _open(self) -> bool:
        end = self._received.find(b"\r\n\r\n")
        if (len(self._received) if end < 0 else end) > MOST_HEADER_BYTES:
            raise garbage(f"the headers are longer than {MOST_HEADER_BYTES} bytes")
        if end < 0:
            return False
        first, *lines = self._received[:end].decode("latin-1").split("\r\n")
        headers = {
            name.strip().lower(): value.strip()
            for name, _, value in (line.partition(":") for line in lines)
        }
        status = first.split(" ", 2)
        if len(status) < 2 or not status[0].startswith("HTTP/1.") or not status[1].isdecimal():
            raise garbage("the answer is not HTTP")
        if status[1] != "101":
            length = headers.get("content-length", "")
            size = min(int(length), MOST_HEADER_BYTES) if length.isdecimal() else 0
            self.missing = max(end + 4 + size - len(self._received), 0)
            if self.missing == 0:
                raise _refusal(status, bytes(self._received[end + 4 :]))
            return False
        del self._received[: end + 4]
        self._check(headers)
        self.opened = True
        return True

    def _check(self, headers: dict[str, str]) -> None:
        digest = hashlib.sha1((self._key + _GUID).encode(), usedforsecurity=False).digest()
        if (
            headers.get("upgrade", "").lower() != "websocket"
            or "upgrade" not in headers.get("connection", "").lower()
            or headers.get("sec-websocket-accept") != base64.b64encode(digest).decode()
        ):
            raise garbage("the answer is not that of a WebSocket")

    def _frame(self, kind: int, payload: bytes) -> bytes:
        size = len(payload)
        if size < 126:
            head = bytes([0x80 | kind, 0x80 | size])
        elif size < 65_536:
            head = bytes([0x80 | kind, 0x80 | 126]) + size.to_bytes(2, "big")
        else:
            head = bytes([0x80 | kind, 0x80 | 127]) + size.to_bytes(8, "big")
        mask = self._random_bytes(4)
        key = (mask * (size // 4 + 1))[:size]
        masked = int.from_bytes(payload, "big") ^ int.from_bytes(key, "big")
        return head + mask + masked.to_bytes(size, "big")

    def _take_frame(self) -> tuple[bool, int, bytes] | None:
        """Whether it is the last of its message, its kind and what it carries."""
        got = self._received
        if len(got) < 2:
            return None
        if got[0] & 0x70 or got[1] & 0x80:
            raise garbage("a frame with bits that no server may set")
        final, kind, size, begin = bool(got[0] & 0x80), got[0] & 0x0F, got[1], 2
        if kind >= _CLOSE and (size > _MOST_CONTROL_BYTES or not final):
            raise garbage("a control frame that is too long, or in parts")
        if size >= 126:
            begin = 4 if size == 126 else 10
            if len(got) < begin:
                return None
            size = int.from_bytes(got[2:begin], "big")
        if size + len(self._fragments or b"") > MOST_BYTES:
            raise garbage(f"a message is longer than {MOST_BYTES} bytes")
        if len(got) < begin + size:
            return None
        payload = bytes(got[begin : begin + size])
        del got[: begin + size]
        return final, kind, payload

    def _message_of(self, final: bool, kind: int, payload: bytes) -> bytes | None:
        if kind == _PING:
            self._to_send += self._frame(_PONG, payload)
        elif kind == _CLOSE:
            self._to_send += self._frame(_CLOSE, payload[:2])
            raise self._closed(payload)
        elif kind in (_CONTINUATION, _TEXT):
            return self._part(final, kind, payload)
        elif kind != _PONG:
            raise garbage(f"a frame of kind {kind}")
        return None

    def _part(self, final: bool, kind: int, payload: bytes) -> bytes | None:
        if (kind == _CONTINUATION) != (self._fragments is not None):
            raise garbage("parts of messages in a wrong order")
        whole = (self._fragments or bytearray()) + payload
        self._fragments = None if final else whole
        return bytes(whole) if final else None

    @staticmethod
    def _closed(payload: bytes) -> Error:
        why = payload[2:].decode("utf-8", "replace")
        code = int.from_bytes(payload[:2], "big") if len(payload) >= 2 else 1005
        return ConnectionLost(
            f"the gateway has closed the connection ({code}{': ' + why if why else ''})",
            name="connection_lost",
            outcome="unknown",
        )


def _refusal(status: list[str], body: bytes) -> NotConnected:
    """A gateway says in JSON why, and what to try."""
    try:
        said = json.loads(body)
        error = error_of(said["error"]) if isinstance(said["error"], dict) else None
    except (ValueError, RecursionError, TypeError, KeyError):
        error = None
    return NotConnected(
        error.message if error else f"the connection is refused: {' '.join(status[1:])}",
        name=error.name if error else "http_" + status[1],
        outcome=NOT_SENT,
        hint=error.hint if error else _HINT,
        data={"status": int(status[1])},
    )
