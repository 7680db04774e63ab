"""What a bridge holds for new, and what it lets begin, by a clock and a gateway of the test's own."""

import asyncio
import pathlib
import tempfile
import unittest

import tmcl
from tmcl.bridge import FRESH_S, AxisChoice, Choices, Follower
from tmcl.methods import State


class Clock:
    trouble = "not connected"
    time = 0.0

    def __init__(self):
        self.changed = self

    def set(self):
        pass

    def now(self):
        return self.time

    def check_awake(self):
        pass

    def later(self, work):
        self.task = asyncio.ensure_future(work)


class Gateway:
    """Grants a lease when it is told to."""

    def __init__(self):
        self.called = []
        self.said = {}
        self.granting = asyncio.Event()

    async def call(self, method, said):
        self.called.append(method)
        self.said[method] = said
        if method == "lease.acquire":
            await self.granting.wait()
            return {"lease": 1, "epoch": 2}
        return {}

    def axis(self, name):
        return self

    async def wait(self):
        """Its moves end at once."""


class FreshTest(unittest.TestCase):
    def setUp(self):
        self.clock = Clock()
        self.axis = Follower(self.clock, AxisChoice("x", "move", {}))

    def test_knows_nothing_at_first(self):
        self.assertIsNone(self.axis.state)
        self.assertEqual(self.axis.trouble, "not connected")

    def test_what_is_told_holds_for_less_than_two_seconds(self):
        self.assertLess(FRESH_S + 0.2, 2)
        self.axis._know(State(axis="x"))
        self.clock.time = FRESH_S
        self.assertIsNotNone(self.axis.state)
        self.clock.time += 0.01
        self.assertIsNone(self.axis.state)
        self.assertIn("told nothing", self.axis.trouble)
        self.axis._know(State(axis="x"))
        self.assertIsNotNone(self.axis.state)

    def test_an_error_counts_at_once(self):
        self.axis._know(State(axis="x"))
        self.axis._lose("no reply")
        self.assertIsNone(self.axis.state)
        self.assertFalse(self.axis.busy)

    def test_what_was_asked_for_before_a_stop_does_not_begin(self):
        async def scene():
            self.clock.gateway = gateway = Gateway()
            self.clock.lease_ttl = 2.0
            self.axis._know(State(axis="x"))
            moving = asyncio.ensure_future(self.axis.move(1))
            while not gateway.called:
                await asyncio.sleep(0)
            await self.axis.stop()
            gateway.granting.set()
            with self.assertRaises(tmcl.Error) as error:
                await moving
            self.assertEqual(error.exception.name, "superseded_by_stop")
            await self.clock.task
            self.assertEqual(gateway.called, ["lease.acquire", "axis.stop", "lease.release"])

        asyncio.run(scene())

    def test_a_position_is_in_the_unit_of_the_state_before_the_units_are_known(self):
        async def scene(unit):
            self.clock.gateway = gateway = Gateway()
            self.clock.lease_ttl = 2.0
            gateway.granting.set()
            self.axis._know(State(axis="x", unit=unit))
            await self.axis.move(2.5)
            return gateway.said["axis.move_to"]

        self.assertEqual(asyncio.run(scene("mm"))["position"], 2.5)
        self.axis = Follower(self.clock, AxisChoice("x", "move", {}))
        self.assertEqual(asyncio.run(scene(None))["position_microsteps"], 2)

    def test_says_what_is_wrong_in_a_configuration(self):
        wrong = {
            "": "names no axes",
            "axes = 1": "known are",
            "lease_ttl = 0\n[[axis]]": "lease_ttl",
            "[[axis]]": "lacks 'device'",
            '[[axis]]\nname = "x"\ndevice = "a/b/c"\nlease = "never"': "lease is",
        }
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "bridge.toml")
            for text, what in wrong.items():
                file.write_text(text)
                with self.assertRaisesRegex(ValueError, what):
                    Choices.read(file, "device")


if __name__ == "__main__":
    unittest.main()
