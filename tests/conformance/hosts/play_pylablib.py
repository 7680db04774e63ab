"""Plays pyLabLib's classes for TMCM modules: play_pylablib.py MODEL PLACE [ADDRESS].

PLACE is a device, or HOST:PORT. Its class for several axes always uses address 0, which only modules on
USB answer.
"""

import sys
import time
from unittest.mock import MagicMock

# pyLabLib imports filters of scipy that its motors do not use, and Debian's scipy wants another Boost.
for name in ("", ".ndimage", ".signal", ".interpolate", ".optimize", ".linalg", ".special", ".integrate"):
    sys.modules["scipy" + name] = MagicMock()

from checks import check, finish, near  # noqa: E402
from pylablib.devices import Trinamic  # noqa: E402

MODES = (
    "lim_left lim_right_left lim_right_left_bothsides lim_left_bothsides lim_right lim_left_right "
    "lim_left_right_bothsides lim_right_bothsides home_neg_switch home_pos_switch home_pos home_neg "
    "home_neg_switch_inv home_pos_switch_inv home_pos_inv home_neg_inv"
).split()


def check_axis(stage, axis, address):
    where = {"axis": axis, "addr": address}
    label = f"axis {axis}: "
    check(label + "velocity parameters are read back",
          lambda: tuple(stage.setup_velocity(1000, 500, 32, 128, **where)), (1000, 500, 32, 128))
    check(label + "velocity factor", lambda: stage.get_velocity_factor(**where), near(7.629, 0.01))
    check(label + "microsteps", lambda: stage.set_microstep_resolution(64, **where), 64)
    check(label + "current", lambda: stage.setup_current(0.5, 0.1, **where)[0], near(0.5, 0.01))
    check(label + "switches", lambda: stage.setup_limit_switches(True, True, **where))
    for polarity in (True, False):
        check(label + f"polarity {polarity}", lambda: stage.set_switch_polarity(polarity, **where), polarity)
    check(label + "position reference", lambda: stage.set_position_reference(0, **where), 0)
    stage.setup_velocity(2047, 2047, 8, 32, **where)

    def arrive(move):
        move()
        time.sleep(0.05)
        stage.wait_move(**where)
        return stage.get_position(**where)

    check(label + "move_to", lambda: arrive(lambda: stage.move_to(4000, **where)), 4000)
    check(label + "move_by", lambda: arrive(lambda: stage.move_by(-1500, **where)), 2500)

    def jog():
        stage.jog("+", 300, **where)
        time.sleep(0.3)
        turning = stage.is_moving(**where)
        stage.stop(**where)
        time.sleep(0.5)
        return turning, stage.is_moving(**where)

    check(label + "jog and stop", jog, (True, False))
    check(label + "modes of the reference search",
          lambda: [stage.setup_home(mode, 500, 100, **where).mode for mode in MODES], MODES)

    def home():
        stage.setup_home("lim_left", 500, 100, **where)
        stage.home(timeout=25, **where)
        return abs(stage.get_position(**where)) < 5, stage.is_homing(**where)

    if address == 0:
        check(label + "reference search", home, (True, False))


def main():
    model, place = sys.argv[1:3]
    address = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    axes = int(model[5])
    stage = (Trinamic.TMCM1110 if axes == 1 else Trinamic.TMCMx110)((place, 9600))
    if axes > 1 and address == 0:
        check("axes found", lambda: len(stage._axes), axes)
    if address == 0:
        check("settings are applied", lambda: stage.apply_settings(stage.get_settings()))
    for axis in range(axes):
        check_axis(stage, axis, address)
    for bank in (0, 1, 2):
        check(f"input of bank {bank}", lambda: stage.get_general_input(0, bank, addr=address).status, 100)
    check("output", lambda: stage.set_general_output(True, 0, addr=address))
    check("store", lambda: stage.store_axis_parameter(4, addr=address))
    stage.close()
    finish()


main()
