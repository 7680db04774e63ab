"""Moves motors through tmcld: docs/PYTHON.md.

    import tmcl

    gateway = tmcl.connect()
    gateway.x.move(12.5)
    gateway.x.wait()
    print(gateway.x.position)
"""

from __future__ import annotations

from . import aio
from .errors import ConnectionLost, Error, LeaseLost, NotConnected, ProtocolError
from .methods import State, WatchedState
from .recording import Recording
from .sync import Axis, Gateway, Lease, connect

#: That of the project, as CMakeLists.txt has it.
__version__ = "0.2.0"

__all__ = [
    "Axis",
    "ConnectionLost",
    "Error",
    "Gateway",
    "Lease",
    "LeaseLost",
    "NotConnected",
    "ProtocolError",
    "Recording",
    "State",
    "WatchedState",
    "__version__",
    "aio",
    "connect",
]
