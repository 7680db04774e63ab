#!/usr/bin/env python3
"""An axis as a device of Bluesky, which needs no ophyd:

    from bluesky import RunEngine, plans
    axis = TmclAxis(tmcl.connect().x)
    RunEngine()(plans.scan([], axis, 0, 10, 11))

Bluesky's protocols are a matter of methods, not of base classes. Run by itself, this moves an axis
through them, as a plan would:

    bluesky_axis.py [SOCKET]
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import tmcl


class Status:
    """Whether something that was begun has ended, and how."""

    def __init__(self) -> None:
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
    """Movable, Readable, Locatable, Stoppable, Triggerable and Checkable."""

    parent = None

    def __init__(self, axis: tmcl.Axis, name: str | None = None) -> None:
        self.axis = axis
        self.name = name or axis.name
        self._units = axis.units()
        self._setpoint = axis.target

    @property
    def hints(self) -> dict[str, Any]:
        return {"fields": [self.name]}

    @property
    def position(self) -> float:
        return self.axis.position

    def set(self, value: float) -> Status:
        """A module takes the move before this returns; the status ends when the axis stands."""
        self._setpoint = value
        self.axis.move(value)
        status = Status()
        threading.Thread(target=self._await, args=(status,), daemon=True).start()
        return status

    def stop(self, *, success: bool = False) -> None:
        self.axis.stop()

    def trigger(self) -> Status:
        """A reading is taken when it is read."""
        status = Status()
        status.end()
        return status

    def locate(self) -> dict[str, float]:
        return {"setpoint": self._setpoint, "readback": self.position}

    def check_value(self, value: float) -> None:
        low, high = self._units.soft_limit_minimum, self._units.soft_limit_maximum
        if (low is not None and value < low) or (high is not None and value > high):
            raise ValueError(f"{self.name}: {value} is outside {low}..{high} {self._units.unit}")

    def read(self) -> dict[str, dict[str, Any]]:
        state, now = self.axis.state(), time.time()
        values = {"": state.position, "_velocity": state.velocity, "_setpoint": self._setpoint}
        return {self.name + key: {"value": said, "timestamp": now} for key, said in values.items()}

    def describe(self) -> dict[str, dict[str, Any]]:
        unit = self._units.unit
        units = {"": unit, "_velocity": f"{unit}/s", "_setpoint": unit}
        return {
            self.name + key: {
                "source": f"tmcld:{self.axis.name}",
                "dtype": "number",
                "shape": [],
                "units": said,
            }
            for key, said in units.items()
        }

    def read_configuration(self) -> dict[str, dict[str, Any]]:
        value = {"value": self.axis.get("max_velocity"), "timestamp": time.time()}
        return {f"{self.name}_max_velocity": value}

    def describe_configuration(self) -> dict[str, dict[str, Any]]:
        source = f"tmcld:{self.axis.name}/max_velocity"
        return {
            f"{self.name}_max_velocity": {"source": source, "dtype": "integer", "shape": []},
        }

    def _await(self, status: Status) -> None:
        try:
            self.axis.wait()
            status.end()
        except tmcl.Error as error:  # stopped on the way, for instance
            status.end(error)


def main() -> None:
    with tmcl.connect(*sys.argv[1:]) as gateway:
        axis = TmclAxis(gateway.x)
        for position in (2.0, 4.0):
            axis.check_value(position)
            axis.set(position).wait(30)
            axis.trigger().wait(1)
            print(axis.read())
        status = axis.set(1000.0)
        axis.stop()
        error = status.exception(30)
        assert isinstance(error, tmcl.Error) and error.name == "move_interrupted", error
        assert axis.read().keys() == axis.describe().keys()
        assert axis.read_configuration().keys() == axis.describe_configuration().keys()
        print(f"stopped at {axis.locate()['readback']:.3f} {gateway.x.units().unit}")


if __name__ == "__main__":
    main()
