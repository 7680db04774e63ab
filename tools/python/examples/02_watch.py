#!/usr/bin/env python3
"""Shows where an axis is while it moves:

    02_watch.py [SOCKET]
"""

import sys

import tmcl

with tmcl.connect(*sys.argv[1:]) as gateway:
    gateway.x.move(8)
    for state in gateway.watch("x", interval=0.1):
        print(f"{state.axis}: {state.position:.3f} {state.unit}, {state.velocity:.2f} {state.unit}/s")
        if state.position_reached and not state.moving:
            break
