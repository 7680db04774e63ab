"""Uses one of PyTrinamic's module classes for all it has: every axis parameter and every global
parameter that it names is read, every motor is turned, stopped, and sent to a position.

    classes.py MODEL [PyTrinamic's connection options...]

Prints what it did, and complaints; the exit status is 0 if there were none.
"""

import importlib
import re
import sys
import time

from pytrinamic.connections import ConnectionManager

ARRIVAL_S = 20.0
MOVE = 2000
MAX_VELOCITY = 4  # whatever the class calls it


def constants(holder):
    """The names and numbers in one of PyTrinamic's lists."""
    return {k: v for k, v in vars(holder).items() if not k.startswith("_") and isinstance(v, int)}


def reason(error):
    """PyTrinamic tells a whole reply, a field a line."""
    status = re.search(r"Status: (.*)", str(error))
    return status[1] if status else f"{type(error).__name__} {error}"


def read_axis(motor, complaints):
    for name, number in constants(motor.AP).items():
        try:
            motor.get_axis_parameter(number)
        except Exception as error:
            complaints.append(f"axis parameter {number} {name}: {reason(error)}")
    return len(constants(motor.AP))


def read_globals(module, complaints):
    total = 0
    for bank, holder in enumerate(("GP0", "GP1", "GP2", "GP3")):
        numbers = constants(getattr(module, holder, object))
        total += len(numbers)
        for name, number in numbers.items():
            try:
                module.connection.get_global_parameter(number, bank, module.module_id)
            except Exception as error:
                complaints.append(f"GP {number} of bank {bank}, {name}: {reason(error)}")
    return total


def wait_until(condition, seconds):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return True
        time.sleep(0.01)
    return False


def move(motor, axis, complaints):
    speed = motor.get_axis_parameter(MAX_VELOCITY) // 2
    motor.rotate(speed)
    if not wait_until(lambda: motor.actual_velocity == speed, ARRIVAL_S):
        complaints.append(f"motor {axis}: turns at {motor.actual_velocity}, not at {speed}")
    motor.stop()
    if not wait_until(lambda: motor.actual_velocity == 0, ARRIVAL_S):
        complaints.append(f"motor {axis}: was stopped and turns at {motor.actual_velocity}")
    target = motor.actual_position + MOVE
    motor.move_to(target)
    if not wait_until(lambda: motor.actual_position == target, ARRIVAL_S):
        complaints.append(f"motor {axis}: stands at {motor.actual_position}, not at {target}")
    motor.move_by(-MOVE)
    if not wait_until(lambda: motor.actual_position == target - MOVE, ARRIVAL_S):
        complaints.append(f"motor {axis}: stands at {motor.actual_position}, not at {target - MOVE}")


def main():
    model, options = sys.argv[1], sys.argv[2:]
    name = model.replace("-", "")
    complaints = []
    with ConnectionManager(options).connect() as connection:
        module = getattr(importlib.import_module(f"pytrinamic.modules.{name}"), name)(connection)
        parameters = sum(read_axis(motor, complaints) for motor in module.motors)
        global_parameters = read_globals(module, complaints)
        for axis, motor in enumerate(module.motors):
            move(motor, axis, complaints)
    print(
        f"{len(module.motors)} motors, {parameters} axis parameters, "
        f"{global_parameters} global parameters"
    )
    for sentence in complaints:
        print(f"  {sentence}")
    sys.exit(1 if complaints else 0)


main()
