#!/usr/bin/env python3
"""Axes of a tmcld as devices of Bluesky, which need no ophyd: docs/bridges/bluesky.md.

    from bluesky import RunEngine, plans
    x, = connect("x")
    RunEngine()(plans.scan([], x, 0, 10, 11))

Bluesky's protocols are a matter of methods, not of base classes. Run by itself, this moves an axis
through them, as a plan would:

    bluesky_axis.py [SOCKET]
"""

from __future__ import annotations

import asyncio
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import tmcl
from tmcl.bridge import ALARMING, AxisChoice, Bridge, Choices
from tmcl.systems import result_of

#: So long the axes may take to be told of.
CONNECT_S = 5.0
PAUSE_S = 0.05
MICROSTEPS = "microsteps"


def connect(
    *names: str, where: str | None = None, lease: str = "move", lease_ttl: float = 2.0
) -> list[TmclAxis]:
    """Moves nothing. Raises tmcl.Error if tmcld tells nothing of one of them."""
    choices = tuple(AxisChoice(name, lease, {}) for name in names)
    bridge = Bridge(Choices({} if where is None else {"where": where}, lease_ttl, choices))
    try:
        return [TmclAxis(bridge, name) for name in names]
    except tmcl.Error:
        bridge.close()
        raise


class Status:
    """Whether something that was begun has ended, and how."""

    def __init__(self) -> None:
        #: Its movement was stopped, which is not to count as a failure.
        self.is_excused = False
        self._ended = threading.Event()
        self._lock = threading.Lock()
        self._error: BaseException | None = None
        self._callbacks: list[Callable[[Status], None]] = []

    @property
    def done(self) -> bool:
        return self._ended.is_set()

    @property
    def success(self) -> bool:
        return self.done and self._error is None

    def exception(self, timeout: float | None = 0.0) -> BaseException | None:
        if not self._ended.wait(timeout):
            raise TimeoutError("it has not ended yet")
        return self._error

    def wait(self, timeout: float | None = None) -> None:
        if (error := self.exception(timeout)) is not None:
            raise error

    def add_callback(self, callback: Callable[[Status], None]) -> None:
        with self._lock:
            if not self.done:
                self._callbacks.append(callback)
                return
        callback(self)

    def end(self, error: BaseException | None = None) -> None:
        with self._lock:
            self._error = error
            self._ended.set()
        for callback in self._callbacks:
            callback(self)


class TmclAxis:
    """Movable, Readable, Configurable, Locatable, Stoppable and Checkable. Nothing moves it but set."""

    parent = None

    def __init__(self, bridge: Bridge, name: str) -> None:
        self.name = name
        self.bridge = bridge
        self.follower = bridge.axes[name]
        self.unit = self._await_unit()
        self._newest: Status | None = None

    @property
    def hints(self) -> dict[str, Any]:
        return {"fields": [self.name]}

    @property
    def position(self) -> float:
        return self._in_unit("position")

    def set(self, value: float) -> Status:
        """Returns at once. The status ends when the axis stands, and within 2 s when it is lost."""
        status = Status()
        self.bridge.begin(self._move(value, status))
        return status

    def stop(self, *, success: bool = False) -> None:
        """Needs no lease. `success`: the movement that it stops has not failed, as in a pause."""
        stopping = self.bridge.begin(self._stop(success))
        self._check_known()  # a RunEngine waits for this before it says what is lost
        result_of(stopping)

    def recover(self) -> None:
        """Says that it may move again, whose module has started again."""
        self.bridge.ask(self.follower.recover())

    def locate(self) -> dict[str, float]:
        return {"setpoint": self._in_unit("target"), "readback": self.position}

    def check_value(self, value: float) -> None:
        units = self.follower.units
        low, high = (units.soft_limit_minimum, units.soft_limit_maximum) if units else (None, None)
        if (low is not None and value < low) or (high is not None and value > high):
            raise ValueError(f"{self.name}: {value} is outside {low}..{high} {self.unit}")

    def read(self) -> dict[str, dict[str, Any]]:
        now = time.time()
        values = {"": self.position, "_setpoint": self._in_unit("target")}
        return {self.name + key: {"value": said, "timestamp": now} for key, said in values.items()}

    def describe(self) -> dict[str, dict[str, Any]]:
        said = {"source": f"tmcld:{self.name}", "dtype": "number", "shape": [], "units": self.unit}
        return {self.name: said, f"{self.name}_setpoint": {**said}}

    def read_configuration(self) -> dict[str, dict[str, Any]]:
        said = self.bridge.ask(self.follower.call("parameter.get", parameter="max_velocity"))
        return {f"{self.name}_max_velocity": {"value": said["value"], "timestamp": time.time()}}

    def describe_configuration(self) -> dict[str, dict[str, Any]]:
        source = f"tmcld:{self.name}/max_velocity"
        return {f"{self.name}_max_velocity": {"source": source, "dtype": "integer", "shape": []}}

    async def _stop(self, success: bool) -> None:
        if self._newest is not None:
            self._newest.is_excused = success
        await self.follower.stop()

    async def _move(self, value: float, status: Status) -> None:
        self._newest = status
        error: BaseException | None = None
        try:
            self._check_known()
            await self.follower.move(value)
            while self.follower.busy and self._lost() is None and self._newest is status:
                await asyncio.sleep(PAUSE_S)
            self._check_arrived(status)
        except tmcl.Error as failure:
            if not status.is_excused or self._lost() is not None:
                error = failure
        except asyncio.CancelledError as ending:
            error = ending
            raise
        finally:
            status.end(error)

    def _check_arrived(self, status: Status) -> None:
        self._check_known()
        if self._newest is not status:
            raise _error("superseded", f"axis '{self.name}' was moved elsewhere meanwhile")
        if self.follower.ended_by is not None:
            raise self.follower.ended_by
        cause = self.follower.state.stop_cause if self.follower.state else None
        if cause in ALARMING:
            raise _error("move_interrupted", f"axis '{self.name}' stands short of its target: {cause}")

    def _in_unit(self, name: str) -> float:
        self._check_known()
        state = self.follower.state
        return float(getattr(state, f"{name}_microsteps" if self.unit == MICROSTEPS else name))

    def _check_known(self) -> None:
        if (lost := self._lost()) is not None:
            raise _error("axis_lost", lost)

    def _lost(self) -> str | None:
        """Why nothing is known of the axis, or not what it was."""
        state = self.follower.state
        if state is None:
            return self.follower.trouble or f"nothing is known of axis '{self.name}'"
        if (state.unit or MICROSTEPS) != self.unit:
            return f"axis '{self.name}' is in {state.unit or MICROSTEPS} now: connect to it again"
        return None

    def _await_unit(self) -> str:
        end = time.monotonic() + CONNECT_S
        while (state := self.follower.state) is None:
            if time.monotonic() > end:
                raise _error("axis_lost", self.follower.trouble or "tmcld has told nothing of it")
            time.sleep(PAUSE_S)
        return state.unit or MICROSTEPS


def _error(name: str, message: str) -> tmcl.Error:
    return tmcl.Error(message, name=name, outcome="unknown")


def main() -> None:
    [axis] = connect("x", where=sys.argv[1] if len(sys.argv) > 1 else None)
    for position in (2.0, 4.0):
        axis.check_value(position)
        axis.set(position).wait(30)
        print(axis.read())
    status = axis.set(1000.0)
    while axis.locate()["readback"] == 4.0:
        time.sleep(PAUSE_S)
    axis.stop()
    error = status.exception(30)
    assert isinstance(error, tmcl.Error) and error.name == "move_interrupted", error
    assert axis.read().keys() == axis.describe().keys()
    assert axis.read_configuration().keys() == axis.describe_configuration().keys()
    print(f"stopped at {axis.position:.3f} {axis.unit}")
    axis.bridge.close()


if __name__ == "__main__":
    main()
