"""States of axes over time: as CSV, or as a picture where matplotlib is installed."""

from __future__ import annotations

import csv
import datetime
import importlib
import os
from collections.abc import Iterator
from typing import Any

from .errors import NOT_SENT, Error
from .methods import WatchedState

MOST_STATES = 1_000_000
COLUMNS = (
    "time_s",
    "utc",
    "axis",
    "unit",
    "position",
    "velocity",
    "target",
    "position_microsteps",
    "velocity_pps",
    "target_microsteps",
    "moving",
)


class Recording:
    """What was seen of some axes: `states`, and when, in UTC, each of them came (`utc`).

    Times are the daemon's (`event_time_ms`, monotonic); `time_s` counts from the first state."""

    def __init__(self) -> None:
        self.states: list[WatchedState] = []
        self.utc: list[datetime.datetime] = []
        #: So many states were missed, because too many came.
        self.dropped = 0

    def add(self, state: WatchedState) -> None:
        if len(self.states) >= MOST_STATES:
            self.dropped += 1
            return
        self.states.append(state)
        self.utc.append(datetime.datetime.now(datetime.timezone.utc))

    def __len__(self) -> int:
        return len(self.states)

    def of(self, axis: str) -> list[WatchedState]:
        return [state for state in self.states if state.axis == axis]

    def rows(self) -> Iterator[list[Any]]:
        """One for each state, with COLUMNS."""
        for state, utc in zip(self.states, self.utc, strict=True):
            time_s = (state.event_time_ms - self.states[0].event_time_ms) / 1000
            when = utc.isoformat(timespec="milliseconds").replace("+00:00", "Z")
            yield [time_s, when, *(getattr(state, name) for name in COLUMNS[2:])]

    def write_csv(self, file: str | os.PathLike[str]) -> None:
        with open(file, "w", newline="", encoding="utf-8") as text:
            writer = csv.writer(text)
            writer.writerow(COLUMNS)
            writer.writerows(self.rows())

    def plot(self, file: str | os.PathLike[str] | None = None) -> Any:
        """Position and velocity of each axis over time, as a figure of matplotlib; written to
        `file` (.png, .svg, .pdf) if that is named. Raises Error "no_matplotlib"."""
        try:
            figures = importlib.import_module("matplotlib.figure")
        except ImportError:
            raise Error(
                "matplotlib is not installed",
                name="no_matplotlib",
                outcome=NOT_SENT,
                hint="'apt install python3-matplotlib' brings it; write_csv() needs nothing",
            ) from None
        figure = figures.Figure(figsize=(8, 5), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True)
        for axis in dict.fromkeys(state.axis for state in self.states):
            self._draw(axis, above, below)
        above.set_ylabel("position")
        below.set_ylabel("velocity")
        below.set_xlabel("seconds")
        if self.states:
            above.legend()
        if file is not None:
            figure.savefig(os.fspath(file))
        return figure

    def _draw(self, axis: str, above: Any, below: Any) -> None:
        states = self.of(axis)
        unit = states[0].unit
        times = [(s.event_time_ms - self.states[0].event_time_ms) / 1000 for s in states]
        where = [s.position_microsteps if unit is None else s.position for s in states]
        speed = [s.velocity_pps if unit is None else s.velocity for s in states]
        above.plot(times, where, label=f"{axis} ({unit or 'microsteps'})")
        below.plot(times, speed)
