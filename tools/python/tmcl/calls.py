"""What the daemon calls its methods, as calls of this package.

Its messages and hints are for all its clients, and name methods: "see axis.list".
"""

from __future__ import annotations

import re

from .methods import EFFECTS

#: Methods that have more than a function of `gateway.rpc`.
_OWN = {
    "axis.list": "gateway.axes()",
    "lease.acquire": "gateway.lease()",
    "system.stop_all": "gateway.stop_all()",
    "axis.move_to": "axis.move()",
    "axis.move_by": "axis.move_by()",
    "axis.rotate": "axis.rotate()",
    "axis.stop": "axis.stop()",
    "axis.wait": "axis.wait()",
    "axis.home": "axis.home()",
    "axis.recover": "axis.recover()",
    "axis.get_state": "axis.state()",
    "axis.get_errors": "axis.errors()",
    "axis.get_units": "axis.units()",
    "parameter.get": "axis.get()",
    "parameter.set": "axis.set()",
}

#: Not a part of a longer name, nor of a file's; the point at the end of a sentence may follow.
_METHOD = re.compile(
    r"(?<![\w./])("
    + "|".join(re.escape(method) for method in EFFECTS if "." in method)
    + r")(?!\w|\.\w)"
)


def with_calls(text: str) -> str:
    return _METHOD.sub(lambda found: _call_of(found[1]), text)


def _call_of(method: str) -> str:
    return _OWN.get(method) or f"gateway.rpc.{method.replace('.', '_')}()"
