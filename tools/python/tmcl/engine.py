"""JSON-RPC as the daemon speaks it: which answer belongs to which call. Does no I/O.

It is told what was received and says what that means; both faces, with and without asyncio, and
every way to the daemon have this one engine.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from .errors import NOT_SENT, UNKNOWN, ConnectionLost, Error, error_of, garbage
from .lines import MOST_BYTES_TO_DAEMON
from .methods import EFFECTS

PROTOCOL_MAJOR = 1
MOST_CALLS = 256
#: What keeps axes safe, or lets others have them, waits behind no other calls.
UNCOUNTED = ("lease.renew", "lease.release")


class Framing(Protocol):
    def frame(self, message: bytes) -> bytes: ...

    def receive(self, data: bytes) -> Iterator[bytes]: ...

    def to_send(self) -> bytes: ...


@dataclass(frozen=True)
class Hello:
    """The first thing that comes."""

    daemon: str
    serves: str | None
    #: Its time goes on by calls, and not by the computer's clock.
    in_virtual_time: bool = False


@dataclass(frozen=True)
class Answer:
    id: int
    result: Mapping[str, Any]


@dataclass(frozen=True)
class Failure:
    id: int
    error: Error


@dataclass(frozen=True)
class Notification:
    method: str
    params: Mapping[str, Any]


Message = Hello | Answer | Failure | Notification


class Engine:
    def __init__(self, framing: Framing) -> None:
        self._framing = framing
        self._last_id = 0
        self._waiting: dict[int, str] = {}
        self.greeted = False

    @property
    def is_waiting(self) -> bool:
        return bool(self._waiting)

    def call(self, method: str, params: Mapping[str, Any]) -> tuple[int, bytes]:
        """The id of the call, and what is to be sent. Raises Error if that cannot be sent."""
        request = {"jsonrpc": "2.0", "id": self._last_id + 1, "method": method}
        if params:
            request["params"] = dict(params)
        try:
            message = json.dumps(request, allow_nan=False, separators=(",", ":")).encode()
        except (TypeError, ValueError) as wrong:
            raise _not_sent("bad_argument", f"{method}: {wrong}") from wrong
        if len(message) > MOST_BYTES_TO_DAEMON:
            hint = "gateway.rpc.path_stage() and gateway.rpc.firmware_stage() take long files in parts"
            raise _not_sent("line_too_long", f"{method}: {len(message)} bytes are too many", hint)
        counts = method not in UNCOUNTED and EFFECTS.get(method) != "stops"
        if counts and len(self._waiting) >= MOST_CALLS:
            raise _not_sent("too_many_requests", f"{MOST_CALLS} calls wait for their answers")
        self._last_id += 1
        self._waiting[self._last_id] = method
        return self._last_id, self._framing.frame(message)

    def receive(self, data: bytes) -> Iterator[Message]:
        """What it means, in the order in which it came. Raises ProtocolError or another Error
        after which the connection is good for nothing: close it, and call `lose`."""
        for text in self._framing.receive(data):
            yield self._read(text)

    def to_send(self) -> bytes:
        """What is to be sent besides calls."""
        return self._framing.to_send()

    def lose(self, why: str) -> dict[int, Error]:
        """The connection has ended: what became of each call that has no answer."""
        lost: dict[int, Error] = {
            number: ConnectionLost(
                f"{method}: {why}",
                name="connection_lost",
                outcome=UNKNOWN,
                hint="It may have been executed: look at the state before you call it again",
            )
            for number, method in self._waiting.items()
        }
        self._waiting.clear()
        return lost

    def _read(self, text: bytes) -> Message:
        try:
            said = json.loads(text)
        except (ValueError, RecursionError):
            raise garbage(f"not JSON: {text[:60]!r}") from None
        if not isinstance(said, dict):
            raise garbage(f"no JSON object: {text[:60]!r}")
        if not self.greeted:
            return self._greeting(said)
        if "method" in said:
            params = said.get("params")
            return Notification(str(said["method"]), params if isinstance(params, dict) else {})
        return self._answer(said)

    def _greeting(self, said: Mapping[str, Any]) -> Hello:
        params = said.get("params")
        if said.get("method") == "hello" and isinstance(params, dict):
            protocol = params.get("protocol")
            major = protocol.get("major") if isinstance(protocol, dict) else None
            if major != PROTOCOL_MAJOR:
                raise garbage(f"the daemon speaks version {major} of the protocol, and this is 1")
            self.greeted = True
            serves = params.get("serves")
            return Hello(
                str(params.get("daemon", "")),
                None if serves is None else str(serves),
                params.get("time") == "virtual",
            )
        raise _first_error(said) or garbage("the daemon does not say hello")

    def _answer(self, said: Mapping[str, Any]) -> Message:
        number, result, error = said.get("id"), said.get("result"), said.get("error")
        if not isinstance(number, int) or isinstance(number, bool) or number > self._last_id:
            raise _first_error(said) or garbage(f"an answer to no call: {number!r}")
        if self._waiting.pop(number, None) is None:
            raise garbage(f"a second answer to call {number}")
        if isinstance(error, dict):
            return Failure(number, error_of(error))
        if not isinstance(result, dict):
            raise garbage(f"the answer to call {number} has neither a result nor an error")
        return Answer(number, result)


def _first_error(said: Mapping[str, Any]) -> Error | None:
    """Of a message that belongs to no call."""
    error = said.get("error")
    return error_of(error) if isinstance(error, dict) else None


def _not_sent(name: str, message: str, hint: str | None = None) -> Error:
    return Error(message, name=name, outcome=NOT_SENT, hint=hint)
