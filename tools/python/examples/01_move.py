#!/usr/bin/env python3
"""Moves an axis, and waits for it:

    01_move.py [SOCKET]
"""

import sys

import tmcl

with tmcl.connect(*sys.argv[1:]) as gateway:
    started = gateway.x.move(4)  # mm, as the configuration says
    print(f"it will take {started.predicted_s:.2f} s")
    gateway.x.wait()
    print(f"x stands at {gateway.x.position} mm")

    gateway["x"].move_by("-1 rev")  # a text has its unit with it
    gateway["x"].wait(timeout=30)
    print(f"x stands at {gateway.x.position} mm")
