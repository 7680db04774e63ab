"""An axis of a tmcld as a Drivable of Frappy: docs/bridges/secop.md.

    Mod('x', 'tmcl_secop.Axis', 'a linear stage', axis='x', value=Param(unit='mm'))
"""

from __future__ import annotations

from collections.abc import Coroutine
from typing import Any

from frappy.core import Command, Drivable, Parameter, Property
from frappy.datatypes import EnumType, FloatRange, StringType
from frappy.errors import CommunicationFailedError, HardwareError, ImpossibleError, RangeError

import tmcl
from tmcl.aio import USUAL_TTL_S
from tmcl.bridge import BROKEN, LEASES, AxisChoice, Bridge, Choices, Follower

LOST = ("axis_lost", "not_connected", "connection_lost", "no_answer")
OUTSIDE = ("beyond_soft_limit", "out_of_range", "bad_argument")
HOLDING = EnumType("lease", **{name: number for number, name in enumerate(LEASES)})


class Axis(Drivable):
    """Nothing moves it but `target` changed by a client, and `home`."""

    axis = Property("name of the axis in tmcld", StringType())
    gateway = Property("socket or URL of tmcld; the usual socket if empty", StringType(), default="")
    lease = Property("for each move, or for the session", HOLDING, default="move")
    lease_ttl = Property(
        "seconds after which an axis stops whose server hangs",
        FloatRange(1, 60),
        default=USUAL_TTL_S,
    )

    value = Parameter("where it is", FloatRange(unit="microsteps"))
    target = Parameter("where it is to go", FloatRange(unit="$"), readonly=False)
    pollinterval = Parameter(default=0.2)

    follower: Follower

    def initModule(self) -> None:
        super().initModule()
        where = {"where": self.gateway} if self.gateway else {}
        choice = AxisChoice(self.axis, self.lease.name, {})
        self.bridge = Bridge(Choices(where, self.lease_ttl, (choice,)))
        self.follower = self.bridge.axes[self.axis]

    def writeInitParams(self) -> None:
        """A target in the configuration, or stored by Frappy, moves nothing."""
        self.writeDict.pop("target", None)
        super().writeInitParams()

    def doPoll(self) -> None:
        self.read_status()
        super().doPoll()

    def read_value(self) -> float:
        return self.in_unit("position")

    def read_target(self) -> float:
        return self.in_unit("target")

    def read_status(self) -> tuple[Any, str]:
        state, axis = self.follower.state, self.follower
        if state is None:
            return self.Status.ERROR, axis.trouble or "nothing is known of the axis"
        unit = state.unit or "microsteps"
        if self.parameters["value"].datatype.unit != unit:
            return self.Status.ERROR, f"the axis is in {unit}: say value=Param(unit='{unit}')"
        if BROKEN & set(state.faults):
            return self.Status.ERROR, f"the driver reports: {', '.join(state.faults)}"
        if state.latched:
            return self.Status.ERROR, "its module has started again: recover or home lets it move"
        if axis.busy:
            return self.Status.BUSY, "moving"
        if state.faults:
            return self.Status.WARN, f"the driver reports: {', '.join(state.faults)}"
        if state.stop_cause is not None:
            return self.Status.WARN, f"it stands short of its target: {state.stop_cause}"
        return self.Status.IDLE, ""

    def write_target(self, to: float) -> float:
        self.ask(self.follower.move(to))
        self.read_status()
        return to

    @Command()
    def stop(self) -> None:
        """ramps down; needs no lease"""
        self.ask(self.follower.stop())

    @Command()
    def home(self) -> None:
        """searches the reference"""
        self.ask(self.follower.home())
        self.read_status()

    @Command()
    def recover(self) -> None:
        """says that it may move again, whose module has started again"""
        self.ask(self.follower.recover())

    def in_unit(self, name: str) -> float:
        state = self.follower.state
        if state is None:
            raise CommunicationFailedError(self.follower.trouble or "nothing is known of the axis")
        said = getattr(state, name if state.unit is not None else f"{name}_microsteps")
        return float(said)

    def ask(self, work: Coroutine[Any, Any, None]) -> None:
        try:
            self.bridge.ask(work)
        except tmcl.Error as error:
            kind = HardwareError if error.outcome == "refused" else ImpossibleError
            if error.name in OUTSIDE:
                kind = RangeError
            elif error.name in LOST:
                kind = CommunicationFailedError
            raise kind(str(error)) from error
