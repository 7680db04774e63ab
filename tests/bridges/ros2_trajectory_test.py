"""The action server of tmcl_trajectory, in a host that stands in for ROS 2, beside a second client of the same tmcld."""

import os
import pathlib
import signal
import subprocess
import threading
import unittest

from bridge_bench import LONGEST_S, BridgeTest, freeze, until

import tmcl

HOST = pathlib.Path(os.environ["TMCL_BIN"], "ros2_trajectory_host")
MM = 1e-3
SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, PATH_TOLERANCE_VIOLATED = 0, -1, -2, -4
#: Of x and y in mm, by seconds.
ROUND = {0.5: (0.3, 0), 1: (0.5, 0.4), 1.5: (0.2, 0.6), 2: (0.25, 0.5)}
#: It takes minutes to get there.
LONG = {120: (600, 600)}


class TrajectoryTest(BridgeTest):
    def setUp(self):
        super().setUp()
        self.start_host()

    def start_host(self, *more):
        # A computer that is busy for a moment ends no path, and loses no lease.
        patient = ("period=0.1", "lease_ttl=10")
        parameters = [f"gateway={self.bench.socket}", "joints=slide,lift", "axes=x,y", *patient, *more]
        pipes = dict.fromkeys(("stdin", "stdout"), subprocess.PIPE)
        self.host = self.start(HOST, *parameters, text=True, **pipes)
        self.addCleanup(self.host.stdin.close)
        self.said = []
        threading.Thread(target=self.listen, args=(self.host, self.said), daemon=True).start()

    def listen(self, host, said):
        with host.stdout:
            for line in host.stdout:
                said.append(line.rstrip("\n"))

    def ask(self, *words):
        """What it answers."""
        before = len(self.said)
        self.host.stdin.write(" ".join(map(str, words)) + "\n")
        self.host.stdin.flush()
        until(lambda: len(self.said) > before, f"{words} is answered")
        return self.said[before]

    def send(self, points, joints="slide,lift", tolerances="-", stamp=0):
        rows = (f"{at}:{','.join(str(place * MM) for place in row)}" for at, row in points.items())
        return self.ask("goal", stamp, joints, tolerances, ";".join(rows) or "-")

    def end_of(self, *goal, **more):
        self.assertEqual(self.send(*goal, **more), "accepted")
        return self.wait_for_end()

    def assert_succeeds(self, *goal):
        self.assertEqual(self.end_of(*goal), ("succeeded", SUCCESSFUL, ""))

    def wait_for_end(self):
        """Its kind, its error code and its text."""
        until(lambda: self.said[-1].startswith(("succeeded", "aborted", "canceled")), "it ends")
        kind, code, text = self.said[-1].split(" ", 2)
        return kind, int(code), text

    def set_off(self, since=0):
        self.assertEqual(self.send(LONG), "accepted")
        until(lambda: self.second.x.position > since + 1, lambda: f"it is on its way: {self.said}")

    def assert_stand(self):
        for axis in ("x", "y"):
            until(lambda: self.second.axis(axis).state().lease is None, f"{axis} has no lease")
            self.assert_stays(self.stands(axis), axis)


class Carried(TrajectoryTest):
    def test_ends_at_its_last_point_after_its_time(self):
        self.assert_succeeds(ROUND)
        self.assertAlmostEqual(self.second.x.position, 0.25, places=3)
        self.assertAlmostEqual(self.second.y.position, 0.5, places=3)
        self.assert_stand()

    def test_begins_where_the_axes_stand(self):
        self.second.x.move(3.0)
        self.second.x.wait()
        where = self.second.x.position
        self.assert_succeeds({1: (3.2, 0)})
        self.assert_succeeds({0: (3.2, 0), 1: (where, 0)})
        self.assertAlmostEqual(self.second.x.position, where, places=3)
        kind, code, text = self.end_of({0: (2, 0), 1: (2.1, 0)})
        self.assertEqual((kind, code), ("aborted", INVALID_GOAL))
        self.assertIn("where the path starts", text)
        self.assertAlmostEqual(self.second.x.position, where, places=3)

    def test_carries_one_joint_of_several_and_thousands_of_points(self):
        points = {0.001 * (i + 1): (0.0001 * (i + 1),) for i in range(5000)}
        self.assert_succeeds(points, "lift")
        self.assertAlmostEqual(self.second.y.position, 0.5, places=3)
        self.assertEqual(self.second.x.position, 0)

    def test_has_a_lease_meanwhile_and_takes_one_goal_at_a_time(self):
        self.set_off()
        with self.assertRaises(tmcl.Error):
            self.second.y.move(1)
        self.assertIsNotNone(self.second.y.state().lease)
        self.assertEqual(self.send(ROUND), "rejected")
        self.assertEqual(self.ask("cancel"), "cancelling")
        self.wait_for_end()
        self.assert_stand()
        where = self.second.x.position
        self.assert_succeeds({1: (where + 0.1, self.second.y.position)})


class Refused(TrajectoryTest):
    def assert_refused(self, code, text, *goal, **more):
        with self.subTest(text=text):
            kind, told, why = self.end_of(*goal, **more)
            self.assertEqual((kind, told), ("aborted", code), why)
            self.assertIn(text, why)
            self.assertEqual((self.second.x.position, self.second.y.position), (0, 0))

    def test_what_is_wrong_moves_nothing(self):
        self.assert_refused(INVALID_JOINTS, "joint 'z' is not known", ROUND, "slide,z")
        self.assert_refused(INVALID_JOINTS, "joint 'slide' is named twice", ROUND, "slide,slide")
        self.assert_refused(INVALID_JOINTS, "'z' has a tolerance", ROUND, tolerances="z=1")
        self.assert_refused(INVALID_JOINTS, "no joints", {}, "-")
        self.assert_refused(INVALID_GOAL, "no points", {})
        self.assert_refused(INVALID_GOAL, "point 2 is not later", {1: (0.1, 0), 0.5: (0.2, 0)})
        self.assert_refused(INVALID_GOAL, "point 1 is not later", {-1: (0.1, 0)})
        self.assert_refused(INVALID_GOAL, "point 1 does not have a position for each", {1: (0.1,)})
        self.assert_refused(INVALID_GOAL, "no finite number", {1: (0.1, float("nan"))})
        self.assert_refused(INVALID_GOAL, "header.stamp", ROUND, stamp=5)
        self.assert_refused(INVALID_GOAL, "soft limit", {100: (-200, 0)})
        self.assert_refused(INVALID_GOAL, "too fast for axis joint1", {0.01: (100, 0)})

    def test_a_parameter_out_of_its_range_ends_the_node(self):
        for parameter in ("period=0.004", "period=1.1", "period=nan", "lease_ttl=0.5", "lease_ttl=61"):
            with self.subTest(parameter=parameter):
                self.start_host(parameter)
                self.assertEqual(self.host.wait(LONGEST_S), 1)

    def test_an_axis_of_another_client_is_not_moved_and_goes_on(self):
        with self.second.lease("y", ttl=LONGEST_S):
            self.assert_refused(INVALID_GOAL, "leased", ROUND)
        self.second.y.move(300)
        until(lambda: self.second.y.moving, "it moves")
        kind, code, _ = self.end_of(ROUND)
        self.assertEqual((kind, code), ("aborted", INVALID_GOAL))
        self.assertTrue(self.second.y.moving)
        self.assertEqual(self.second.x.position, 0)


class Ended(TrajectoryTest):
    def test_a_cancel_stops(self):
        self.set_off()
        self.assertEqual(self.ask("cancel"), "cancelling")
        self.assertEqual(self.wait_for_end()[0], "canceled")
        self.assert_stand()

    def test_a_stop_by_another_client_is_an_error_and_stops_all(self):
        self.set_off()
        self.second.y.stop()
        kind, code, text = self.wait_for_end()
        self.assertEqual((kind, code), ("aborted", PATH_TOLERANCE_VIOLATED))
        self.assert_stand()

    def test_the_end_of_the_node_stops(self):
        self.set_off()
        self.host.stdin.close()
        self.assertEqual(self.host.wait(LONGEST_S), 0)
        self.assert_stand()

    def test_a_node_that_is_killed_or_hangs_stops(self):
        self.set_off()
        freeze(self.host.pid)
        self.assert_stand()
        self.host.send_signal(signal.SIGCONT)
        self.assertEqual(self.wait_for_end()[:2], ("aborted", PATH_TOLERANCE_VIOLATED))
        self.host.kill()
        self.start_host()
        where = self.second.x.position
        self.set_off(where)
        self.host.kill()
        self.assert_stand()

    def test_an_axis_that_is_off_its_way_by_more_than_its_tolerance_is_an_error(self):
        kind, code, text = self.end_of(ROUND, tolerances="slide=0.0000001,lift=-1")
        self.assertEqual((kind, code), ("aborted", PATH_TOLERANCE_VIOLATED), text)
        self.assert_stand()

    def test_the_end_of_tmcld_is_an_error(self):
        self.set_off()
        self.bench.stop_daemon(kill=True)
        kind, code, text = self.wait_for_end()
        self.assertEqual((kind, code), ("aborted", PATH_TOLERANCE_VIOLATED))
        self.assertIn("may still move", text)
        self.bench.start_daemon()
        until(lambda: self.second.x.state(), "tmcld is back")
        self.assert_stand()


if __name__ == "__main__":
    unittest.main()
