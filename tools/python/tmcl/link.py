"""The ways to a daemon: a unix socket, or a WebSocket. What is said there is the engine's."""

from __future__ import annotations

import asyncio
import os
import ssl
import urllib.parse
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path

from .engine import Framing
from .errors import NOT_SENT, NotConnected
from .lines import Lines
from .systems import keep_to_this_process, open_socket
from .websocket import WebSocket

DEFAULT_SOCKET = "/run/tmcld/tmcld.sock"
DEFAULT_PORT = 4143
READ_BYTES = 65_536
#: So long the other end may take to accept, to shake hands and to greet.
OPENING_S = 10.0


@dataclass
class Link:
    """Bytes in both directions, and how messages are told apart in them."""

    name: str
    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    framing: Framing

    def __post_init__(self) -> None:
        keep_to_this_process(self.writer)


OpenLink = Callable[[], Awaitable[Link]]


def way_to(
    where: str | os.PathLike[str] | None,
    token: str | None = None,
    token_file: str | os.PathLike[str] | None = None,
    ca: str | os.PathLike[str] | None = None,
) -> OpenLink:
    """How the daemon is reached that is said so; raises NotConnected for what nothing can be."""
    name = os.fspath(where) if where else os.environ.get("TMCLD_SOCKET") or DEFAULT_SOCKET
    if token_file is not None:
        token = _token_in(token_file)
    if "://" not in name:
        return lambda: _open_unix(name)
    url = urllib.parse.urlsplit(name)
    context = _context_for(url, ca, token is not None)
    return lambda: _open_websocket(url, token, context)


async def _open_unix(path: str) -> Link:
    return Link(path, *await open_socket(path), Lines())


def _not_connected(name: str, message: str, hint: str | None = None) -> NotConnected:
    return NotConnected(message, name=name, outcome=NOT_SENT, hint=hint)


def _token_in(file: str | os.PathLike[str]) -> str:
    try:
        token = Path(file).read_text("ascii").strip()
    except (OSError, UnicodeError) as wrong:
        raise _not_connected("no_token", f"no token can be read: {wrong}") from wrong
    if not token or len(token.split()) != 1:
        raise _not_connected("no_token", f"{os.fspath(file)} does not hold one token")
    return token


def _context_for(
    url: urllib.parse.SplitResult, ca: str | os.PathLike[str] | None, has_token: bool
) -> ssl.SSLContext | None:
    try:
        port = url.port
    except ValueError as wrong:
        raise _not_connected("bad_url", f"{url.geturl()}: {wrong}") from wrong
    if url.scheme not in ("https", "http") or not url.hostname or port == 0:
        example = "Such as https://gateway.example:4143"
        raise _not_connected("bad_url", f"'{url.geturl()}' is no URL of a gateway", example)
    if url.scheme == "http":
        if has_token and url.hostname not in ("localhost", "127.0.0.1", "::1"):
            hint = "Use https://: on the way, a token could be read"
            raise _not_connected("bad_url", "a token goes out by https only", hint)
        return None
    try:
        return ssl.create_default_context(cafile=os.fspath(ca) if ca is not None else None)
    except OSError as wrong:
        raise _not_connected("bad_ca", f"no certificate can be read from {ca}: {wrong}") from wrong


async def _open_websocket(
    url: urllib.parse.SplitResult, token: str | None, context: ssl.SSLContext | None
) -> Link:
    host, port = url.hostname or "", url.port or DEFAULT_PORT
    name = f"{url.scheme}://{url.netloc}"
    try:
        reader, writer = await asyncio.open_connection(host, port, ssl=context)
    except ssl.SSLCertVerificationError as wrong:
        message = f"{name} has no certificate that can be trusted: {wrong.verify_message}"
        hint = "'ca=' names the file of the authority that signed it"
        raise _not_connected("bad_certificate", message, hint) from wrong
    except (OSError, ssl.SSLError) as wrong:
        raise _not_connected("not_connected", f"cannot connect to {name}: {wrong}") from wrong
    framing = WebSocket(url.netloc, url.path.rstrip("/") + "/ws", token)
    link = Link(name, reader, writer, framing)
    try:
        await _shake_hands(link, framing)
    except BaseException:
        writer.close()
        raise
    return link


async def _shake_hands(link: Link, framing: WebSocket) -> None:
    """What comes behind the headers stays in the reader, for the engine."""
    link.writer.write(framing.opening())
    try:
        list(framing.receive(await link.reader.readuntil(b"\r\n\r\n")))
        if not framing.opened:  # a refusal, which says why
            list(framing.receive(await link.reader.readexactly(framing.missing)))
    except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError) as wrong:
        message = f"{link.name} does not shake hands: {wrong}"
        raise _not_connected("not_connected", message, "Is it a tmcld, by http or https?") from wrong
