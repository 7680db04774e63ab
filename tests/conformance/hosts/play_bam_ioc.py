"""Plays the board and motion control of an EPICS IOC for the TMCM-6214: play_bam_ioc.py HOST:PORT CHECKOUT FOLDER."""

import asyncio
import logging
import sys
import time
from pathlib import Path

from checks import check, finish

place, checkout, folder = sys.argv[1:4]
sys.path.insert(0, checkout)

from src.board_control import BoardControl  # noqa: E402
from src.board_parameters import BoardParameters  # noqa: E402
from src.configuration_management import ConfigurationManagement  # noqa: E402


def main():
    logging.disable(logging.CRITICAL)
    host, port = place.split(":")
    text = Path(checkout, "tests/testdata/example_config.yaml").read_text()
    configuration = Path(folder, "config.yaml")
    configuration.write_text(text.replace("192.168.0.253", host).replace("4016", port))
    parameters = BoardParameters()
    ConfigurationManagement.load_configuration(str(configuration), parameters)
    board = BoardControl(parameters)

    check("the board is initialized", board.initialize_board)
    check("the axes are initialized", board.initialize_axes)
    for _ in range(2):
        check("no power cycle", lambda: asyncio.run(board.check_if_powercycle_occurred()))
    check("the parameters of an axis are read", lambda: board.update_axis_parameters(0))

    def go(position):
        board.move_axis(0, position)
        time.sleep(0.05)
        asyncio.run(board.await_move_completion(0))
        return board.get_axis_single_parameter(0, "ActualPosition")

    check("move", lambda: go(50000), 50000)

    def calibrate():
        board.set_axis_parameters(0, [("ActualPosition", 1000), ("TargetPosition", 1000)])
        return board.get_axis_single_parameter(0, "ActualPosition")

    check("the position is set", calibrate, 1000)

    def stop():
        board.move_axis(0, 900000)
        time.sleep(0.4)
        board.stop_axis(0)
        time.sleep(1.5)
        return board.get_axis_single_parameter(0, "ActualVelocity")

    check("stop while it moves", stop, 0)
    finish()


main()
