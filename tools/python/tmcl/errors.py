"""What can go wrong, as exceptions that say what is known about the call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .calls import with_calls

NOT_SENT = "not_sent"
UNKNOWN = "unknown"


class Error(Exception):
    """A call that failed.

    `name` is to branch on, and so is `outcome`: "refused" (not executed; the module said why),
    "not_sent" (not executed), "unknown" (it may have been executed: look at the state before you
    call again) or "done" (executed; something else went wrong). `hint` says what to try, or is
    None. `data` is all that the daemon said.
    """

    def __init__(
        self,
        message: str,
        *,
        name: str,
        outcome: str,
        hint: str | None = None,
        data: Mapping[str, Any] | None = None,
        code: int = 0,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.name = name
        self.outcome = outcome
        self.hint = hint
        self.data: Mapping[str, Any] = data if data is not None else {}
        self.code = code

    def __str__(self) -> str:
        known = f" [{self.name}, outcome: {self.outcome}]"
        return self.message + known + (f"\n  {self.hint}" if self.hint else "")


class NotConnected(Error):
    """The daemon could not be reached; nothing was sent."""


class ConnectionLost(Error):
    """The connection ended before the answer came."""


class LeaseLost(Error):
    """The lease that the call was to be made under has ended."""


class ProtocolError(Error):
    """What came is nothing that a tmcld would say."""


def error_of(said: Mapping[str, Any]) -> Error:
    """The exception for the "error" of an answer."""
    data = said.get("data")
    data = data if isinstance(data, dict) else {}
    name = str(data.get("name", "unknown_error"))
    kind = LeaseLost if name in ("lease_lost", "stale_epoch") else Error
    hint, code = data.get("hint"), said.get("code")
    return kind(
        with_calls(str(said.get("message", ""))),
        name=name,
        outcome=str(data.get("outcome", UNKNOWN)),
        hint=with_calls(str(hint)) if hint is not None else None,
        data=data,
        code=code if isinstance(code, int) else 0,
    )


def garbage(what: str) -> ProtocolError:
    return ProtocolError(
        what,
        name="garbage",
        outcome=UNKNOWN,
        hint="Is it a tmcld that listens there?",
    )
