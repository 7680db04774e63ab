"""tmcl-ioc as a process, with caproto's own client, beside a second client of the same tmcld."""

import os
import pathlib
import signal
import sys
import time
import unittest
from importlib.util import find_spec

if find_spec("caproto") is None:
    print("skipped: Python has no caproto, nor has Debian; PYTHONPATH may name its folder")
    sys.exit(0)

from bridge_bench import FAR, LONGEST_S, LOOKS, PAUSE_S, ROOT
from bridge_bench import BridgeTest, Faults, free_port, freeze, until
from caproto import AlarmSeverity, ErrorResponseReceived
from caproto.sync.client import read, write

IOC = ROOT / "tools/bridges/epics/tmcl-ioc"
#: A search that was lost is sent once more after half of that.
READ_S = 2.0
NOT_SENT = ("axis_lost", "stale_request", "no_answer", "lease_lost", "not_connected")
#: A client that holds a field at 1 for as long as it runs, as a button on a screen does.
HOLDER = """
import sys
from caproto.threading.client import Context
field, = Context().get_pvs(sys.argv[1], timeout=None)
field.wait_for_connection(timeout=None)
field.write(1, wait=False)
sys.stdin.read()
"""

#: One that waits until what it has set off has ended, and fails where the IOC says an error.
WAITER = """
import sys
from caproto.sync.client import write
write(sys.argv[1], 1, notify=True, timeout=60, repeater=False)
"""


class EpicsTest(BridgeTest):
    def setUp(self):
        super().setUp()
        self.configuration = self.bench.folder / "ioc.toml"
        self.configuration.write_text(f"""
            [gateway]
            where = "{self.bench.socket}"
            [[axis]]
            name = "x"
            record = "test:x"
            [[axis]]
            name = "y"
            record = "test:y"
        """)
        self.port = free_port()
        os.environ.update(
            EPICS_CA_ADDR_LIST="127.0.0.1",
            EPICS_CA_AUTO_ADDR_LIST="NO",
            EPICS_CA_SERVER_PORT=str(self.port),
            EPICS_CA_REPEATER_PORT=str(free_port()),
            EPICS_CAS_INTF_ADDR_LIST="127.0.0.1",
            EPICS_CAS_BEACON_ADDR_LIST="127.0.0.1",
            EPICS_CAS_AUTO_BEACON_ADDR_LIST="NO",
        )
        self.start_ioc()

    def start_ioc(self):
        self.ioc = self.start(IOC, "--config", self.configuration)
        self.wait_for("NO_ALARM")

    def hold(self, field, axis="x"):
        pipe = os.pipe()
        self.addCleanup(os.close, pipe[1])
        holder = self.start(sys.executable, "-c", HOLDER, f"test:{axis}.{field}", stdin=pipe[0])
        os.close(pipe[0])
        return holder

    def read(self, field, axis="x", **more):
        name = f"test:{axis}.{field}"
        return until(lambda: read(name, timeout=READ_S, repeater=False, **more), f"{name} is read")

    def get(self, field, axis="x"):
        said = self.read(field, axis).data[0]
        return said.decode() if isinstance(said, bytes) else said

    def put(self, field, value, axis="x", wait=True, **more):
        name = f"test:{axis}.{field}"
        write(name, value, notify=wait, timeout=LONGEST_S, repeater=False, **more)

    def wait_for(self, *severities, axis="x"):
        until(lambda: self.get("SEVR", axis) in severities, lambda: f"one of {severities}")

    def refused_once(self, field, value, **more):
        with self.assertRaises(ErrorResponseReceived) as caught:
            self.put(field, value, **more)
        return str(caught.exception.args[0].error_message)

    def refused(self, field, value, **more):
        """As a person: asks again where the IOC stood still because the computer is busy."""

        def reason():
            said = self.refused_once(field, value, **more)
            return said if "stale_request" not in said else None

        return until(reason, "the IOC is awake")

    def move(self, to, field="VAL", axis="x"):
        """As a person: asks again where it was not sent because the computer is busy."""

        def done():
            try:
                self.put(field, to, axis)
            except ErrorResponseReceived as error:
                said = str(error.args[0].error_message)
                self.assertTrue(any(name in said for name in NOT_SENT), said)
                return False
            return True

        until(done, f"{field} takes {to}")

    def set_off(self, to=FAR, axis="x"):
        """Returns when it is on its way."""

        def begun():
            self.put("VAL", to, axis, wait=False)
            for _ in range(LOOKS):
                if self.second.axis(axis).state().moving:
                    return True
                time.sleep(PAUSE_S)
            return False

        until(begun, f"it is on its way to {to}")


class Told(EpicsTest):
    def test_a_put_with_callback_ends_when_it_stands_there(self):
        self.assert_stays(0)
        self.move(2.5)
        self.assertEqual(self.second.x.position, 2.5)
        said = [self.get(field) for field in ("RBV", "VAL", "DVAL", "DMOV")]
        self.assertEqual(said, [2.5, 2.5, 2.5, 1])
        self.assertEqual(self.get("DESC"), "axis x of tmcld")

    def test_fields_follow_and_a_stop_ends_a_move(self):
        self.set_off()
        until(lambda: self.get("RBV") > 1, "RBV follows")
        self.assertEqual([self.get(field) for field in ("DMOV", "MOVN", "VAL")], [0, 1, FAR])
        self.assertTrue(self.get("MSTA") & 0x400)
        self.put("STOP", 1)
        until(lambda: self.get("DMOV") == 1, "it stands")
        self.assert_stays(self.stands())
        until(lambda: self.get("RBV") == self.second.x.position, "RBV is where it stands")
        self.assertEqual(self.get("VAL"), self.get("RBV"))
        until(lambda: self.second.x.state().lease is None, "the lease has ended")

    def test_small_steps_begin_where_it_stands(self):
        self.move(1.0)
        self.put("TWV", 0.5)
        self.move(1, "TWF")
        self.assertEqual(self.get("RBV"), 1.5)
        self.move(1, "TWR")
        self.assertEqual(self.get("RBV"), 1.0)
        self.set_off()
        self.assertIn("it moves", self.refused("RLV", 1.0))
        self.put("STOP", 1)
        until(lambda: self.get("DMOV") == 1, "it stands")
        where = self.second.x.position
        self.move(-0.5, "RLV")
        self.assertAlmostEqual(self.second.x.position, where - 0.5, 2)

    def test_fields_have_units_and_limits(self):
        self.assertEqual([self.get(field) for field in ("EGU", "LLM", "HLM")], ["mm", -100, 1300])
        control = self.read("VAL", data_type="control").metadata
        self.assertEqual((control.lower_ctrl_limit, control.upper_ctrl_limit), (-100, 1300))
        self.assertEqual(control.units, b"mm")
        self.assertIn("beyond_soft_limit", self.refused("VAL", 1301.0))
        self.assertEqual([self.get(field, "y") for field in ("LLM", "HLM")], [0, 0])

    def test_velocities_are_those_of_the_module(self):
        self.put("VELO", 4.0)
        self.put("ACCL", 0.5)
        self.assertAlmostEqual(self.get("VELO"), 4.0, 1)
        self.assertAlmostEqual(self.get("ACCL"), 0.5, 0)
        self.second.x.set("max_velocity", self.second.x.get("max_velocity") // 2)
        self.assertAlmostEqual(self.get("VELO"), 2.0, 1)
        for field in ("VELO", "ACCL"):
            for value in (0.0, -1.0):
                self.refused(field, value)
        self.refused("VELO", 1e9)

    def test_nonsense_is_refused_and_moves_nothing(self):
        self.move(1.0)
        where = self.stands()
        for field in ("VAL", "DVAL", "RLV", "TWV", "VELO", "ACCL", "JOGF", "HOMF", "TWF"):
            for value in (float("nan"), float("inf"), -float("inf")):
                self.assertIn(f"test:x.{field}", self.refused(field, value, data_type=6))
        for field, text in (("VAL", "nan"), ("VAL", "inf"), ("RLV", "-inf"), ("SPMG", "<b>Go</b>")):
            self.refused(field, text, data_type=0)
        for text in ("<script>alert(1)</script>", "", "1 2", "0x10", "%n"):
            for field in ("VAL", "JOGF"):
                with self.assertRaises((ErrorResponseReceived, ValueError)):
                    self.put(field, [text.encode()], data_type=0)
        wrong = {"JOGF": 7, "STOP": 2, "SPMG": 9, "CNEN": 0, "RBV": 1.0, "EGU": "in"}
        for field, value in wrong.items():
            self.refused(field, value)
        self.refused("VAL", b"5", data_type=4)
        self.assert_stays(where)

    def test_each_axis_has_a_record(self):
        self.set_off()
        self.move(2.0, axis="y")
        self.assertEqual((self.get("RBV", "y"), self.get("DMOV", "y")), (2.0, 1))
        self.assertEqual(self.get("DMOV"), 0)
        self.put("STOP", 1)
        self.assert_stays(self.stands())
        self.assertEqual(self.second.y.position, 2.0)

    def test_spmg_keeps_moves_back_and_resumes_none(self):
        self.set_off()
        self.put("SPMG", "Pause")
        where = self.stands()
        self.assertIn("SPMG is Pause", self.refused("VAL", 1.0))
        self.put("SPMG", "Go")
        self.assert_stays(where)
        self.put("SPMG", "Move")
        self.move(1.0)
        self.assertEqual(self.get("SPMG"), "Pause")
        self.assertIn("SPMG is Pause", self.refused("TWF", 1))

    def test_a_stop_ends_a_reference_search(self):
        self.second.x.set("reference_search_mode", 7)
        self.put("HOMF", 1, wait=False)
        until(lambda: self.second.x.moving, "it searches")
        until(lambda: self.get("HOMF") == 1, "HOMF says so")
        self.put("STOP", 1)
        self.assert_stays(self.stands())
        until(lambda: (self.get("HOMF"), self.get("DMOV")) == (0, 1), "the search has ended")

    def test_another_client_of_tmcld_moves_and_stops_it(self):
        self.second.x.move(FAR)
        until(lambda: self.get("MOVN") == 1, "it tells of it")
        self.put("STOP", 1)
        self.assert_stays(self.stands())
        until(lambda: self.get("DMOV") == 1, "it tells of that")
        self.set_off()
        self.second.x.stop()
        self.assert_stays(self.stands())
        until(lambda: self.second.x.state().lease is None, "the lease has ended")
        with self.second.lease("x", ttl=LONGEST_S):
            self.assertIn("leased", self.refused("VAL", 1.0))


class Jogs(EpicsTest):
    def test_goes_on_until_its_field_is_0(self):
        self.hold("JOGF")
        until(lambda: self.get("JOGF") == 1 and self.second.x.position > 15, "it goes on")
        self.put("JOGF", 0)
        where = self.stands()
        self.assert_stays(where)
        until(lambda: (self.get("JOGF"), self.get("DMOV")) == (0, 1), "it has ended")
        self.hold("JOGR")
        until(lambda: self.second.x.state().position_microsteps < where, "it goes the other way")

    def test_ends_a_put_with_callback_without_an_error(self):
        waiter = self.start(sys.executable, "-c", WAITER, "test:x.JOGF")
        until(lambda: self.second.x.moving, "it goes")
        self.put("JOGF", 0)
        self.assertEqual(waiter.wait(LONGEST_S), 0)

    def test_ends_with_its_client(self):
        holder = self.hold("JOGF")
        until(lambda: self.second.x.moving, "it goes")
        self.end(holder)
        self.assert_stays(self.stands())
        until(lambda: self.get("JOGF") == 0, "it has ended")
        until(lambda: self.second.x.state().lease is None, "the lease has ended")

    def test_is_stopped_by_another_client_and_does_not_go_on(self):
        self.hold("JOGF")
        until(lambda: self.second.x.moving, "it goes")
        self.second.x.stop()
        self.assert_stays(self.stands())
        until(lambda: self.get("JOGF") == 0, "it has ended")
        self.assert_stays(self.stands())

    def test_notices_a_client_whose_computer_is_gone(self):
        holder = self.hold("JOGF")
        until(lambda: self.second.x.moving, "it goes")
        lines = pathlib.Path(f"/proc/{self.ioc.pid}/net/tcp").read_text().splitlines()
        local = f"0100007F:{self.port:04X}"
        fields = [line.split() for line in lines]
        established = [it for it in fields if it[1] == local and it[3] == "01"]
        self.assertTrue(established)
        for connection in established:
            # 02: the timer of keepalive runs; 01 and 04: it sends again, or probes.
            self.assertNotEqual(connection[5].partition(":")[0], "00")
        self.end(holder)


class Broken(EpicsTest):
    def assert_is_old(self, since):
        """No value that is read now looks as if it were new."""
        said = self.read("RBV", data_type="time").metadata
        self.assertEqual(said.severity, AlarmSeverity.INVALID_ALARM)
        self.assertLess(said.timestamp, since)
        self.assertEqual([self.get(field) for field in ("DMOV", "STAT")], [0, "COMM"])
        self.assertIn("axis_lost", self.refused("VAL", FAR))

    def test_a_killed_gateway_is_an_alarm(self):
        self.move(1.0)
        self.bench.stop_daemon(kill=True)
        dead = time.time()
        for axis in "xy":
            self.wait_for("INVALID", axis=axis)
        self.assert_is_old(dead)
        self.bench.start_daemon()
        for axis in "xy":
            self.wait_for("NO_ALARM", axis=axis)
        self.assert_stays(self.stands())
        self.move(2.0)

    def test_no_move_goes_on_when_a_killed_gateway_is_back(self):
        self.set_off()
        self.bench.stop_daemon(kill=True)
        self.wait_for("INVALID")
        self.bench.start_daemon()
        self.wait_for("NO_ALARM")
        self.assert_stays(self.stands())

    def test_a_frozen_gateway_is_an_alarm_and_moves_nothing_later(self):
        where = self.stands()
        self.freeze_daemon()
        reason = self.refused("VAL", FAR)
        self.assertTrue("no_answer" in reason or "axis_lost" in reason, reason)
        self.wait_for("INVALID")
        self.resume_daemon()
        self.wait_for("NO_ALARM")
        self.assert_stays(where)

    def test_a_dead_module_is_an_alarm_until_it_is_there_again(self):
        self.move(1.0)
        self.bench._simulator.kill()
        self.bench._simulator.wait()
        dead = time.time()
        self.wait_for("INVALID")
        self.assert_is_old(dead)
        self.bench._start_simulator(self.bench._ending, "--pty", self.bench._bus)
        self.wait_for("MAJOR", "NO_ALARM")
        where = self.stands()
        self.assert_stays(where)
        until(lambda: self.recovered(), "it may move again")
        self.move(2.0)

    def recovered(self):
        if self.get("STAT") == "DISABLE":
            self.put("CNEN", 1)
        return self.get("SEVR") == "NO_ALARM"

    def test_an_ioc_that_dies_or_hangs_stops_what_it_has_moved(self):
        for begin in (self.set_off, lambda: self.hold("JOGF")):
            for hangs in (False, True):
                with self.subTest(hangs=hangs):
                    begin()
                    until(lambda: self.second.x.moving, "it moves")
                    if hangs:
                        freeze(self.ioc.pid)
                        where = self.stands()
                        self.ioc.send_signal(signal.SIGCONT)
                        self.wait_for("NO_ALARM")
                    else:
                        self.end(self.ioc)
                        where = self.stands()
                        self.start_ioc()
                    self.assert_stays(where)


class Rounds(EpicsTest, Faults):
    start_bridge = EpicsTest.start_ioc

    @property
    def bridge(self):
        return self.ioc

    def wait_for_loss(self):
        self.wait_for("INVALID")

    def wait_until_back(self):
        until(lambda: self.get("SEVR") != "INVALID", "it is back")

    def stop(self):
        self.put("STOP", 1)

    def wait_until_well(self):
        self.wait_for("NO_ALARM")


if __name__ == "__main__":
    unittest.main()
