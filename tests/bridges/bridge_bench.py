"""What tests of bridges share: a bench, a bridge as a process, and waiting for what is to be."""

import os
import pathlib
import signal
import socket
import subprocess
import time
import unittest

from tmcl.testing import Bench

ROOT = pathlib.Path(__file__).parents[2]
#: So long anything may take on a busy computer.
LONGEST_S = 60.0
PAUSE_S = 0.02
#: So often an axis is looked at before it counts as one that stays where it is.
LOOKS = 20


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, what):
    """Waits; what raises is not so yet. `what` is a text, or makes one."""
    end = time.monotonic() + LONGEST_S
    why = "never"
    while time.monotonic() < end:
        try:
            if found := condition():
                return found
        except AssertionError:
            raise
        except Exception as error:
            why = error
        time.sleep(PAUSE_S)
    what = what() if callable(what) else what
    raise AssertionError(f"not within {LONGEST_S:g} s: {what} ({why})")


def freeze(pid):
    """Returns when no thread of it runs any more."""
    os.kill(pid, signal.SIGSTOP)

    def frozen():
        threads = pathlib.Path(f"/proc/{pid}/task").glob("*/stat")
        return all(thread.read_text().rpartition(")")[2].split()[0] == "T" for thread in threads)

    until(frozen, f"process {pid} is frozen")


class BridgeTest(unittest.TestCase):
    """A bench with the axes x and y, a second client of tmcld, and processes that end with the test."""

    keys = {"unit": "mm", "units_per_revolution": 8.0}
    axes = {"x": {"soft_limits": [-100, 1300]}, "y": {}}

    def setUp(self):
        self.bench = self.enterContext(Bench("TMCM-3110", axes=self.axes, **self.keys))
        self.second = self.enterContext(self.bench.connect(patience=LONGEST_S))
        self.addCleanup(self.resume_simulator)

    def start(self, *command, **more):
        with open(self.bench.folder / "bridge.log", "ab") as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, env=os.environ, **more)
        self.addCleanup(self.end, process)
        return process

    def end(self, process, number=signal.SIGKILL):
        if process.poll() is None:
            process.send_signal(number)
            process.send_signal(signal.SIGCONT)
        process.wait(LONGEST_S)

    def freeze_simulator(self):
        freeze(self.bench._simulator.pid)

    def resume_simulator(self):
        os.kill(self.bench._simulator.pid, signal.SIGCONT)

    def freeze_daemon(self):
        freeze(self.bench.daemon_pid)

    def resume_daemon(self):
        os.kill(self.bench.daemon_pid, signal.SIGCONT)

    def stands(self, axis="x"):
        """Where the axis stands, once it does."""
        until(lambda: not self.second.axis(axis).state().moving, f"{axis} stands")
        return self.second.axis(axis).state().position_microsteps

    def assert_stays(self, where, axis="x"):
        for _ in range(LOOKS):
            state = self.second.axis(axis).state()
            self.assertFalse(state.moving)
            self.assertEqual(state.position_microsteps, where)
            time.sleep(PAUSE_S)
