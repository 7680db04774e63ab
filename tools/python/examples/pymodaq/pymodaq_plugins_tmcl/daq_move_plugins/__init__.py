"""What PyMoDAQ finds here: the modules beside `path`."""

from pathlib import Path

from . import daq_move_Tmcl as daq_move_Tmcl

path = Path(__file__)
