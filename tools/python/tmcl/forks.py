"""What a child made by fork() may not have of its parent: the connections to daemons.

A daemon stops what a program has set turning when its connection ends, and a connection ends with
the last process that has it.
"""

from __future__ import annotations

import os
import weakref
from asyncio import StreamWriter

from .errors import NOT_SENT, Error

_connections: weakref.WeakSet[StreamWriter] = weakref.WeakSet()


def keep_to_this_process(writer: StreamWriter) -> None:
    _connections.add(writer)


def check_process(made_in: int) -> None:
    """Raises Error in another process than that of this number."""
    if os.getpid() != made_in:
        raise Error(
            "the gateway was connected by the process that this one was forked from",
            name="forked",
            outcome=NOT_SENT,
            hint="connect in this process, too: tmcl.connect()",
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


os.register_at_fork(after_in_child=_let_go)
