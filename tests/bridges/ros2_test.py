"""The plugin of ros2_control, in a host that stands in for ROS 2, beside a second client of the same tmcld."""

import math
import os
import pathlib
import signal
import subprocess
import threading
import unittest

from bridge_bench import FAR, LONGEST_S, BridgeTest, Faults, freeze, until

import tmcl

HOST = pathlib.Path(os.environ["TMCL_BIN"], "ros2_host")
MM = 1e-3


class Ros2Test(BridgeTest):
    def setUp(self):
        super().setUp()
        self.start_host()

    def start_host(self):
        with open(self.bench.folder / "bridge.log", "ab") as log:
            self.host = subprocess.Popen(
                [HOST, self.bench.socket, "x", "y"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=log, text=True,
            )
        self.addCleanup(self.end_host, self.host)
        self.said = []
        threading.Thread(target=self.listen, args=(self.host, self.said), daemon=True).start()

    def listen(self, host, said):
        for line in host.stdout:
            said.append(line.split())

    def end_host(self, host):
        self.end(host)
        host.stdin.close()
        host.stdout.close()

    def do(self, *words):
        """The state after it, and the position, velocity and age of each joint."""
        before = len(self.said)
        self.host.stdin.write(" ".join(map(str, words)) + "\n")
        self.host.stdin.flush()
        until(lambda: len(self.said) > before, f"{words} is answered")
        state, *numbers = self.said[before]
        return state, [float(number) for number in numbers]

    def life(self):
        return self.do("show")[0]

    def position(self):
        return self.do("show")[1][0]

    def complaints(self):
        return (self.bench.folder / "bridge.log").read_text()

    def activate(self):
        """As a person: configures it again where it was lost because the computer is busy."""

        def active():
            self.do("configure")
            return self.do("activate")[0] == "active"

        until(active, lambda: f"it is active: {self.complaints()}")

    def command(self, mm, joint="joint_x"):
        self.do("command", joint, mm * MM)

    def set_off(self, to):
        """As a person: activates it again where it was lost because the computer is busy."""

        def begun():
            if self.life() != "active":
                self.activate()
            self.command(to)
            for _ in range(100):
                if self.second.x.moving:
                    return True
                if self.life() != "active":
                    break
            return False

        until(begun, f"it is on its way to {to}; {self.complaints()}")


class Told(Ros2Test):
    def test_goes_where_it_is_commanded_and_tells_where_it_is(self):
        self.activate()
        self.set_off(2.5)
        until(lambda: self.second.x.state().position_reached, "it gets there")
        until(lambda: math.isclose(self.position(), 2.5 * MM, rel_tol=1e-6), "it says so")
        self.assertEqual(self.second.x.position, 2.5)
        _, (_, velocity, age, *_) = self.do("show")
        self.assertTrue(velocity == 0 and 0 <= age < LONGEST_S)

    def test_nothing_moves_when_it_is_activated(self):
        self.second.x.move(3.0)
        self.second.x.wait()
        where = self.stands()
        self.do("command", "joint_x", 50 * MM)
        self.activate()
        self.assert_stays(where)
        self.do("deactivate")
        self.do("command", "joint_x", 50 * MM)
        self.activate()
        self.assert_stays(where)
        self.do("command", "joint_x", "nan")
        self.assert_stays(where)

    def test_has_a_lease_from_activation_to_deactivation_and_stops_at_its_end(self):
        self.do("configure")
        self.assertIsNone(self.second.x.state().lease)
        self.activate()
        with self.assertRaises(tmcl.Error) as error:
            self.second.y.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.set_off(FAR)
        self.do("deactivate")
        self.assert_stays(self.stands())
        self.assertIsNone(self.second.x.state().lease)

    def test_is_not_activated_while_another_client_moves_an_axis(self):
        self.second.x.move(FAR)
        until(lambda: self.second.x.moving, "it moves")
        self.do("configure")
        self.assertEqual(self.do("activate")[0], "inactive")
        self.assertIn("moves for another client", self.complaints())
        self.assertTrue(self.second.x.moving)
        self.second.x.stop()
        self.stands()
        with self.second.lease("y", ttl=LONGEST_S):
            self.assertEqual(self.do("activate")[0], "inactive")
        self.activate()

    def test_a_refusal_and_a_stop_by_another_client_are_errors(self):
        self.activate()
        self.command(1301)
        until(lambda: self.life() == "unconfigured", "a refusal is an error")
        self.assertIn("soft limit", self.complaints())
        self.assertTrue(math.isnan(self.position()))
        self.activate()
        self.set_off(FAR)
        self.second.x.stop()
        self.command(FAR - 1)
        until(lambda: self.life() == "unconfigured", "a stop is an error")
        self.assert_stays(self.stands())

    def test_the_newest_command_counts(self):
        self.activate()
        for step in range(20):
            self.command(step * 0.1)
            self.command(step * 0.2, "joint_y")
        until(lambda: math.isclose(self.second.y.position, 3.8, abs_tol=1e-3), "y gets there")
        until(lambda: math.isclose(self.second.x.position, 1.9, abs_tol=1e-3), "x gets there")


class Broken(Ros2Test):
    def test_what_is_lost_is_an_error_and_no_value(self):
        for hold, resume in (
            (self.freeze_daemon, self.resume_daemon),
            (self.freeze_simulator, self.resume_simulator),
        ):
            with self.subTest(hold=hold.__name__):
                self.activate()
                where = self.stands()
                hold()
                until(lambda: self.life() == "unconfigured", "it is an error")
                self.assertTrue(math.isnan(self.position()))
                resume()
                self.activate()
                self.assert_stays(where)

    def test_a_loop_of_ros_that_hangs_stops_what_it_has_moved(self):
        self.activate()
        self.set_off(FAR)
        freeze(self.host.pid)
        where = self.stands()
        self.host.send_signal(signal.SIGCONT)
        self.assert_stays(where)
        until(lambda: self.life() == "unconfigured", "it is an error")


class Rounds(Ros2Test, Faults):
    def setUp(self):
        super().setUp()
        self.activate()

    @property
    def bridge(self):
        return self.host

    def start_bridge(self):
        self.start_host()

    def wait_for_loss(self):
        until(lambda: self.life() == "unconfigured", "it is an error")

    def wait_until_back(self):
        until(lambda: self.do("configure")[0] == "inactive", "it is connected again")

    def stop(self):
        self.second.x.stop()

    def wait_until_well(self):
        self.stands()
        self.activate()


if __name__ == "__main__":
    unittest.main()
