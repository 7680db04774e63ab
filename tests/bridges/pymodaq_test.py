"""The plugin of PyMoDAQ beside a second client of tmcld: in PyMoDAQ's own DAQ_Move where Python finds
PyMoDAQ, else in a process that stands in for that."""

import importlib.util
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from bridge_bench import FAR, LONGEST_S, ROOT, BridgeTest, Faults, Hosted, freeze, until

import tmcl

PLUGIN = ROOT / "tools/python/examples/pymodaq"
STAND_IN = ROOT / "tests/bridges/without_pymodaq"
IN_PYMODAQ = ROOT / "tests/bridges/in_pymodaq.py"
IS_REAL = importlib.util.find_spec("pymodaq") is not None

# What DAQ_Move_Hardware does with a plugin: a command comes as a line of JSON, [name, ...], and all
# that the plugin emits goes out as one; the timer ticks in between.
HOST = """
import json, select, sys, traceback
from pymodaq.control_modules.move_utility_classes import DataActuator, Signal, ThreadCommand
from pymodaq_plugins_tmcl.daq_move_plugins import daq_move_Tmcl

def plain(said):
    return said.value() if isinstance(said, DataActuator) else said

def tell(name, said=None):
    said = [plain(it) for it in said] if isinstance(said, list) else said
    print(json.dumps([name, said]), flush=True)

class Hardware:
    title = "x"

    def __init__(self, settings):
        self.status_sig = Signal()
        self.status_sig.connect(lambda status: tell(status.command, status.attribute))
        self.hardware = daq_move_Tmcl.DAQ_Move_Tmcl(self, settings)
        self.hardware.move_done_signal.connect(lambda pos: tell("move_done", [pos]))

    def ini_stage(self):
        tell("ini_stage", list(self.hardware.ini_stage()))

    def get_actuator_value(self):
        tell("get_actuator_value", [self.hardware.get_actuator_value()])

    def move_abs(self, to):
        self.move(self.hardware.move_abs, to)

    def move_rel(self, by):
        self.move(self.hardware.move_rel, by)

    def move(self, how, value):
        self.hardware.move_is_done = False
        how(DataActuator("x", data=value, units=self.hardware.axis_unit))
        self.hardware.poll_moving()

    def move_home(self):
        self.hardware.move_is_done = False
        self.hardware.move_home()

    def stop_motion(self):
        self.hardware.stop_motion()
        self.hardware.poll_timer.stop()

    def set(self, path, value):
        parameter = self.hardware.settings.child(*path)
        parameter.setValue(value)
        self.hardware.commit_settings(parameter)

    def close(self):
        self.hardware.close()

hosted = Hardware({tuple(names): value for names, value in json.loads(sys.argv[1])})
while True:
    if select.select([sys.stdin], [], [], 0.05)[0]:
        line = sys.stdin.readline()
        if not line:
            break
        name, *said = json.loads(line)
        try:
            getattr(hosted, name)(*said)
        except Exception as error:
            tell("exception", f"{type(error).__name__}: {error}")
        tell("done", name)
    hosted.hardware.poll_timer.tick()
"""


HOSTED = [IN_PYMODAQ] if IS_REAL else ["-c", HOST]


def setUpModule():
    """PyMoDAQ finds the plugins that are installed."""
    path = [STAND_IN, PLUGIN]
    if IS_REAL:
        folder = tempfile.mkdtemp()
        unittest.addModuleCleanup(shutil.rmtree, folder)
        shutil.copytree(PLUGIN, f"{folder}/source")
        subprocess.run(
            [sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps",
             "--no-build-isolation", "--root-user-action", "ignore", "--target", f"{folder}/site", f"{folder}/source"], check=True,
        )
        path = [f"{folder}/site", os.environ["PYTHONPATH"]]
        os.environ["QT_QPA_PLATFORM"] = "offscreen"
    print(f"in {'PyMoDAQ' if IS_REAL else 'a stand-in of PyMoDAQ'}", file=sys.stderr)
    os.environ["PYTHONPATH"] = ":".join(map(str, [*path, ROOT / "tools/python"]))


class PymodaqTest(Hosted, BridgeTest):
    lease = "move"

    def setUp(self):
        super().setUp()
        self.configuration = self.bench.folder / "pymodaq.toml"
        self.configuration.write_text(f"""
            lease = "{self.lease}"
            [gateway]
            where = "{self.bench.socket}"
            [[axis]]
            name = "x"
            [[axis]]
            name = "y"
        """)
        os.environ["HOME"] = str(self.bench.folder)  # where PyMoDAQ writes its log
        os.environ["TMCL_PYMODAQ"] = str(self.configuration)
        self.start_host()

    def start_host(self, *settings):
        self.talk_to(*HOSTED, json.dumps(settings))
        until(self.is_initialized, lambda: f"it is initialized; it said {self.said}")

    def is_initialized(self):
        return ["ini_stage", True] in [
            [name, said[1]] for name, said in self.do("ini_stage") if name == "ini_stage"
        ]

    def value(self):
        said = [said for name, said in self.do("get_actuator_value") if name == "get_actuator_value"]
        return said[-1][0]

    def move(self, to, how="move_abs"):
        """As a person: asks again where it was not sent because the computer is busy."""

        def begun():
            wrong = [said for name, said in self.do(how, to) if name == "exception"]
            if wrong:
                again = ("stood still", "told nothing", "does not answer", "lease")
                self.assertTrue(any(word in wrong[0] for word in again), wrong)
            return not wrong

        until(begun, f"it takes {to}")

    def becomes_unknown(self):
        until(lambda: math.isnan(self.value()), "its value is none")

    def becomes_known(self):
        until(lambda: not math.isnan(self.value()), "it has a value again")

    def arrives(self, since):
        until(lambda: self.told("move_done", since), lambda: f"its end; {self.said[since:]}")
        return self.told("move_done", since)[-1][0]


class Told(PymodaqTest):
    def test_moves_where_it_is_told_and_no_earlier_says_that_it_has_arrived(self):
        self.assert_stays(0)
        before = len(self.said)
        self.move(2.5)
        self.assertEqual(self.arrives(before), 2.5)
        self.assertFalse(self.second.x.moving)
        self.assertEqual(self.second.x.position, 2.5)
        self.assertIn("mm", self.told("units"))
        until(lambda: self.second.x.state().lease is None, "the lease has ended")
        before = len(self.said)
        self.move(-1.0, "move_rel")
        self.assertEqual(self.arrives(before), 1.5)

    def test_bounds_and_scaling_are_those_of_pymodaq(self):
        self.do("set", ["bounds", "is_bounds"], True)
        self.do("set", ["bounds", "max_bound"], 3.0)
        self.do("set", ["scaling", "use_scaling"], True)
        self.do("set", ["scaling", "scaling"], 2.0)
        self.do("set", ["scaling", "offset"], 1.0)
        before = len(self.said)
        self.move(5.0)
        self.assertEqual(self.arrives(before), 3.0)
        self.assertEqual(self.second.x.position, 2.5)

    def test_a_refusal_is_no_end_of_a_move(self):
        before = len(self.said)
        said = self.do("move_abs", 1301.0)
        self.assertIn("soft limit", self.told("exception", before)[0])
        self.assertIn(["raise_timeout", None], said)
        self.assertFalse(self.told("move_done", before))
        self.assert_stays(0)

    def test_a_stop_needs_no_lease(self):
        with self.second.lease("x", ttl=LONGEST_S):
            self.second.x.move(FAR)
            self.do("stop_motion")
            self.assert_stays(self.stands())

    def test_a_move_that_another_client_stops_has_not_arrived(self):
        before = len(self.said)
        self.move(FAR)
        until(lambda: self.second.x.moving, "it moves")
        with self.assertRaises(tmcl.Error) as error:
            self.second.x.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.second.x.stop()
        until(lambda: self.told("raise_timeout", before), "it says so")
        self.assertFalse(self.told("move_done", before))
        self.assert_stays(self.stands())

    def test_searches_the_reference(self):
        self.second.x.set("reference_search_mode", 7)
        before = len(self.said)
        self.move(1.0)
        self.arrives(before)
        before = len(self.said)
        self.do("move_home")
        until(lambda: self.second.x.moving, "it searches")
        self.do("stop_motion")
        self.assert_stays(self.stands())

    def test_the_other_axis_is_another_actuator(self):
        self.do("close")
        self.end(self.host)
        self.start_host([["multiaxes", "axis"], "y"])
        before = len(self.said)
        self.move(1.0)
        self.assertEqual(self.arrives(before), 1.0)
        self.assertEqual((self.second.x.position, self.second.y.position), (0.0, 1.0))


class InSession(PymodaqTest):
    lease = "session"

    def test_no_other_client_moves_it_until_it_is_closed(self):
        until(lambda: self.second.x.state().lease, "the lease is taken")
        with self.assertRaises(tmcl.Error) as error:
            self.second.x.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.move(FAR)
        until(lambda: self.second.x.moving, "it moves")
        self.do("close")
        self.assert_stays(self.stands())
        until(lambda: self.second.x.state().lease is None, "the lease has ended")


class Broken(PymodaqTest):
    def test_a_killed_gateway_has_no_value_and_ends_a_move(self):
        before = len(self.said)
        self.move(FAR)
        self.bench.stop_daemon(kill=True)
        until(lambda: self.told("raise_timeout", before), "the move has failed")
        self.assertTrue(math.isnan(self.value()))
        self.do("move_abs", FAR)
        self.assertTrue(self.told("exception", before))
        self.bench.start_daemon()
        self.becomes_known()
        self.assert_stays(self.stands())
        self.assertFalse(self.told("move_done", before))

    def test_a_silent_bus_and_a_frozen_gateway_have_no_value(self):
        where = self.stands()
        for hold, resume in (
            (self.freeze_simulator, self.resume_simulator),
            (self.freeze_daemon, self.resume_daemon),
        ):
            with self.subTest(hold=hold.__name__):
                hold()
                self.becomes_unknown()
                resume()
                self.becomes_known()
                self.assert_stays(where)

    def test_a_program_that_dies_or_hangs_stops_what_it_has_moved(self):
        for hangs in (True, False):
            with self.subTest(hangs=hangs):
                self.move(FAR)
                until(lambda: self.second.x.moving, "it moves")
                if hangs:
                    freeze(self.host.pid)
                    where = self.stands()
                    self.host.send_signal(signal.SIGCONT)
                    self.becomes_known()
                else:
                    self.end(self.host)
                    where = self.stands()
                    self.start_host()
                self.assert_stays(where)


class Rounds(PymodaqTest, Faults):
    start_bridge = PymodaqTest.start_host
    set_off = PymodaqTest.move
    wait_for_loss = PymodaqTest.becomes_unknown
    wait_until_back = PymodaqTest.becomes_known
    wait_until_well = PymodaqTest.becomes_known

    def stop(self):
        self.do("stop_motion")


if __name__ == "__main__":
    unittest.main()
