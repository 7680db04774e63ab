"""An axis of a tmcld as an actuator of PyMoDAQ: docs/bridges/pymodaq.md."""

from __future__ import annotations

import os
import time
from collections.abc import Coroutine
from math import nan
from pathlib import Path
from typing import Any

from pymodaq.control_modules.move_utility_classes import (
    DAQ_Move_base,
    DataActuator,
    DataActuatorType,
    ThreadCommand,
    comon_parameters_fun,
)

import tmcl
from tmcl.bridge import ALARMING, Bridge, Choices, Follower

#: Which axes there are PyMoDAQ wants to know before it connects.
CONFIGURATION = Path(os.environ.get("TMCL_PYMODAQ", "/etc/tmcl/pymodaq.toml"))
CHOICES = Choices.read(CONFIGURATION)
#: So long the axes may take to be told of.
CONNECT_S = 5.0
PAUSE_S = 0.05
#: What pint calls a number without a unit.
NO_UNIT = ""
NOTHING = "nothing is known of the axis"
RECOVER = {"title": "Module:", "name": "recover", "type": "bool_push", "label": "Recover", "value": False}


class DAQ_Move_Tmcl(DAQ_Move_base):
    """Nothing moves it but move_abs, move_rel and move_home. Its controller is a Bridge with all axes
    of the configuration; slaves use that of their master."""

    _axis_names = [axis.name for axis in CHOICES.axes]
    is_multiaxes = len(_axis_names) > 1
    _controller_units = NO_UNIT
    #: Does not count: an axis has arrived when tmcld says so.
    _epsilon = 1.0
    data_actuator_type = DataActuatorType.DataActuator
    params = [RECOVER] + comon_parameters_fun(is_multiaxes, axis_names=_axis_names, epsilon=_epsilon)

    def ini_attributes(self) -> None:
        self.controller: Bridge | None = None
        self.told: str | None = None

    @property
    def axis(self) -> Follower:
        assert self.controller is not None
        return self.controller.axes[self.axis_name]

    def ini_stage(self, controller: Bridge | None = None) -> tuple[str, bool]:
        """Moves nothing. Returns what there is to say, and whether it may be used."""
        self.close()
        self.ini_stage_init(slave_controller=controller)
        if self.is_master:
            self.controller = Bridge(CHOICES)
        self.await_units()
        if self.axis.state is None:
            trouble = self.axis.trouble or NOTHING
            self.close()
            return trouble, False
        return f"axis '{self.axis_name}' of tmcld", True

    def await_units(self) -> None:
        """An axis that is lost now has none: it is to be initialized again when it is back."""
        assert self.controller is not None
        axes = [self.controller.axes[name] for name in self._axis_names]
        end = time.monotonic() + CONNECT_S
        while any(axis.state is None for axis in axes) and time.monotonic() < end:
            time.sleep(PAUSE_S)
        self.axis_units = [NO_UNIT if it.state is None else unit_of(it.state) for it in axes]
        self.axis_unit = self.axis_units[self._axis_names.index(self.axis_name)]

    def commit_settings(self, param: Any) -> None:
        if param.name() == "recover" and param.value():
            self.ask(self.axis.recover())

    def close(self) -> None:
        """tmcld stops what this has moved."""
        if self.controller is not None and self.is_master:
            self.controller.close()
        self.controller = None

    # ---- what moves --------------------------------------------------------------------------

    def move_abs(self, value: DataActuator) -> None:
        value = self.check_bound(value)
        self.target_value = value
        self.move_to(self.set_position_with_scaling(value))

    def move_rel(self, value: DataActuator) -> None:
        """From where it stands; from a moving axis it would be from anywhere."""
        self.current_value = self.get_actuator_value()
        value = self.check_bound(self.current_value + value) - self.current_value
        self.target_value = value + self.current_value
        self.move_to(self.set_position_with_scaling(self.target_value))

    def move_home(self, value: Any = None) -> None:
        self.ask(self.axis.home())
        self.start_time = time.perf_counter()
        self.poll_timer.start()

    def stop_motion(self) -> None:
        self.ask(self.axis.stop())
        self.move_done()

    def move_to(self, value: DataActuator) -> None:
        if (lost := self.lost()) is not None:
            self.fail(lost)
            raise RuntimeError(lost)
        self.ask(self.axis.move(value.value(self.axis_unit)))

    def ask(self, work: Coroutine[Any, Any, None]) -> None:
        """What tmcld refuses is an error for PyMoDAQ, too, which then waits for no end of it."""
        assert self.controller is not None
        try:
            self.controller.ask(work)
        except tmcl.Error as error:
            self.fail(str(error))
            raise

    # PyMoDAQ's own of these two add an offset without a unit, which its values refuse that have one.

    def get_position_with_scaling(self, pos: DataActuator) -> DataActuator:
        scaling = self.settings.child("scaling")
        return (pos - self.offset()) * scaling["scaling"] if scaling["use_scaling"] else pos

    def set_position_with_scaling(self, pos: DataActuator) -> DataActuator:
        scaling = self.settings.child("scaling")
        return pos / scaling["scaling"] + self.offset() if scaling["use_scaling"] else pos

    def offset(self) -> DataActuator:
        return DataActuator(self._title, data=self.settings["scaling", "offset"], units=self.axis_unit)

    # ---- what is told ------------------------------------------------------------------------

    def get_actuator_value(self) -> DataActuator:
        """Not a number where nothing is known that is new."""
        lost, state = self.lost(), self.axis.state
        self.tell(lost or self.warning())
        said = None
        if lost is None and state is not None:
            said = state.position if state.unit is not None else state.position_microsteps
        position = nan if said is None else float(said)
        made = DataActuator(self._title, data=position, units=self.axis_unit)
        return self.get_position_with_scaling(made)

    def check_target_reached(self) -> None:
        """Called by the timer of PyMoDAQ while it waits for the end of a movement."""
        self.current_value = self.get_actuator_value()
        self.emit_value(self.current_value)
        if (why := self.failure()) is not None:
            self.fail(why)
        elif not self.axis.busy:
            self.poll_timer.stop()
            self.move_done(self.current_value)
        elif time.perf_counter() - self.start_time >= self.settings["timeout"]:
            self.fail("it still moves")

    def failure(self) -> str | None:
        """Why the movement does not come to its end, if it does not."""
        if (lost := self.lost()) is not None:
            return lost
        if self.axis.busy:
            return None
        ended_by = self.axis.ended_by
        return self.warning() if ended_by is None else str(ended_by)

    def lost(self) -> str | None:
        """Why nothing is known of the axis, or not what it was."""
        state = self.axis.state
        if state is None:
            return self.axis.trouble or NOTHING
        if unit_of(state) != self.axis_unit:
            return f"the axis is in {unit_of(state) or 'microsteps'} now: initialize it again"
        return None

    def warning(self) -> str | None:
        state = self.axis.state
        if state is None:
            return None
        if state.faults:
            return f"the driver reports: {', '.join(state.faults)}"
        if state.latched:
            return "its module has started again: Recover, or a search of the reference, lets it move"
        if state.stop_cause in ALARMING and not self.axis.busy:
            return f"it stands short of its target: {state.stop_cause}"
        return None

    def fail(self, why: str) -> None:
        """No end of a movement comes any more; `raise_timeout` is how PyMoDAQ knows that."""
        self.poll_timer.stop()
        self.told = None
        self.tell(why)
        self.emit_status(ThreadCommand("raise_timeout"))

    def tell(self, trouble: str | None) -> None:
        """Once, and not at each look."""
        if trouble is not None and trouble != self.told:
            text = f"{self.axis_name}: {trouble}"
            self.emit_status(ThreadCommand("Update_Status", [text, "log"]))
        self.told = trouble


def unit_of(state: Any) -> str:
    return state.unit or NO_UNIT
