"""tmcl-hal in the HAL of LinuxCNC, without its realtime part, beside a second client of the same tmcld."""

import itertools
import os
import signal
import subprocess
import sys
import time
import unittest

from bridge_bench import FAR, LONGEST_S, PAUSE_S, ROOT, BridgeTest, Faults, freeze, until

from tmcl.bridge import ANSWER_S

COMPONENT = ROOT / "tools/bridges/hal/tmcl-hal"


def halcmd(*words):
    said = subprocess.run(
        ["halcmd", *words], capture_output=True, text=True, timeout=LONGEST_S, check=False
    )
    if said.returncode != 0:
        raise RuntimeError(said.stderr)
    return said.stdout.strip()


class HalTest(BridgeTest):
    def setUp(self):
        super().setUp()
        self.name = f"tmcl{os.getpid()}"
        self.configuration = self.bench.folder / "hal.toml"
        self.configuration.write_text(f"""
            [gateway]
            where = "{self.bench.socket}"
            [[axis]]
            name = "x"
        """)
        self.start_component()

    def start_component(self):
        self.component = self.start(COMPONENT, "--config", self.configuration, "--name", self.name)
        until(lambda: self.pin("heartbeat") in ("TRUE", "FALSE"), "the component is ready")
        self.wait_for("x.fault", "FALSE")

    def end_component(self, number=signal.SIGTERM):
        self.end(self.component, number)
        # What is left of a component that was killed.
        subprocess.run(["halcmd", "unloadusr", self.name], capture_output=True, check=False)

    def tearDown(self):
        self.end_component()

    def pin(self, name):
        return halcmd("getp", f"{self.name}.{name}")

    def set(self, name, value):
        halcmd("setp", f"{self.name}.{name}", str(value))

    def wait_for(self, name, value):
        until(lambda: self.pin(name) == value, f"{name} is {value}")

    def beats(self):
        """The component has gone through its loop."""
        now = self.pin("heartbeat")
        until(lambda: self.pin("heartbeat") != now, "it goes on")

    def enable(self):
        self.set("x.enable", 1)
        self.wait_for("x.enabled", "TRUE")

    def move(self, to):
        """As a person: asks again for another target where this one was refused, or was not seen,
        because the computer is busy."""
        targets = itertools.count(to, 0.001)

        def begun():
            self.enable()
            self.set("x.target", next(targets))
            end = time.monotonic() + ANSWER_S + 1
            while time.monotonic() < end:
                if self.second.x.moving:
                    return True
                time.sleep(PAUSE_S)
            print("asked again", file=sys.stderr)
            self.set("x.enable", 0)
            self.wait_for("x.fault", "FALSE")
            return False

        until(begun, "it moves")


class HalPins(HalTest):
    def test_moves_when_the_target_changes_while_it_is_enabled(self):
        self.enable()
        self.set("x.target", 2.5)
        until(lambda: float(self.pin("x.position")) == 2.5, "it gets there")
        self.wait_for("x.in-position", "TRUE")
        self.assertEqual(self.second.x.position, 2.5)
        until(lambda: self.second.x.state().lease is None, "the lease has ended")

    def test_no_value_that_was_there_before_moves_it(self):
        where = self.stands()
        self.set("x.target", 50)
        self.beats()
        self.enable()
        self.assert_stays(where)
        self.end_component()
        self.start_component()
        self.enable()
        self.assert_stays(where)

    def test_is_stopped_when_it_is_not_enabled_any_more(self):
        self.move(FAR)
        self.set("x.enable", 0)
        self.assert_stays(self.stands())
        self.wait_for("x.fault", "FALSE")

    def test_another_client_stops_it_and_moves_it(self):
        self.move(FAR)
        self.second.x.stop()
        self.assert_stays(self.stands())
        self.wait_for("x.fault", "TRUE")
        until(lambda: self.second.x.state().lease is None, "the lease has ended")
        self.second.x.move(FAR)
        self.wait_for("x.moving", "TRUE")
        self.set("x.enable", 0)
        self.assert_stays(self.stands())

    def test_a_lost_gateway_is_a_fault(self):
        self.enable()
        self.bench.stop_daemon(kill=True)
        self.wait_for("x.fault", "TRUE")
        self.set("x.target", 50)
        self.beats()
        self.bench.start_daemon()
        self.wait_for("x.fault", "FALSE")
        self.assert_stays(self.stands())

    def test_a_silent_bus_is_a_fault(self):
        self.move(FAR)
        self.freeze_simulator()
        self.wait_for("x.fault", "TRUE")
        self.set("x.enable", 0)
        self.resume_simulator()
        self.wait_for("x.fault", "FALSE")
        self.assert_stays(self.stands())

    def test_a_component_that_dies_or_hangs_stops_what_it_has_moved(self):
        for frozen in (False, True):
            with self.subTest(frozen=frozen):
                self.move(FAR if frozen else -90)
                if frozen:
                    freeze(self.component.pid)
                    where = self.stands()
                    self.set("x.target", FAR - 1)
                    os.kill(self.component.pid, signal.SIGCONT)
                    self.beats()
                else:
                    self.end_component(signal.SIGKILL)
                    where = self.stands()
                    self.start_component()
                self.assert_stays(where)


class Rounds(HalTest, Faults):
    """The target of the broken move stays in its pin, and moves nothing when the axis is enabled again."""

    set_off = HalTest.move

    @property
    def bridge(self):
        return self.component

    def start_bridge(self):
        self.end_component()
        self.start_component()

    def wait_for_loss(self):
        self.wait_for("x.fault", "TRUE")

    def wait_until_back(self):
        self.wait_for("x.enabled", "TRUE")

    def stop(self):
        self.set("x.enable", 0)

    def wait_until_well(self):
        self.stop()
        self.wait_for("x.fault", "FALSE")
        where = self.stands()
        self.enable()
        self.assert_stays(where)


if __name__ == "__main__":
    unittest.main()
