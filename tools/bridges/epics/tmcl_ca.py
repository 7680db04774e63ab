"""Fields of records on Channel Access, by caproto: what a client writes is asked for first."""

from __future__ import annotations

import logging
import math
import socket
from collections.abc import Awaitable, Callable
from contextvars import ContextVar
from typing import Any

import caproto as ca
from caproto.asyncio.server import Context

Take = Callable[[Any], Awaitable[None]]

#: A client whose computer says nothing any more is gone after three seconds.
KEEPALIVE = {"KEEPIDLE": 1, "KEEPINTVL": 1, "KEEPCNT": 2, "USER_TIMEOUT": 3000}
#: The client whose write is carried out.
CLIENT: ContextVar[Any] = ContextVar("client", default=None)


class Refused(Exception):
    """What a client wrote is not done."""


def finite(value: Any) -> float:
    if not math.isfinite(value):
        raise Refused(f"{value} is no number that can be written")
    return float(value)


def check(data: Any, kind: ca.ChannelType) -> None:
    """An empty text would be 0, a letter its number in the alphabet."""
    if kind == ca.ChannelType.CHAR or (kind == ca.ChannelType.STRING and b"" in list(data)):
        raise Refused("this is no number and no choice")
    if kind in (ca.ChannelType.DOUBLE, ca.ChannelType.FLOAT):
        list(map(finite, data))


class Field(ca.ChannelData):
    """What a client writes into it goes to the axis; what is shown in it comes from there."""

    name = ""
    take: Take | None = None
    refresh: Callable[[], Awaitable[None]] | None = None

    def check_access(self, hostname: str, username: str) -> ca.AccessRights:
        return ca.AccessRights(1 if self.take is None else 3)

    async def read(self, data_type: Any) -> Any:
        if self.refresh is not None:
            await self.refresh()
        return await super().read(data_type)

    async def auth_write(self, *said: Any, user_address: Any = None, **more: Any) -> Any:
        CLIENT.set(user_address)
        return await super().auth_write(*said, **more)

    async def write_from_dbr(self, data: Any, data_type: Any, *said: Any, **more: Any) -> Any:
        """Looks at it before it is made a number of another kind, which could be any."""
        try:
            check(data, ca.native_type(data_type))
            return await super().write_from_dbr(data, data_type, *said, **more)
        except Refused as refused:
            raise Refused(f"{self.name}: {refused}") from None

    async def write(self, value: Any, **_: Any) -> None:
        """By a client. The time and the alarm that it may send along are not its to say."""
        assert self.take is not None
        await self.take(self.preprocess_value(value))

    async def show(self, value: Any, when: float, **more: Any) -> None:
        await super().write(value, verify_value=False, timestamp=when, **more)


def kind(base: type[Any]) -> Any:
    return type(base.__name__, (Field, base), {})


Number, Flag, Bits = map(kind, (ca.ChannelDouble, ca.ChannelShort, ca.ChannelInteger))
Choice, Text = map(kind, (ca.ChannelEnum, ca.ChannelString))


class Server(Context):
    """Knows which clients are there."""

    def is_here(self, client: Any) -> bool:
        return any(it.connected and it.circuit.address == client for it in self.circuits)

    async def tcp_handler(self, client: Any, address: Any) -> None:
        connection = client.writer.get_extra_info("socket")
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in KEEPALIVE.items():
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, f"TCP_{option}"), value)
        await super().tcp_handler(client, address)


class Brief(logging.Formatter):
    """A line for what is refused, which is no fault of this program and needs no stack."""

    def format(self, record: logging.LogRecord) -> str:
        error = record.exc_info[1] if record.exc_info else None
        return f"tmcl-ioc: {str(error or '') or record.getMessage()}"


def log_briefly() -> None:
    """A beacon that no client takes is no news."""
    handler = logging.StreamHandler()
    handler.setFormatter(Brief())
    handler.addFilter(lambda record: "beacon" not in str(record.msg))
    logging.getLogger("caproto").addHandler(handler)
