"""Runs one of PyTrinamic's demos, which stays as it is, over a connection of our choice.

    demo.py FILE [PyTrinamic's connection options...]

Some demos ask for a PCAN adapter in their text; the options given here come before that. Curves
that a demo shows on a screen are drawn and thrown away.
"""

import os
import runpy
import sys

from pytrinamic.connections import ConnectionManager

os.environ["MPLBACKEND"] = "Agg"

demo, options = sys.argv[1], sys.argv[2:]
original = ConnectionManager.__init__


def connect_as_told(self, arg_list=None, connection_type="any"):
    original(self, options, connection_type)


ConnectionManager.__init__ = connect_as_told
runpy.run_path(demo, run_name="__main__")
