"""What PyMoDAQ 4.4 gives to a plugin of an actuator, with its names and its signatures, without Qt: a
timer ticks when a test says so, and what a plugin emits is called at once."""

from enum import Enum
from time import perf_counter


class ThreadCommand:
    def __init__(self, command, attribute=None):
        self.command = command
        self.attribute = attribute


class DataActuatorType(Enum):
    float = 0
    DataActuator = 1


class DataActuator:
    """A number with a unit. Here a unit is converted to itself alone."""

    def __init__(self, name="actuator", *, data=0.0, units=""):
        self.name, self.data, self.units = name, data, units

    def value(self, units=None):
        assert units in (None, self.units), f"{self.units} to {units}"
        return float(self.data)

    def force_units(self, units):
        self.units = units

    def _made(self, data):
        return DataActuator(self.name, data=data, units=self.units)

    def _number(self, other):
        if isinstance(other, DataActuator):
            assert other.units == self.units, f"{self.units} and {other.units}"
            return other.data
        return other

    def _summand(self, other):
        assert isinstance(other, DataActuator) or not self.units, f"{self.units} and a number"
        return self._number(other)

    def __add__(self, other):
        return self._made(self.data + self._summand(other))

    def __sub__(self, other):
        return self._made(self.data - self._summand(other))

    def __mul__(self, factor):
        return self._made(self.data * factor)

    def __truediv__(self, factor):
        return self._made(self.data / factor)

    def __gt__(self, other):
        return self.data > self._number(other)

    def __lt__(self, other):
        return self.data < self._number(other)


class Signal:
    def __init__(self):
        self._slots = []

    def connect(self, slot):
        self._slots.append(slot)

    def emit(self, *said):
        for slot in self._slots:
            slot(*said)


class Timer:
    def __init__(self):
        self.timeout = Signal()
        self.is_active = False

    def start(self):
        self.is_active = True

    def stop(self):
        self.is_active = False

    def tick(self):
        if self.is_active:
            self.timeout.emit()


class Parameter:
    """A leaf, or a group of them."""

    def __init__(self, said):
        self.opts = said
        self._children = {it["name"]: Parameter(it) for it in said.get("children", ())}

    def name(self):
        return self.opts["name"]

    def value(self):
        return self.opts["value"]

    def setValue(self, value):
        self.opts["value"] = value

    def child(self, *names):
        return self._children[names[0]].child(*names[1:]) if names else self

    def __getitem__(self, names):
        return self.child(*([names] if isinstance(names, str) else names)).value()

    def __setitem__(self, names, value):
        self.child(*([names] if isinstance(names, str) else names)).setValue(value)


def group(name, *children):
    return {"name": name, "type": "group", "children": list(children)}


def leaf(name, value, **more):
    return {"name": name, "value": value, **more}


def comon_parameters_fun(is_multiaxes=False, axes_names=None, axis_names=(), master=True, epsilon=1.0):
    axes = leaf("axis", axis_names[0], limits=list(axis_names))
    status = leaf("multi_status", "Master" if master else "Slave")
    return [
        group("multiaxes", leaf("ismultiaxes", len(axis_names) > 1), status, axes),
        leaf("units", ""),
        leaf("epsilon", epsilon),
        leaf("timeout", 20),
        group("bounds", *map(leaf, ("is_bounds", "min_bound", "max_bound"), (False, 0.0, 1.0))),
        group("scaling", *map(leaf, ("use_scaling", "scaling", "offset"), (False, 1.0, 0.0))),
    ]


def copy_of(said):
    return {**said, "children": [copy_of(it) for it in said.get("children", ())]}


class DAQ_Move_base:
    """PyMoDAQ takes it for at its target within `epsilon` if `user_condition_to_reach_target` says so,
    too; a plugin may look at that by another `check_target_reached`."""

    _axis_names = None
    _controller_units = ""
    _epsilon = 1.0
    params = []
    data_actuator_type = DataActuatorType.float

    def __init__(self, parent=None, params_state=None):
        self.move_done_signal = Signal()
        self.move_is_done = False
        self.parent = parent
        self.controller = None
        self.ispolling = True
        self.settings = Parameter(copy_of(group("Settings", *self.params)))
        for names, value in (params_state or {}).items():
            self.settings[names] = value
        self._title = "myactuator" if parent is None else parent.title
        self.axis_units = [self._controller_units for _ in self._axis_names]
        self._current_value = self._target_value = DataActuator(self._title, units=self.axis_unit)
        self.poll_timer = Timer()
        self.poll_timer.timeout.connect(self.check_target_reached)
        self.ini_attributes()

    @property
    def axis_name(self):
        return self.settings["multiaxes", "axis"]

    @property
    def axis_unit(self):
        return self.axis_units[self._axis_names.index(self.axis_name)]

    @axis_unit.setter
    def axis_unit(self, unit):
        self.axis_units[self._axis_names.index(self.axis_name)] = unit
        self.settings["units"] = unit
        self.emit_status(ThreadCommand("units", unit))

    @property
    def is_master(self):
        return self.settings["multiaxes", "multi_status"] == "Master"

    @property
    def current_value(self):
        return self._current_value

    @current_value.setter
    def current_value(self, value):
        self._current_value = value

    @property
    def target_value(self):
        return self._target_value

    @target_value.setter
    def target_value(self, value):
        self._target_value = value

    def ini_stage_init(self, old_controller=None, new_controller=None, slave_controller=None):
        controller = new_controller
        if self.settings["multiaxes", "ismultiaxes"] and not self.is_master:
            controller = old_controller or slave_controller
            if controller is None:
                raise Exception("a slave has no controller")
        self.controller = controller
        return controller

    def check_bound(self, position):
        bounds = self.settings.child("bounds")
        if bounds["is_bounds"]:
            for is_out, name in ((position.__gt__, "max_bound"), (position.__lt__, "min_bound")):
                if is_out(bounds[name]):
                    position = DataActuator(self._title, data=bounds[name], units=self.axis_unit)
                    self.emit_status(ThreadCommand("outofbounds", []))
        return position

    def emit_status(self, status):
        if self.parent is not None:
            self.parent.status_sig.emit(status)

    def emit_value(self, pos):
        self.emit_status(ThreadCommand("get_actuator_value", [pos]))

    def move_done(self, position=None):
        position = self.get_actuator_value() if position is None else position
        self.move_done_signal.emit(position)
        self.move_is_done = True

    def poll_moving(self):
        self.start_time = perf_counter()
        if self.ispolling:
            self.poll_timer.start()
        else:
            self._current_value = self.get_actuator_value()
            self.move_done(self._current_value)

    def get_position_with_scaling(self, pos):
        scaling = self.settings.child("scaling")
        return (pos - scaling["offset"]) * scaling["scaling"] if scaling["use_scaling"] else pos

    def set_position_with_scaling(self, pos):
        scaling = self.settings.child("scaling")
        return pos / scaling["scaling"] + scaling["offset"] if scaling["use_scaling"] else pos

    def set_position_relative_with_scaling(self, pos):
        scaling = self.settings.child("scaling")
        return pos / scaling["scaling"] if scaling["use_scaling"] else pos
