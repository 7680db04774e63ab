"""Plays the class behind a Tango server for the TMCM-6110: play_trinamic_control.py PLACE CHECKOUT FOLDER.

It is written for Python 2, and is translated by lib2to3.
"""

import subprocess
import sys
import time
from pathlib import Path

from checks import check, finish, near, until

READINGS = (
    "getMaxCurrent getPulseDivisor getMicrostepResolution getActualPosition getTargetSpeed getActualSpeed "
    "getTargetPosition getTargetPositionReached getRightLimitSwitch getRightLimitSwitchEnabled "
    "getLeftLimitSwitch getLeftLimitSwitchEnabled getRampDivisor getAcceleration getReferenceSearchStatus "
    "getActualMotorLoad getDriverErrorFlags"
).split()


def main():
    place, checkout, folder = sys.argv[1:4]
    name = "Trinamic_control6110.py"
    Path(folder, name).write_text(Path(checkout, "src", name).read_text(encoding="utf-8"))
    subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "lib2to3", "-w", "-n", f"{folder}/{name}"],
        check=True, capture_output=True,
    )
    sys.path.insert(0, folder)
    from Trinamic_control6110 import Trinamic_control6110

    control = Trinamic_control6110()
    if place.startswith("/"):
        control.connectRS485(place, 9600)
    else:
        host, port = place.split(":")
        control.connectTCP(host, int(port))
    for motor in (0, 4):
        for reading in READINGS:
            check(f"{reading}({motor})", lambda: getattr(control, reading)(motor))
        check(f"current of {motor}", lambda: (control.setMaxCurrent(0.8, motor), control.getMaxCurrent(motor))[1],
              near(0.8, 0.02))
        check(f"microsteps of {motor}",
              lambda: (control.setMicrostepResolution(64, motor), control.getMicrostepResolution(motor))[1], 64)
        check(f"acceleration of {motor}", lambda: control.setAcceleration(300, motor))

        def arrive():
            control.definePosition(0, motor)
            control.setTargetPosition(3000, motor)
            until(lambda: control.getTargetPositionReached(motor))
            return control.getActualPosition(motor)

        check(f"move of {motor}", arrive, 3000)
        check(f"position of {motor}",
              lambda: (control.definePosition(500, motor), control.getActualPosition(motor))[1], 500)
        check(f"stop of {motor}", lambda: control.stop(motor))

    def polarity(value):
        control.setLimitSwitchPolarity(value)
        time.sleep(0.05)

    # One bit for each three motors; it raises on any status but 100.
    for value in (0, 1, 0):
        check(f"switch polarity {value}", lambda: polarity(value))
    check("group of motors", lambda: control.groupMotors([0, 2], 5))
    control.close()
    finish()


main()
