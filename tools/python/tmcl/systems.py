"""In what systems differ: sockets in a folder, users and groups, fork(), Ctrl-C. Nothing else in the
package asks what it runs on.

A child made by fork() may not have the connections of its parent: a daemon stops what a program has
set turning when its connection ends, and a connection ends with the last process that has it.
"""

from __future__ import annotations

import asyncio
import errno
import os
import sys
import weakref
from concurrent.futures import Future, wait
from pathlib import Path
from typing import TypeVar

from .errors import NOT_SENT, Error, NotConnected

#: Debian's policy: groups below are the system's, but for the one that the package of tmcld makes.
FIRST_OWN_GROUP = 1000
PACKAGED_GROUP = "tmcl"
#: On Windows Ctrl-C ends no wait; it is seen between two.
LONGEST_WAIT_S = 0.3

T = TypeVar("T")

_connections: weakref.WeakSet[asyncio.StreamWriter] = weakref.WeakSet()


async def open_socket(path: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Raises NotConnected."""
    if sys.platform == "win32":
        raise _not_connected(
            f"there is no tmcld at {path}: it serves programs of Windows over the network only",
            'name its URL: tmcl.connect("https://gateway:4143", token_file=...)',
        )
    try:
        return await asyncio.open_unix_connection(path)
    except OSError as wrong:
        message = f"cannot connect to tmcld at {path}: {os.strerror(wrong.errno or 0)}"
        raise _not_connected(message, hint_for(wrong, path)) from wrong


def _not_connected(message: str, hint: str) -> NotConnected:
    return NotConnected(message, name="not_connected", outcome=NOT_SENT, hint=hint)


def hint_for(wrong: OSError, path: str) -> str:
    if wrong.errno in (errno.EACCES, errno.EPERM):
        return _hint_for_access_to(Path(path))
    if wrong.errno == errno.EAGAIN:
        return "The daemon does not accept connections: is it stopped or overloaded?"
    return "Is tmcld running? 'tmcld --config FILE' starts it; its configuration names the socket"


def _hint_for_access_to(socket: Path) -> str:
    try:
        if sys.platform != "win32":
            return access_hint(socket.owner(), socket.group(), socket.stat().st_gid)
    except (OSError, KeyError):
        pass
    return "This user may not look into the directory of the socket: ask who started tmcld"


def access_hint(user: str, group: str, group_id: int) -> str:
    """Membership in a group of the system gives far more than a socket."""
    who = f"The socket is for user '{user}' and group '{group}'"
    if (group_id >= FIRST_OWN_GROUP and group != user) or group == PACKAGED_GROUP:
        return f"{who}: join the group with 'sudo adduser $USER {group}', and log in again"
    return (
        f"{who}. Become that user, or let tmcld give the socket to a group made for it: "
        "'sudo addgroup tmcl', 'sudo adduser $USER tmcl', log in again, and start it with "
        "'sudo sg tmcl -c \"tmcld --config FILE\"'"
    )


def result_of(future: Future[T]) -> T:
    """Ctrl-C ends the wait for it."""
    while sys.platform == "win32" and not future.done():
        wait([future], LONGEST_WAIT_S)
    return future.result()


def keep_to_this_process(writer: asyncio.StreamWriter) -> None:
    _connections.add(writer)


def check_process(made_in: int) -> None:
    """Raises Error in another process than that of this number."""
    if os.getpid() != made_in:
        raise Error(
            "the gateway was connected by the process that this one was forked from",
            name="forked",
            outcome=NOT_SENT,
            hint="Connect in this process, too: tmcl.connect()",
        )


def _let_go() -> None:
    """In a child. What its objects hold stays open, but leads nowhere: they close it some time."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for writer in list(_connections):
        socket = writer.get_extra_info("socket")
        if socket is not None and socket.fileno() >= 0:
            os.dup2(nowhere, socket.fileno(), inheritable=False)
    os.close(nowhere)
    _connections.clear()


if sys.platform != "win32":
    os.register_at_fork(after_in_child=_let_go)
