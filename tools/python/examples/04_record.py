#!/usr/bin/env python3
"""Records a move into x.csv, and draws it in x.png where matplotlib is installed:

    04_record.py [SOCKET]
"""

import sys

import tmcl

with tmcl.connect(*sys.argv[1:]) as gateway:
    with gateway.record("x", interval=0.02) as recording:
        gateway.x.move_by(4)
        gateway.x.wait()

recording.write_csv("x.csv")
print(f"x.csv has {len(recording)} states; {recording.dropped} were missed")
try:
    recording.plot("x.png")
    print("x.png shows them")
except tmcl.Error as error:
    print(error.hint)
