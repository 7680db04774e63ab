"""The package against a real tmcld, which ends and starts again."""

import os
import signal
import threading
import unittest

import tmcl
from tmcl.testing import Bench

UNIT = {"unit": "mm", "units_per_revolution": 8.0, "soft_limits": [-100, 100]}


class BenchTest(unittest.TestCase):
    virtual_time = False

    def setUp(self):
        axes = {"x": UNIT, "y": {}}
        self.bench = self.enterContext(
            Bench("TMCM-3110", axes=axes, virtual_time=self.virtual_time))

    def connect(self, **how):
        return self.enterContext(self.bench.connect(**how))

    def failure(self, call, *args, **params):
        with self.assertRaises(tmcl.Error) as raised:
            call(*args, **params)
        return raised.exception

    def see_both(self, states):
        seen = set()
        while seen != {"x", "y"}:
            seen.add(next(states).axis)


class MovesTest(BenchTest):
    virtual_time = True

    def test_moves_waits_and_says_where_an_axis_is(self):
        d = self.connect()
        started = d.x.move("2.5 mm")
        self.assertEqual((started.target, started.unit), (2.5, "mm"))
        self.assertGreater(started.predicted_s, 0)
        d.x.wait()
        self.assertEqual(d.x.position, 2.5)
        d.x.move_by(-2.5)
        self.assertEqual(d.x.wait(30).position, 0)
        self.assertFalse(d.x.moving)
        d.y.move(microsteps=100)
        self.assertEqual(d.y.wait().position_microsteps, 100)
        self.assertEqual([axis.name for axis in d.axes()], ["x", "y"])
        self.assertEqual(d["1/0"].state().axis, "x")

    def test_sets_and_reads_parameters(self):
        d = self.connect()
        d.x.set("max_velocity", 700)
        self.assertEqual(d.x.get(4), 700)
        self.assertEqual(d.x.set("max_velocity", in_unit="5 mm/s").parameter, "max_velocity")
        self.assertEqual(d.x.errors().flags, ())
        self.assertEqual(d.x.units().unit, "mm")
        d.x.set("max_velocity", 1000)

    def test_errors_are_the_daemons(self):
        d = self.connect()
        self.assertEqual(self.failure(d.x.move, 500).name, "beyond_soft_limit")
        self.assertEqual(self.failure(d.x.move, "3 furlong").name, "unknown_unit")
        self.assertEqual(self.failure(d.x.move, "3").name, "bare_number")
        self.assertEqual(self.failure(d.axis("xx").move, 1).hint, "Did you mean 'x'?")
        self.assertEqual(self.failure(d.call, "axis.dance").name, "method_not_found")
        refused = self.failure(d.rpc.module_execute, "bench", 1, "GAP", type=1, motor=5)
        self.assertEqual((refused.outcome, refused.data["status_name"]),
                         ("refused", "invalid_value"))

    def test_a_lease_keeps_others_out_until_it_is_broken(self):
        mine, others = self.connect(), self.connect()
        with self.assertRaises(tmcl.LeaseLost):
            with mine.lease("x", ttl=10):
                mine.x.move(1)
                self.assertEqual(self.failure(others.x.move, 0).name, "leased")
                mine.x.wait()
                others.rpc.lease_break("x")
                while True:
                    mine.x.move(1)
        others.x.move(0)
        others.x.wait()
        self.assertEqual(mine.rpc.lease_list().leases, ())

    def test_records_a_move(self):
        d = self.connect()
        with d.record("x", interval=0.01) as recording:
            d.x.move_by(1)
            d.x.wait()
            d.x.move(0)
            d.x.wait()
        self.assertGreater(len(recording.of("x")), 3)
        seen = [state.position for state in recording.states]
        self.assertGreater(max(seen), 0.5)


class DaemonTest(BenchTest):
    """What ends, starts again or comes in between by the computer's clock."""

    def test_a_wait_is_told_of_a_stop(self):
        d = self.connect()
        d.x.move(90)
        threading.Timer(0.1, d.x.stop).start()
        self.assertEqual(self.failure(d.x.wait).name, "move_interrupted")
        d.x.move(0)
        d.x.wait()

    def test_a_lease_held_by_hand_runs_out(self):
        d = self.connect()
        with self.assertRaises(tmcl.LeaseLost):
            with d.lease("x", ttl=0.2, by_hand=True):
                while True:
                    d.x.state()

    def test_watches_all_axes_through_a_restart(self):
        d = self.connect(patience=30)
        states = d.watch(interval=0.02)
        self.see_both(states)
        d.x.move(1)
        while next(states).position != 1:
            pass
        self.bench.stop_daemon(kill=True)
        self.bench.start_daemon()
        self.see_both(states)
        d.x.move(0)
        while next(states).position != 0:
            pass
        states.close()

    def test_a_killed_daemon_leaves_a_move_unknown_and_a_reading_repeated(self):
        d = self.connect(patience=30)
        d.x.move(0)
        d.x.wait()
        os.kill(self.bench.daemon_pid, signal.SIGSTOP)
        threading.Timer(0.3, self.bench.stop_daemon, kwargs={"kill": True}).start()
        lost = self.failure(d.x.move, 50)
        self.assertEqual((lost.name, lost.outcome), ("connection_lost", "unknown"))
        self.bench.start_daemon()
        self.assertEqual(d.x.position, 0)
        self.assertEqual(d.x.target, 0)

    def test_a_lease_ends_with_the_daemon(self):
        d = self.connect(patience=30)
        with self.assertRaises(tmcl.LeaseLost):
            with d.lease("x"):
                self.bench.stop_daemon(kill=True)
                self.bench.start_daemon()
                while True:
                    d.x.state()
        self.assertEqual(d.x.state().lease, None)


if __name__ == "__main__":
    unittest.main()
