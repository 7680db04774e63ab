"""What tests of bridges share: a bench, a bridge as a process, and waiting for what is to be."""

import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest

from tmcl.testing import Bench

ROOT = pathlib.Path(__file__).parents[2]
#: So long anything may take on a busy computer.
LONGEST_S = 60.0
PAUSE_S = 0.02
#: So often an axis is looked at before it counts as one that stays where it is.
LOOKS = 20
#: Where a test moves to: it takes minutes to get there.
FAR = 1200.0
#: So often each fault comes in the middle of a move.
ROUNDS = int(os.environ.get("TMCL_ROUNDS", "2"))


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
            process = subprocess.Popen(command, **{"stdout": log, "stderr": log, **more})
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


class Hosted:
    """For a BridgeTest: `host`, a process that is told to do something by a line of JSON, [name, ...], and
    that tells what happens by such lines, and ["done", name] at the end of each."""

    def talk_to(self, *command):
        pipes = dict.fromkeys(("stdin", "stdout"), subprocess.PIPE)
        self.host = self.start(sys.executable, *command, text=True, **pipes)
        self.addCleanup(self.host.stdin.close)
        self.said = []
        threading.Thread(target=self.listen, args=(self.host, self.said), daemon=True).start()

    def listen(self, host, said):
        with host.stdout:
            for line in host.stdout:
                said.append(json.loads(line))

    def do(self, name, *said):
        """What it told meanwhile."""
        before = len(self.said)
        self.host.stdin.write(json.dumps([name, *said]) + "\n")
        self.host.stdin.flush()
        until(lambda: ["done", name] in self.said[before:], f"{name} is done")
        return self.said[before:]

    def told(self, what, since=0):
        return [said for name, said in self.said[since:] if name == what]

    @property
    def bridge(self):
        return self.host


class Faults:
    """For a BridgeTest: nothing that breaks in a move moves anything afterwards. The test has
    `bridge`, a process, and `start_bridge`; `set_off(to)`, which returns when the move was taken;
    `wait_for_loss`, until the control system says that nothing is known; `wait_until_back`, until it
    does not; `stop`, as a person would; and `wait_until_well`, until there is no fault any more."""

    def test_no_fault_in_a_move_moves_anything_afterwards(self):
        seed = int(os.environ.get("TMCL_SEED", random.randrange(10**6)))
        print(f"TMCL_SEED={seed}", file=sys.stderr)
        choose = random.Random(seed)
        done = dict.fromkeys(self.faults(), 0)
        for _ in range(ROUNDS):
            for fault in choose.sample(list(done), len(done)):
                with self.subTest(fault=fault, before=dict(done)):
                    self.break_a_move(fault, choose)
                    done[fault] += 1
        print(f"nothing moved afterwards: {done}", file=sys.stderr)

    def faults(self):
        return {
            "kill bridge": self.kill_bridge,
            "freeze bridge": self.freeze_bridge,
            "kill tmcld": self.kill_daemon,
            "freeze tmcld": lambda: self.lose(self.freeze_daemon, self.resume_daemon),
            "cut bus": lambda: self.lose(self.freeze_simulator, self.resume_simulator),
        }

    def break_a_move(self, fault, choose):
        where = self.second.x.position
        low = where > 0 and choose.random() < 0.5
        self.set_off(-90 + choose.random() if low else FAR - choose.random())
        until(lambda: abs(self.second.x.position - where) > choose.random(), "it is on its way")
        self.faults()[fault]()
        self.wait_until_well()
        self.assert_stays(self.stands())

    def kill_bridge(self):
        self.end(self.bridge)
        self.start_bridge()

    def freeze_bridge(self):
        freeze(self.bridge.pid)
        self.stands()
        self.bridge.send_signal(signal.SIGCONT)

    def kill_daemon(self):
        self.bench.stop_daemon(kill=True)
        self.wait_for_loss()
        self.bench.start_daemon()

    def lose(self, hold, resume):
        hold()
        self.wait_for_loss()
        resume()
        self.wait_until_back()
        self.stop()
