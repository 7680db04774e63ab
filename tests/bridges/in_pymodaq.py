"""An actuator in PyMoDAQ's own DAQ_Move, with its window. A command comes as a line of JSON, [name,
...], and all that PyMoDAQ is told goes out as one."""

import json
import logging
import os
import sys

from pymodaq.control_modules.daq_move import DAQ_Move
from pymodaq.control_modules.move_utility_classes import DataActuator
from qtpy.QtCore import QObject, QSocketNotifier, Signal, Slot
from qtpy.QtWidgets import QApplication, QWidget

OUT = os.dup(1)
os.dup2(2, 1)  # what else is printed goes to the log


def plain(said):
    if isinstance(said, DataActuator):
        return said.value()
    return said if isinstance(said, (str, float, int, bool, type(None))) else repr(said)


def tell(name, said=None):
    if isinstance(said, DataActuator):  # PyMoDAQ 5 tells it without a list
        said = [said]
    said = [plain(it) for it in said] if isinstance(said, (list, tuple)) else plain(said)
    os.write(OUT, json.dumps([name, said]).encode() + b"\n")  # whole, from whichever thread


class Errors(logging.Handler):
    """What a plugin raises, PyMoDAQ writes to its log alone."""

    def emit(self, record):
        if record.exc_info:
            kind, error, _ = record.exc_info
            tell("exception", f"{kind.__name__}: {error}")


class Echo(QObject):
    """Lives in the thread of the plugin: what was commanded before it is asked has been done."""

    asked = Signal(str)
    answered = Signal(str)

    def __init__(self):
        super().__init__()
        self.asked.connect(self.answer)

    @Slot(str)
    def answer(self, name):
        self.answered.emit(name)


class Host(QObject):
    def __init__(self, settings):
        super().__init__()
        self.settings = settings
        self.start_module()
        self.lines = QSocketNotifier(sys.stdin.fileno(), QSocketNotifier.Read)
        self.lines.activated.connect(self.take)
        self.rest = b""

    def start_module(self):
        self.window = QWidget()
        self.module = DAQ_Move(self.window, title="x")
        self.module.actuator = "Tmcl"
        self.module.custom_sig.connect(self.status)
        self.module.init_signal.connect(self.initialized)
        for names, value in self.settings:
            self.set(names, value)

    @Slot()
    def take(self):
        read = os.read(sys.stdin.fileno(), 65536)
        if not read:
            QApplication.quit()
        *lines, self.rest = (self.rest + read).split(b"\n")
        for line in lines:
            name, *said = json.loads(line)
            getattr(self, name)(*said)
            if name not in ("ini_stage", "close"):
                self.echo.asked.emit(name)

    def status(self, status):
        if status.command != "ini_stage":
            tell(status.command, status.attribute)

    def initialized(self, is_so):
        if is_so:
            self.echo = Echo()
            self.echo.answered.connect(lambda name: tell("done", name))
            self.echo.moveToThread(self.module._hardware_thread)
        tell("ini_stage", ["", is_so])
        tell("done", "ini_stage" if is_so else "close")

    def ini_stage(self):
        self.module.init_hardware(True)

    def get_actuator_value(self):
        self.module.get_actuator_value()

    def move_abs(self, to):
        self.module.move_abs(to)

    def move_rel(self, by):
        self.module.move_rel(by)

    def move_home(self):
        self.module.move_home()

    def stop_motion(self):
        self.module.stop_motion()

    def set(self, path, value):
        self.module.settings.child("move_settings", *path).setValue(value)

    def close(self):
        self.module.init_hardware(False)


app = QApplication([])
logging.getLogger("pymodaq").addHandler(Errors())
host = Host(json.loads(sys.argv[1]))
app.exec_()
