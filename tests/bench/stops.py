"""What the benchmarks of stops beside other load have in common."""
import os
import pathlib
import time

PAUSE_S = 0.005  # between two stops


def stops_for(gateway, seconds):
    """p50, p99 and the longest, in ms."""
    took = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        began = time.monotonic()
        gateway.x.stop()
        took.append((time.monotonic() - began) * 1000)
        time.sleep(PAUSE_S)
    took.sort()
    return took[len(took) // 2], took[len(took) * 99 // 100], took[-1]


def processor_s(process):
    fields = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
