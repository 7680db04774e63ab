"""tmcl-tango as a process, without a database, beside a second client of the same tmcld."""

import signal
import unittest
from concurrent.futures import ThreadPoolExecutor

from bridge_bench import FAR, LONGEST_S, ROOT, BridgeTest, Faults, free_port, freeze, until

import tango
import tmcl

SERVER = ROOT / "tools/bridges/tango/tmcl-tango"
ON, MOVING, FAULT, ALARM, DISABLE = (
    getattr(tango.DevState, name) for name in ("ON", "MOVING", "FAULT", "ALARM", "DISABLE")
)


class TangoTest(BridgeTest):
    lease = "move"
    last_status = "none"

    def setUp(self):
        super().setUp()
        self.configuration = self.bench.folder / "tango.toml"
        self.configuration.write_text(f"""
            lease = "{self.lease}"
            [gateway]
            where = "{self.bench.socket}"
            [[axis]]
            name = "x"
            device = "lab/tmcl/x"
            [[axis]]
            name = "y"
            device = "lab/tmcl/y"
        """)
        self.start_server()

    def start_server(self, *more):
        self.port = free_port()
        self.server = self.start(
            SERVER, "test", "--config", self.configuration, "--no-database", f"127.0.0.1:{self.port}",
            *more,
        )
        self.device = until(self.proxy, "the server answers")
        self.wait_for(ON)
        until(lambda: self.device.get_attribute_config("Position").unit == "mm", "it knows the unit")

    def proxy(self):
        made = tango.DeviceProxy(f"tango://127.0.0.1:{self.port}/lab/tmcl/x#dbase=no")
        made.set_timeout_millis(int(LONGEST_S * 1000))
        made.ping()
        return made

    def wait_for(self, *states):
        def reached():
            self.last_status = self.device.status()
            return self.device.state() in states

        until(reached, lambda: f"one of {states}; the last status: {self.last_status}")

    def sent(self, act):
        """As a person: asks again where it was not sent because the computer is busy."""
        def begun():
            try:
                act()
            except tango.DevFailed as failed:
                reasons = ("tmcl_axis_lost", "tmcl_stale_request", "tmcl_no_answer", "tmcl_lease_lost")
                self.assertIn(failed.args[0].reason, reasons, failed.args[0].desc)
                return False
            return True

        until(begun, "it is sent")

    def move(self, to):
        self.sent(lambda: self.write(to))

    def refused_once(self, act):
        with self.assertRaises(tango.DevFailed) as caught:
            act()
        return caught.exception.args[0].reason

    def refused(self, act):
        """As a person: asks again where the server stood still because the computer is busy."""
        def reason():
            said = self.refused_once(act)
            return said if said != "tmcl_stale_request" else None

        return until(reason, "the server is awake")

    def move_by_second(self, to):
        def begun():
            self.second.x.move(to)
            return True

        until(begun, "the second client may move")

    def write(self, to):
        self.device.Position = to


class Told(TangoTest):
    def test_moves_where_it_is_told_and_no_earlier_says_that_it_stands(self):
        self.move(2.5)
        self.assertIn(self.device.state(), (MOVING, FAULT))
        self.wait_for(ON)
        self.assertEqual(self.device.Position, 2.5)
        self.assertEqual(self.second.x.position, 2.5)
        self.assertTrue(self.device.InPosition)

    def test_attributes_have_units_and_limits(self):
        config = self.device.get_attribute_config("Position")
        self.assertEqual((config.unit, config.min_value, config.max_value), ("mm", "-100.0", "1300.0"))
        self.assertEqual(self.device.get_attribute_config("Velocity").unit, "mm/s")
        self.assertEqual(self.refused(lambda: self.write(1301.0)), "API_WAttrOutsideLimit")
        self.assertIn(
            self.refused(lambda: self.write(float("nan"))),
            ("API_WAttrOutsideLimit", "tmcl_bad_argument"),
        )
        self.device.Velocity = 4.0
        self.assertAlmostEqual(self.device.Velocity, 4.0, 1)

    def test_pushes_events(self):
        seen = []
        for name in ("Position", "State"):
            self.device.subscribe_event(
                name, tango.EventType.CHANGE_EVENT,
                lambda event: seen.append(None if event.err else event.attr_value.value),
            )
        self.move(3.0)
        until(lambda: {MOVING, 3.0} <= set(seen), f"events; so far {seen}")

    def test_a_jog_ends_with_its_client(self):
        self.sent(lambda: self.device.Jog(4.0))
        until(lambda: self.second.x.moving, "it goes")
        self.wait_for(ON)
        until(lambda: self.second.x.state().lease is None, "the lease has ended")

    def test_a_stop_ends_a_reference_search(self):
        self.second.x.set("reference_search_mode", 7)
        self.sent(self.device.Home)
        until(lambda: self.second.x.moving, "it searches")
        self.device.Stop()
        self.wait_for(ON)
        until(lambda: self.second.x.state().lease is None, "the lease has ended")


class Shared(TangoTest):
    def test_tells_of_a_move_of_another_client(self):
        self.move_by_second(FAR)
        self.wait_for(MOVING)
        self.device.Stop()
        self.wait_for(ON)
        self.assert_stays(self.stands())

    def test_another_client_stops_a_move(self):
        self.move(FAR)
        until(lambda: self.second.x.moving, "it moves")
        self.second.x.stop()
        self.wait_for(ON)
        self.assert_stays(self.stands())

    def test_a_move_has_a_lease_until_it_stands(self):
        self.move(FAR)
        with self.assertRaises(tmcl.Error) as error:
            self.second.x.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.device.Stop()
        self.wait_for(ON)
        self.move_by_second(1)
        self.second.x.wait()

    def test_stops_an_axis_that_is_leased_to_another(self):
        with self.second.lease("x", ttl=LONGEST_S):
            self.second.x.move(FAR)
            self.assertEqual(self.refused(lambda: self.write(1.0)), "tmcl_leased")
            self.device.Stop()
            self.assert_stays(self.stands())


class InSession(TangoTest):
    lease = "session"

    def test_no_other_client_moves_it_and_any_stops_it(self):
        until(lambda: self.second.x.state().lease, "the lease is taken")
        with self.assertRaises(tmcl.Error) as error:
            self.second.x.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.move(FAR)
        self.second.x.stop()
        self.wait_for(ON)

    def test_a_write_that_waited_in_a_frozen_server_moves_nothing(self):
        until(lambda: self.second.x.state().lease, "the lease is taken")
        where = self.stands()
        # By its name, this program would ask for it first, and do nothing else meanwhile.
        position = self.device.get_attribute_config("Position")
        freeze(self.server.pid)
        with ThreadPoolExecutor() as beside:
            late = beside.submit(
                self.refused_once, lambda: self.device.write_attribute(position, FAR)
            )
            until(lambda: self.second.x.state().lease is None, "the lease has run out")
            self.server.send_signal(signal.SIGCONT)
            self.assertEqual(late.result(), "tmcl_stale_request")
        until(lambda: self.second.x.state().lease, "the lease is taken anew")
        self.assert_stays(where)


class Broken(TangoTest):
    def test_a_killed_gateway_is_a_fault_and_no_value(self):
        self.bench.stop_daemon(kill=True)
        self.wait_for(FAULT)
        said = self.device.read_attribute("Position")
        self.assertEqual(said.quality, tango.AttrQuality.ATTR_INVALID)
        self.assertEqual(self.refused(lambda: self.write(FAR)), "tmcl_axis_lost")
        self.bench.start_daemon()
        self.wait_for(ON)
        self.assert_stays(self.stands())

    def test_a_move_that_a_frozen_gateway_was_told_moves_nothing(self):
        where = self.stands()
        self.freeze_daemon()
        self.assertIn(self.refused(lambda: self.write(FAR)), ("tmcl_no_answer", "tmcl_axis_lost"))
        self.wait_for(FAULT)
        self.resume_daemon()
        self.wait_for(ON)
        self.assert_stays(where)

    def test_a_silent_bus_is_a_fault(self):
        where = self.stands()
        self.freeze_simulator()
        self.wait_for(FAULT)
        self.resume_simulator()
        self.wait_for(ON)
        self.assert_stays(where)

    def test_a_server_that_dies_stops_what_it_has_moved(self):
        for frozen in (False, True):
            with self.subTest(frozen=frozen):
                self.move(FAR)
                until(lambda: self.second.x.moving, "it moves")
                if frozen:
                    freeze(self.server.pid)
                    where = self.stands()
                    self.server.send_signal(signal.SIGCONT)
                    self.wait_for(ON)
                else:
                    self.end(self.server)
                    where = self.stands()
                    self.start_server()
                self.assert_stays(where)

    def test_no_stored_setpoint_moves_anything(self):
        self.move(1.0)
        self.wait_for(ON)
        where = self.stands()
        self.end(self.server, signal.SIGTERM)
        stored = self.bench.folder / "stored"
        stored.write_text(
            'tmcl-tango/test/DEVICE/TmclAxis: "lab/tmcl/x", "lab/tmcl/y"\n'
            'lab/tmcl/x/Position->__value: 50\n'
        )
        self.start_server(f"-file={stored}")
        self.assertEqual(self.device.get_attribute_config("Position").memorized.name, "NONE")
        self.assert_stays(where)
        self.device.Init()
        self.wait_for(ON)
        self.assert_stays(where)


class Rounds(TangoTest, Faults):
    start_bridge = TangoTest.start_server
    set_off = TangoTest.move

    @property
    def bridge(self):
        return self.server

    def wait_for_loss(self):
        self.wait_for(FAULT)

    def wait_until_back(self):
        until(lambda: self.device.state() != FAULT, "it is back")

    def stop(self):
        self.device.Stop()

    def wait_until_well(self):
        self.wait_for(ON)


if __name__ == "__main__":
    unittest.main()
