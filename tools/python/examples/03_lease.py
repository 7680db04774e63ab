#!/usr/bin/env python3
"""Has an axis for itself for a while; what goes wrong has a name, an outcome and a hint:

    03_lease.py [SOCKET]
"""

import sys

import tmcl

with tmcl.connect(*sys.argv[1:]) as mine, tmcl.connect(*sys.argv[1:]) as other:
    with mine.lease("x"):
        mine.x.move(2)
        try:
            other.x.move(0)
        except tmcl.Error as error:
            print(f"{error.name}, {error.outcome}: {error.hint}")
            assert error.name == "leased" and error.outcome == "not_sent"
        mine.x.wait()
    other.x.move(0)
    other.x.wait()
    print("x is free again")
