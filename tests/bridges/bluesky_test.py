"""The device of Bluesky beside a second client of tmcld: in a RunEngine where Python finds Bluesky, else
by its methods alone."""

import importlib.util
import os
import signal
import sys
import unittest

from bridge_bench import FAR, LONGEST_S, ROOT, BridgeTest, Faults, Hosted, freeze, until

import tmcl

HOST = ROOT / "tests/bridges/in_bluesky.py"
EXAMPLES = ROOT / "tools/python/examples"
IS_REAL = importlib.util.find_spec("bluesky") is not None


def setUpModule():
    print(f"in {'Bluesky' if IS_REAL else 'no Bluesky: there is none'}", file=sys.stderr)
    os.environ["PYTHONPATH"] += f":{EXAMPLES}"


class BlueskyTest(Hosted, BridgeTest):
    lease = "move"

    def setUp(self):
        super().setUp()
        self.start_host()

    def start_host(self):
        self.talk_to(HOST, str(self.bench.socket), self.lease)
        until(lambda: self.told("started"), "it has started")

    def over(self, since):
        return self.told("ended", since) or self.told("failed", since)

    def is_idle(self):
        return len(self.told("begun")) == len(self.told("ended")) + len(self.told("failed"))

    def mv(self, to):
        """Returns when it moves, and how much had been told before; as a person, asks again where the
        computer was busy."""

        def begun():
            until(self.is_idle, "no plan runs any more")
            before = len(self.said)
            self.do("mv", to)
            until(lambda: self.second.x.moving or self.over(before), "it is on its way, or is not")
            if wrong := self.told("failed", before):
                again = ("stood still", "told nothing", "does not answer", "lease", "nothing is known")
                self.assertTrue(any(word in wrong[0] for word in again), wrong)
            return None if wrong else before

        return until(begun, f"it takes {to}")

    def ends(self, since):
        until(lambda: self.over(since), "the plan is over")
        self.assertFalse(self.told("failed", since))

    def fails(self, since):
        until(lambda: self.over(since), "the plan is over")
        self.assertFalse(self.told("ended", since))
        return self.told("failed", since)[0]

    def is_known(self):
        return not [said for name, said in self.do("read") if name == "exception"]

    def becomes_unknown(self):
        until(lambda: not self.is_known(), "nothing is known")

    def becomes_known(self):
        until(self.is_known, "it is known again")


class Told(BlueskyTest):
    def test_moves_where_it_is_told_under_a_lease_that_ends(self):
        self.assert_stays(0)
        before = self.mv(2.5)
        self.ends(before)
        self.assertEqual((self.second.x.position, self.second.x.moving), (2.5, False))
        until(lambda: self.second.x.state().lease is None, "the lease has ended")

    def test_a_refusal_fails_the_plan(self):
        before = len(self.said)
        self.do("mv", 1301.0)
        self.assertIn("soft limit", self.fails(before))
        self.assert_stays(0)

    def test_a_stop_needs_no_lease(self):
        with self.second.lease("x", ttl=LONGEST_S):
            self.second.x.move(FAR)
            self.do("stop")
            self.assert_stays(self.stands())

    def test_a_move_that_is_stopped_by_either_client_fails(self):
        for stop in (lambda: self.do("stop"), self.second.x.stop):
            before = self.mv(FAR)
            with self.assertRaises(tmcl.Error) as error:
                self.second.x.move(1)
            self.assertEqual(error.exception.name, "leased")
            stop()
            self.assertIn("move_interrupted", self.fails(before))
            self.assert_stays(self.stands())

    def test_the_newer_of_two_moves_counts(self):
        if IS_REAL:
            self.skipTest("a RunEngine runs one plan at a time")
        self.mv(FAR)
        before = len(self.said)
        self.do("mv", 1.0)
        until(lambda: self.told("failed", before) and self.told("ended", before), "both are over")
        self.assertIn("superseded", self.told("failed", before)[0])
        self.assertEqual(self.second.x.position, 1.0)


@unittest.skipUnless(IS_REAL, "there is no Bluesky")
class Planned(BlueskyTest):
    def values(self, since):
        return [event["data"]["x"] for event in self.told("event", since)]

    def test_scans_and_counts(self):
        for plan, said, values in (
            ("scan", (1.0, 3.0, 3), [1.0, 2.0, 3.0]),
            ("rel_scan", (-1.0, 1.0, 3), [2.0, 3.0, 4.0]),
            ("count", (), [3.0]),
        ):
            with self.subTest(plan=plan):
                before = len(self.said)
                self.do(plan, *said)
                self.ends(before)
                self.assertEqual(self.values(before), values)
                self.assertEqual(self.told("stop", before), [{"exit_status": "success"}])

    def test_a_pause_stops_it_and_nothing_moves_until_it_is_resumed(self):
        self.do("scan", 0.0, 20.0, 2)
        until(lambda: self.second.x.moving, "it moves")
        before = len(self.said)
        self.do("pause")
        self.assertIn("RunEngineInterrupted", self.fails(before))
        where = self.stands()
        self.assertLess(self.second.x.position, 20.0)
        self.assert_stays(where)
        before = len(self.said)
        self.do("resume")
        self.ends(before)
        self.assertEqual(self.second.x.position, 20.0)

    def test_an_abort_leaves_it_where_it_stops(self):
        self.do("scan", 0.0, FAR, 2)
        until(lambda: self.second.x.moving, "it moves")
        before = len(self.said)
        self.do("pause")
        self.fails(before)
        before = len(self.said)
        self.do("abort")
        self.ends(before)
        self.assertEqual(self.told("stop", before), [{"exit_status": "abort"}])
        self.assert_stays(self.stands())

    def test_a_scan_ends_where_another_client_stops_it(self):
        before = len(self.said)
        self.do("scan", 0.0, FAR, 2)
        until(lambda: self.second.x.moving, "it moves")
        self.second.x.stop()
        self.assertIn("move_interrupted", self.fails(before))
        self.assertEqual(self.told("stop", before), [{"exit_status": "fail"}])
        self.assert_stays(self.stands())


class InSession(BlueskyTest):
    lease = "session"

    def test_no_other_client_moves_it_until_it_is_closed(self):
        until(lambda: self.second.x.state().lease, "the lease is taken")
        with self.assertRaises(tmcl.Error) as error:
            self.second.x.move(1)
        self.assertEqual(error.exception.name, "leased")
        self.mv(FAR)
        self.do("close")
        self.assert_stays(self.stands())
        until(lambda: self.second.x.state().lease is None, "the lease has ended")


class Broken(BlueskyTest):
    def test_what_is_lost_fails_the_plan_and_is_not_read(self):
        for hold, resume in (
            (lambda: self.bench.stop_daemon(kill=True), self.bench.start_daemon),
            (self.freeze_daemon, self.resume_daemon),
            (self.freeze_simulator, self.resume_simulator),
        ):
            before = self.mv(FAR)
            hold()
            self.fails(before)
            self.becomes_unknown()
            # A RunEngine stops its axes before it says what is lost, and is not to wait for that.
            self.assertIn("axis_lost", next(said for name, said in self.do("stop") if name == "exception"))
            resume()
            self.becomes_known()
            self.do("stop")
            self.assert_stays(self.stands())

    def test_a_program_that_dies_or_hangs_stops_what_it_has_moved(self):
        self.mv(FAR)
        freeze(self.host.pid)
        where = self.stands()
        self.resume_host()
        self.becomes_known()
        self.assert_stays(where)
        self.mv(FAR)
        self.end(self.host)
        where = self.stands()
        self.start_host()
        self.assert_stays(where)

    def resume_host(self):
        self.host.send_signal(signal.SIGCONT)


class Rounds(BlueskyTest, Faults):
    start_bridge = BlueskyTest.start_host
    set_off = BlueskyTest.mv
    wait_for_loss = BlueskyTest.becomes_unknown
    wait_until_back = BlueskyTest.becomes_known
    wait_until_well = BlueskyTest.becomes_known

    def stop(self):
        self.do("stop")


if __name__ == "__main__":
    unittest.main()
