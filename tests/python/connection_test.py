"""Both faces against a daemon that fails at every step."""

import asyncio
import errno
import os
import pathlib
import re
import signal
import tempfile
import threading
import unittest
from unittest import mock

import tmcl
import tmcl.connection
import tmcl.systems
from fake_daemon import HANG_UP, SILENCE, STATE, FakeDaemon, FakeWebDaemon, error, tls_context

MOVED = {"target_microsteps": 5, "unit": "mm", "target": 12.5, "predicted_s": 0.5, "warnings": []}
GRANTED = {"lease": 7, "epoch": 9, "axes": ["x"], "ttl_ms": 2000}


class ConnectionTest(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(FakeDaemon())
        self.daemon.answers["axis.move_to"] = MOVED
        self.daemon.answers["axis.get_state"] = STATE

    def connect(self, **how):
        return self.enterContext(tmcl.connect(self.daemon.path, **how))

    def failure(self, call, *args, **params):
        with self.assertRaises(tmcl.Error) as raised:
            call(*args, **params)
        return raised.exception

    # ---- who may connect ----

    def test_only_a_group_that_is_made_for_sharing_is_to_be_joined(self):
        join = tmcl.systems.access_hint
        self.assertIn("'sudo adduser $USER lab'", join("anna", "lab", 1004))
        self.assertIn("'sudo adduser $USER tmcl'", join("tmcld", "tmcl", 998))
        for user, group, number in (("root", "root", 0), ("anna", "disk", 6), ("anna", "anna", 1000)):
            with self.subTest(group):
                hint = join(user, group, number)
                self.assertIn(f"user '{user}' and group '{group}'", hint)
                self.assertNotIn(f"$USER {group}'", hint)
                self.assertIn("'sudo addgroup tmcl'", hint)

    def test_who_may_not_connect_is_told_what_tmclctl_tells(self):
        root = pathlib.Path(__file__).parents[2]
        source = (root / "libtmcl/src/client/socket_hints.cpp").read_text()
        told = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', source)).replace('\\"', '"')
        hints = [tmcl.systems.access_hint("{}", "{}", 0),
                 tmcl.systems.access_hint("anna", "{}", 1004).replace("anna", "{}")]
        hints += [tmcl.systems.hint_for(OSError(number, ""), "/nowhere/socket")
                  for number in (errno.EACCES, errno.EAGAIN, errno.ENOENT)]
        for hint in hints:
            with self.subTest(hint):  # tmclctl begins it with a capital letter
                text = hint.replace("The socket is for user '{}' and group '{}'", "{}")
                self.assertIn(text.lower(), told.lower())

    # ---- what is said ----

    def test_a_number_and_a_text_with_a_unit_go_out_as_they_are(self):
        d = self.connect()
        self.assertEqual(d.x.move(12.5).target, 12.5)
        d["x"].move("12.5 mm")
        d.axis("1/0").move(microsteps=5120)
        self.assertEqual(
            [call["params"] for call in self.daemon.calls if call["method"] == "axis.move_to"],
            [{"axis": "x", "position": 12.5}, {"axis": "x", "position": "12.5 mm"},
             {"axis": "1/0", "position_microsteps": 5120}],
        )

    def test_axes_are_attributes_where_the_daemon_has_them(self):
        d = self.connect()
        self.assertEqual([axis.name for axis in d.axes()], ["x"])
        with self.assertRaisesRegex(AttributeError, r"no axis 'y' \(there are: x\)"):
            d.y  # noqa: B018

    def test_an_axis_without_a_unit_has_no_position_in_it(self):
        self.daemon.answers["axis.get_state"] = {**STATE, "unit": None, "position": None}
        d = self.connect()
        wrong = self.failure(lambda: d.x.position)
        self.assertEqual((wrong.name, wrong.outcome), ("no_unit", "not_sent"))
        self.assertEqual(d.x.state().position_microsteps, 0)

    def test_values_in_a_unit_are_floats_also_where_they_are_whole(self):
        whole = {**STATE, "position": 5, "velocity": 0, "target": 5}
        self.daemon.answers |= {
            "axis.get_state": whole, "axis.wait": {"position_microsteps": 5, "position": 5},
            "axis.move_to": {**MOVED, "target": 5, "predicted_s": 1},
            "axis.rotate": {"velocity_internal": 5, "velocity": 5},
            "subscribe": {"subscription": 3, "failed": [], "states": [whole]}}

        async def by_asyncio():
            async with await tmcl.aio.connect(self.daemon.path) as d:
                return await d.x.position()

        d = self.connect()
        moved, seen = d.x.move(5), next(d.watch("x"))
        values = (d.x.position, d.x.velocity, d.x.target, d.x.wait().position, moved.target,
                  moved.predicted_s, d.x.rotate(5).velocity, seen.position, seen.velocity,
                  seen.target, asyncio.run(by_asyncio()))
        self.assertEqual({type(value) for value in values}, {float})

    def test_what_a_newer_daemon_says_besides_does_no_harm(self):
        self.daemon.answers["axis.get_state"] = {**STATE, "temperament": "mild"}
        self.assertEqual(self.connect().x.position, 1.5)

    # ---- calls that fail ----

    def test_an_error_is_an_exception_with_all_that_is_known(self):
        self.daemon.answers["axis.move_to"] = error("refused_by_module", hint="look", status=4)
        wrong = self.failure(self.connect().x.move, 1)
        self.assertEqual((wrong.name, wrong.outcome, wrong.hint, wrong.data["status"]),
                         ("refused_by_module", "refused", "look", 4))

    def test_a_move_whose_connection_is_lost_is_unknown_and_never_sent_again(self):
        self.daemon.answers["axis.move_to"] = [HANG_UP, MOVED]
        d = self.connect()
        wrong = self.failure(d.x.move, 1)
        self.assertIsInstance(wrong, tmcl.ConnectionLost)
        self.assertEqual(wrong.outcome, "unknown")
        self.assertEqual(self.daemon.count("axis.move_to"), 1)
        self.assertEqual(d.x.move(1).target, 12.5)  # a new one goes out on a new connection

    def test_what_reads_or_stops_is_asked_again(self):
        self.daemon.answers["axis.get_state"] = [HANG_UP, HANG_UP, STATE]
        self.daemon.answers["axis.stop"] = [HANG_UP, {}]
        d = self.connect()
        self.assertEqual(d.x.position, 1.5)
        d.x.stop()
        self.assertEqual(self.daemon.count("axis.get_state"), 3)
        self.assertEqual(self.daemon.count("axis.stop"), 2)

    def test_a_daemon_that_hangs_up_on_every_reading_is_not_asked_for_ever(self):
        self.daemon.answers["axis.get_state"] = HANG_UP
        wrong = self.failure(lambda: self.connect().x.position)
        self.assertEqual(wrong.name, "connection_lost")
        self.assertEqual(self.daemon.count("axis.get_state"), tmcl.connection.MOST_REPEATS)

    def test_garbage_and_long_lines_end_a_call_and_not_the_program(self):
        for garbage in (b"good morning\n", b"x" * (1 << 20) + b"xx", b'{"id":4711,"result":{}}\n'):
            self.daemon.answers["axis.move_to"] = [garbage, MOVED]
            d = self.connect()
            wrong = self.failure(d.x.move, 1)
            self.assertEqual(wrong.outcome, "unknown")
            self.assertEqual(d.x.move(1).target, 12.5)

    def test_an_answer_that_lacks_something_is_garbage(self):
        self.daemon.answers["subscribe"] = {"states": []}
        self.assertEqual(self.failure(next, self.connect().watch("x")).name, "connection_lost")
        self.assertEqual(self.daemon.count("subscribe"), tmcl.connection.MOST_REPEATS)

    def test_a_restarted_daemon_is_found_again(self):
        d = self.connect()
        self.daemon.stop()
        timer = threading.Timer(0.2, self.daemon.start)
        timer.start()
        self.assertEqual(d.x.position, 1.5)
        timer.join()

    def test_what_moves_is_not_kept_for_a_daemon_that_comes_back_late(self):
        d = self.connect(patience=0.1)
        self.daemon.stop()
        self.failure(lambda: d.x.position)  # which notices
        wrong = self.failure(d.x.move, 1)
        self.assertIsInstance(wrong, tmcl.NotConnected)
        self.assertEqual(wrong.outcome, "not_sent")
        self.daemon.start()
        self.assertEqual(d.x.position, 1.5)
        self.assertEqual(self.daemon.count("axis.move_to"), 0)

    def test_a_daemon_that_says_nothing_any_more_counts_as_lost(self):
        self.daemon.answers["axis.move_to"] = SILENCE
        self.daemon.answers["bus.list"] = SILENCE
        with mock.patch.object(tmcl.connection.Connection.__init__, "__defaults__", (0.1,)):
            d = self.connect()
        wrong = self.failure(d.x.move, 1)
        self.assertIn("has said nothing", str(wrong))
        self.assertEqual(wrong.outcome, "unknown")

    def test_a_long_wait_goes_on_while_the_daemon_answers_other_things(self):
        done = threading.Event()

        def late(peer, request):
            def answer():
                done.wait(5)
                peer.say({"id": request["id"], "result": {"position_microsteps": 5}})
            threading.Thread(target=answer, daemon=True).start()
            return SILENCE

        def probed(_, __):
            if self.daemon.count("bus.list") > 3:
                done.set()
            return {"buses": []}

        self.daemon.answers["axis.wait"] = late
        self.daemon.answers["bus.list"] = probed
        with mock.patch.object(tmcl.connection.Connection.__init__, "__defaults__", (0.2,)):
            d = self.connect()
        self.assertEqual(d.x.wait().position_microsteps, 5)
        self.assertGreater(self.daemon.count("bus.list"), 3)

    def test_what_cannot_be_reached_says_why_and_what_to_try(self):
        with mock.patch.object(tmcl.aio, "PATIENCE_TO_CONNECT_S", 0):
            wrong = self.failure(tmcl.connect, "/nowhere/tmcld.sock")
        self.assertIsInstance(wrong, tmcl.NotConnected)
        self.assertIn("/nowhere/tmcld.sock: No such file or directory", str(wrong))
        self.assertIn("Is tmcld running?", wrong.hint)

    def test_after_close_nothing_is_sent(self):
        d = self.connect()
        d.close()
        self.assertEqual(self.failure(d.x.move, 1).outcome, "not_sent")
        d.close()

    # ---- leases ----

    def leased(self, d, **how):
        self.daemon.answers["lease.acquire"] = GRANTED
        self.daemon.answers.setdefault("lease.renew", GRANTED)
        return d.lease("x", **how)

    def test_calls_that_act_name_their_lease_and_it_is_released(self):
        d = self.connect()
        with self.leased(d):
            d.x.move(1)
            self.assertEqual(d.x.position, 1.5)
            d.x.stop()
        d.x.move(2)
        moves = [c["params"] for c in self.daemon.calls if c["method"] == "axis.move_to"]
        self.assertEqual(moves[0], {"axis": "x", "position": 1, "lease": 7, "epoch": 9})
        self.assertEqual(moves[1], {"axis": "x", "position": 2})
        self.assertEqual(self.daemon.count("lease.release"), 1)

    def test_the_lease_of_tmclctl_lease_run_is_named(self):
        with mock.patch.dict(os.environ, TMCL_LEASE="3", TMCL_EPOCH="4"):
            d = self.connect()
        d.x.move(1)
        self.assertEqual(self.daemon.calls[-1]["params"]["lease"], 3)

    def test_a_lease_is_renewed_while_the_program_does_something_else(self):
        renewed = threading.Event()
        self.daemon.answers["lease.renew"] = lambda *_: renewed.set() or GRANTED
        with self.leased(self.connect(), ttl=0.3):
            self.assertTrue(renewed.wait(10))

    def test_by_hand_it_is_renewed_when_the_program_says_so(self):
        with self.leased(self.connect(), by_hand=True) as lease:
            lease.renew()
        self.assertEqual(self.daemon.count("lease.renew"), 1)

    def test_a_lost_lease_raises_in_the_next_call_of_the_block(self):
        for loss in (error("lease_lost", "not_sent"), HANG_UP, SILENCE):
            with self.subTest(loss=loss):
                lost = threading.Event()
                self.daemon.answers["lease.renew"] = lambda *_: lost.set() or loss
                moves = self.daemon.count("axis.move_to")
                d = self.connect()
                with self.assertRaises(tmcl.LeaseLost):
                    with self.leased(d, ttl=0.3):
                        self.assertTrue(lost.wait(10))
                        while True:  # until the loss has been told
                            d.x.state()
                with self.assertRaises(tmcl.LeaseLost):
                    with self.leased(d, ttl=0.3):
                        lost.clear()
                        self.assertTrue(lost.wait(10))
                        for _ in range(1000):
                            d.x.stop()  # a stop is let through
                        while True:
                            d.x.state()
                self.assertEqual(self.daemon.count("axis.move_to"), moves)

    def test_a_lease_that_was_lost_unnoticed_raises_at_the_end_of_its_block(self):
        self.daemon.answers["lease.release"] = error("lease_lost", "not_sent")
        with self.assertRaises(tmcl.LeaseLost):
            with self.leased(self.connect()):
                pass

    def test_what_the_block_raises_is_not_hidden_by_the_loss(self):
        self.daemon.answers["lease.release"] = HANG_UP
        with self.assertRaises(ZeroDivisionError):
            with self.leased(self.connect()):
                1 / 0  # noqa: B018

    def test_a_lease_is_kept_while_the_daemon_has_too_much_to_do_for_the_program(self):
        answers = [error("too_many_requests", "not_sent")] * 3 + [GRANTED]
        self.daemon.answers["lease.renew"] = answers
        with self.leased(self.connect(), by_hand=True, ttl=60) as lease:
            with mock.patch("tmcl.aio.RENEWALS_IN_TTL", 60_000):
                lease.renew()
        self.assertEqual(self.daemon.count("lease.renew"), 4)

    def test_a_lease_that_is_never_renewed_for_that_is_lost_at_its_end(self):
        self.daemon.answers["lease.renew"] = error("too_many_requests", "not_sent")
        with self.assertRaises(tmcl.LeaseLost):
            with self.leased(self.connect(), by_hand=True, ttl=0.2) as lease:
                lease.renew()
        self.assertGreater(self.daemon.count("lease.renew"), 1)

    # ---- times ----

    def test_a_timeout_is_never_rounded_to_none(self):
        self.daemon.answers["axis.wait"] = self.daemon.answers["axis.home"] = {}
        d = self.connect()
        for seconds, sent in ((0, 1), (0.0004, 1), (-3, 1), (0.001, 1), (0.0011, 2), (2, 2000)):
            for call in (d.x.wait, lambda timeout: d.x.home(timeout=timeout)):
                try:
                    call(timeout=seconds)
                except tmcl.Error:
                    pass  # the answer is none
                self.assertEqual(self.daemon.calls[-1]["params"]["timeout_ms"], sent, seconds)

    def test_what_is_no_time_is_an_error_of_the_package(self):
        d = self.connect()
        for wrong in (float("nan"), float("inf"), -float("inf")):
            for call in (lambda: d.x.wait(timeout=wrong), lambda: d.x.home(timeout=wrong),
                         lambda: d.x.state(max_age=wrong), lambda: d.lease("x", ttl=wrong),
                         lambda: next(d.watch("x", interval=wrong)),
                         lambda: d.record("x", interval=wrong)):
                self.assertEqual(self.failure(call).name, "bad_argument", wrong)
        self.assertEqual(self.failure(tmcl.connect, patience=float("nan")).name, "bad_argument")

    # ---- other processes ----

    def in_child(self, work):
        """What it gives, of a process that is forked off meanwhile and ends then."""
        out, into = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.write(into, repr(work()).encode())
            finally:
                os._exit(0)
        os.close(into)
        with os.fdopen(out, "rb") as said:
            result = said.read().decode()
        os.waitpid(child, 0)
        return result

    def test_a_forked_child_is_told_that_the_gateway_is_not_its_own(self):
        d = self.connect()
        calls = (d.x.wait, d.stop_all, lambda: next(d.watch("x")),
                 lambda: d.lease("x").__enter__())
        names = self.in_child(lambda: [self.failure(call).name for call in calls])
        self.assertEqual(names, repr(["forked"] * len(calls)))
        self.assertEqual(self.in_child(d.close), "None")
        self.assertEqual(d.x.position, 1.5)

    def test_a_connection_ends_with_its_process_although_a_forked_child_lives(self):
        asked, ended = threading.Event(), threading.Event()
        hang_up, hold = os.pipe()

        def wait(peer, _):
            asked.set()
            list(peer.listen())
            ended.set()
            return SILENCE

        self.daemon.answers["axis.wait"] = wait
        owner = os.fork()
        if owner == 0:
            d = tmcl.connect(self.daemon.path)
            if os.fork() == 0:
                os.close(hold)
                os.read(hang_up, 1)  # it lives on
                os._exit(0)
            d.x.wait()
        self.assertTrue(asked.wait(10))
        os.kill(owner, signal.SIGKILL)
        os.waitpid(owner, 0)
        self.assertTrue(ended.wait(10))
        os.close(hold)
        os.close(hang_up)

    # ---- watching ----

    def test_watches_through_a_restart_of_the_daemon(self):
        def subscribed(peer, request):
            peer.say({"id": request["id"], "result": {"subscription": 3, "states": [STATE],
                                                      "failed": []}})
            peer.say({"method": "notify_state", "params": {
                **STATE, "seq": 2, "position": 2.5, "subscription": 3, "dropped": 4}})
            peer.say({"method": "notify_state", "params": {**STATE, "subscription": 99}})
            return HANG_UP

        self.daemon.answers["subscribe"] = subscribed
        states = self.connect().watch("x", interval=0.02)
        self.assertEqual([next(states).position for _ in range(4)], [1.5, 2.5, 1.5, 2.5])
        subscribe = [call for call in self.daemon.calls if call["method"] == "subscribe"]
        self.assertEqual(subscribe[1]["params"], {"axes": ["x"], "interval_ms": 20})
        states.close()

    def test_a_watch_that_nobody_reads_keeps_so_many_states(self):
        with mock.patch.object(tmcl.connection, "MOST_STATES", 10):
            async def fill():
                states = tmcl.connection.States()
                states.waiting = type(states.waiting)(maxlen=10)
                for _ in range(25):
                    states.add(STATE)
                return len(states.waiting), states.dropped
            self.assertEqual(asyncio.run(fill()), (10, 15))

    def test_a_watch_of_an_axis_that_is_not_there_says_so(self):
        self.daemon.answers["subscribe"] = error("unknown_axis", "not_sent")
        self.assertEqual(self.failure(next, self.connect().watch("q")).name, "unknown_axis")

    def test_records_states_with_their_times(self):
        self.daemon.answers["subscribe"] = {"subscription": 3, "failed": [], "states": [STATE]}
        with self.connect().record("x") as recording:
            while not recording:
                pass
        file = f"{self.daemon.folder.name}/x.csv"
        recording.write_csv(file)
        head, row = pathlib.Path(file).read_text().splitlines()
        self.assertTrue(head.startswith("time_s,utc,axis,unit,position,"))
        self.assertRegex(row, r"^0\.0,20\d\d-.*Z,x,mm,1\.5,0\.0,1\.5,0,")
        self.assertEqual(self.daemon.count("unsubscribe"), 1)

    def test_without_matplotlib_a_plot_names_the_package(self):
        with mock.patch.dict("sys.modules", {"matplotlib.figure": None}):
            wrong = self.failure(tmcl.Recording().plot)
        self.assertEqual(wrong.name, "no_matplotlib")
        self.assertIn("python3-matplotlib", wrong.hint)


class AioTest(unittest.IsolatedAsyncioTestCase):
    async def test_the_same_by_asyncio(self):
        with FakeDaemon() as daemon:
            daemon.answers |= {"axis.move_to": MOVED, "axis.get_state": STATE,
                               "lease.acquire": GRANTED,
                               "subscribe": {"subscription": 3, "failed": [], "states": [STATE]}}
            async with await tmcl.aio.connect(daemon.path) as d:
                async with d.lease("x"):
                    self.assertEqual((await d.x.move(12.5)).target, 12.5)
                positions = await asyncio.gather(*(d.x.position() for _ in range(50)))
                self.assertEqual(set(positions), {1.5})
                async for state in d.watch():
                    self.assertEqual(state.axis, "x")
                    break

    async def test_a_call_that_is_given_up_leaves_the_others_alone(self):
        with FakeDaemon() as daemon:
            daemon.answers |= {"axis.wait": SILENCE, "axis.get_state": STATE}
            async with await tmcl.aio.connect(daemon.path) as d:
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(d.x.wait(), 0.05)
                self.assertEqual(await d.x.position(), 1.5)


    async def given_up(self, method, answer, begin, returned):
        """What is said when `begin` is given up before the daemon answers."""
        asked, go_on = threading.Event(), threading.Event()

        def late(*_):
            asked.set()
            go_on.wait(10)
            return answer

        with FakeDaemon() as daemon:
            daemon.answers |= {method: late, returned: {}, "axis.get_state": STATE}
            async with await tmcl.aio.connect(daemon.path) as d:
                task = asyncio.ensure_future(begin(d))
                await asyncio.to_thread(asked.wait, 10)
                task.cancel()
                with self.assertRaises(asyncio.CancelledError):
                    await task
                go_on.set()
                while not daemon.count(returned):
                    await asyncio.sleep(0.01)
                await d.x.position()
            return [c["params"] for c in daemon.calls if c["method"] == returned]

    async def test_a_lease_that_is_granted_to_no_one_any_more_is_given_back(self):
        key = {"lease": 7, "epoch": 9, "stop": False}
        for begin in (lambda d: d.lease("x").__aenter__(), lambda d: d.rpc.lease_acquire(["x"])):
            self.assertEqual(
                await self.given_up("lease.acquire", GRANTED, begin, "lease.release"), [key])

    async def test_a_watch_that_is_given_up_while_it_begins_ends(self):
        answer = {"subscription": 3, "failed": [], "states": [STATE]}
        self.assertEqual(
            await self.given_up("subscribe", answer, lambda d: anext(d.watch("x")), "unsubscribe"),
            [{"subscription": 3}])

    async def test_a_forked_child_is_told_that_the_gateway_is_not_its_own(self):
        with FakeDaemon() as daemon:
            async with await tmcl.aio.connect(daemon.path) as d:
                out, into = os.pipe()
                if os.fork() == 0:
                    try:
                        d.x.stop().send(None)
                    except tmcl.Error as wrong:
                        os.write(into, wrong.name.encode())
                    finally:
                        os._exit(0)
                self.assertEqual(os.read(out, 100), b"forked")
                os.close(out)
                os.close(into)


class WebTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.context = tls_context(cls.folder.name)
        cls.ca = f"{cls.folder.name}/cert.pem"
        cls.token = f"{cls.folder.name}/token"
        with open(cls.token, "w") as file:
            file.write("secret\n")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_same_over_https(self):
        with FakeWebDaemon(self.context) as daemon:
            daemon.answers["axis.move_to"] = MOVED
            daemon.answers["axis.get_state"] = [HANG_UP, STATE]
            with tmcl.connect(daemon.url, token_file=self.token, ca=self.ca) as d:
                self.assertEqual(d.x.move(12.5).target, 12.5)
                self.assertEqual(d.x.position, 1.5)  # on a second connection
            self.assertEqual(len(daemon.peers), 2)
            self.assertEqual(daemon.peers[0].request, "GET /ws HTTP/1.1")

    def test_the_same_over_http_on_this_machine(self):
        with FakeWebDaemon() as daemon:
            with tmcl.connect(daemon.url, token_file=self.token) as d:
                self.assertEqual([axis.name for axis in d.axes()], ["x"])

    def refusal(self, *where, **how):
        with self.assertRaises(tmcl.NotConnected) as raised:
            tmcl.connect(*where, **how)
        self.assertEqual(raised.exception.outcome, "not_sent")
        return raised.exception

    def test_refuses_a_certificate_that_nobody_vouches_for(self):
        with FakeWebDaemon(self.context) as daemon:
            wrong = self.refusal(daemon.url, token_file=self.token)
            self.assertEqual(wrong.name, "bad_certificate")
            self.assertIn("ca=", wrong.hint)
            other = daemon.url.replace("localhost", "127.0.0.1")
            wrong = self.refusal(other, token_file=self.token, ca=self.ca)
            self.assertEqual(wrong.name, "bad_certificate")

    def test_says_that_a_token_is_wrong(self):
        with FakeWebDaemon(self.context) as daemon:
            wrong = self.refusal(daemon.url, token="other", ca=self.ca)
            self.assertEqual(wrong.name, "http_401")
            self.assertEqual(len(daemon.peers), 1)  # asked once

    def test_says_that_a_door_is_no_gateway(self):
        with mock.patch.object(tmcl.aio, "PATIENCE_TO_CONNECT_S", 0):
            with FakeWebDaemon() as plain:
                self.refusal(plain.url.replace("http:", "https:"), token="secret", ca=self.ca)
            with FakeWebDaemon(self.context) as secure:
                self.refusal(secure.url.replace("https:", "http:"), token="secret")

    def test_names_what_is_wrong_with_what_it_was_given(self):
        for where, how, name in (
            ("ftp://gateway", {}, "bad_url"),
            ("https://", {}, "bad_url"),
            ("https://gateway:99999", {}, "bad_url"),
            ("http://gateway.example", {"token": "secret"}, "bad_url"),
            ("https://gateway", {"ca": "/nowhere"}, "bad_ca"),
            ("https://gateway", {"ca": self.token}, "bad_ca"),
            ("https://gateway", {"token_file": "/nowhere"}, "no_token"),
            ("https://gateway", {"token_file": self.ca}, "no_token"),
        ):
            with self.subTest(where=where, how=how):
                self.assertEqual(self.refusal(where, **how).name, name)


if __name__ == "__main__":
    unittest.main()
