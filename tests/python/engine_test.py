"""The engine of the package, without a socket."""

import json
import unittest

from tmcl.aio import Axis, Gateway
from tmcl.calls import with_calls
from tmcl.engine import MOST_CALLS, Answer, Engine, Failure, Hello, Notification
from tmcl.errors import ConnectionLost, Error, LeaseLost, ProtocolError
from tmcl.lines import MOST_BYTES, MOST_BYTES_TO_DAEMON, Lines
from tmcl.methods import EFFECTS, AsyncMethods, State

HELLO = {
    "jsonrpc": "2.0",
    "method": "hello",
    "params": {"protocol": {"major": 1, "minor": 1}, "daemon": "0.1.0"},
}


def line(said):
    return json.dumps(said).encode() + b"\n"


class EngineTest(unittest.TestCase):
    def setUp(self):
        self.engine = Engine(Lines())

    def greet(self):
        return list(self.engine.receive(line(HELLO)))

    def call(self, method="axis.list", **params):
        return self.engine.call(method, params)

    def test_takes_the_greeting(self):
        self.assertEqual(self.greet(), [Hello("0.1.0", None)])

    def test_refuses_another_major_version(self):
        other = {**HELLO, "params": {"protocol": {"major": 2, "minor": 0}, "daemon": "9"}}
        with self.assertRaisesRegex(ProtocolError, "speaks version 2"):
            list(self.engine.receive(line(other)))

    def test_tells_the_error_of_a_daemon_that_greets_with_one(self):
        error = {"code": -32001, "message": "full", "data": {"name": "too_many_clients"}}
        with self.assertRaises(Error) as raised:
            list(self.engine.receive(line({"jsonrpc": "2.0", "id": None, "error": error})))
        self.assertEqual(raised.exception.name, "too_many_clients")

    def test_says_a_call_in_one_line(self):
        number, text = self.call("axis.stop", axis="x\ny")
        said = json.loads(text)
        self.assertEqual(text.count(b"\n"), 1)
        self.assertEqual(said["id"], number)
        self.assertEqual(said["params"], {"axis": "x\ny"})

    def test_gives_each_answer_to_its_call_in_any_order_and_in_any_pieces(self):
        self.greet()
        first, _ = self.call()
        second, _ = self.call()
        text = line({"jsonrpc": "2.0", "id": second, "result": {"b": 2}})
        text += line({"jsonrpc": "2.0", "method": "notify_state", "params": {"axis": "x"}})
        text += line({"jsonrpc": "2.0", "id": first, "result": {"a": 1}})
        messages = []
        for byte in text:
            messages += self.engine.receive(bytes([byte]))
        self.assertEqual(
            messages,
            [Answer(second, {"b": 2}), Notification("notify_state", {"axis": "x"}),
             Answer(first, {"a": 1})],
        )
        self.assertFalse(self.engine.is_waiting)

    def test_an_error_has_name_outcome_hint_and_data(self):
        self.greet()
        number, _ = self.call()
        data = {"name": "refused_by_module", "outcome": "refused", "hint": "h", "status": 4}
        error = {"code": -32000, "message": "no", "data": data}
        (failure,) = self.engine.receive(line({"jsonrpc": "2.0", "id": number, "error": error}))
        self.assertIsInstance(failure, Failure)
        told = failure.error
        self.assertEqual((told.name, told.outcome, told.hint, told.code),
                         ("refused_by_module", "refused", "h", -32000))
        self.assertEqual(told.data["status"], 4)
        self.assertIn("no [refused_by_module, outcome: refused]\n  h", str(told))

    def test_an_error_names_the_calls_of_this_package_and_no_methods(self):
        self.greet()
        texts = {
            "see parameter.list for what there is": "see gateway.rpc.parameter_list() for what there is",
            "see axis.list.": "see gateway.axes().",
            "axis.stop stops it": "axis.stop() stops it",
            "'x' turns; lease.acquire, or bus.list": "'x' turns; gateway.lease(), or gateway.rpc.bus_list()",
            "/tmp/path.run.csv, axis.list2, my_axis.list": "/tmp/path.run.csv, axis.list2, my_axis.list",
        }
        for told, shown in texts.items():
            number, _ = self.call()
            error = {"code": -32602, "message": told, "data": {"name": "n", "hint": told}}
            (failure,) = self.engine.receive(line({"id": number, "error": error}))
            self.assertEqual((failure.error.message, failure.error.hint), (shown, shown))
            self.assertEqual(failure.error.data["hint"], told)

    def test_a_position_is_a_float_also_where_it_is_whole(self):
        for position in (5, 5.5):
            state = State.of({"axis": "x", "position": position, "position_microsteps": 5})
            self.assertEqual(state.position, position)
            self.assertIs(type(state.position), float)
            self.assertIs(type(state.position_microsteps), int)
        self.assertIsNone(State.of({"axis": "x", "position": None}).position)

    def test_every_method_has_a_call_of_this_package(self):
        for method in EFFECTS:
            with self.subTest(method):
                call = with_calls(method)
                if "." not in method:
                    self.assertEqual(call, method)
                    continue
                holder, _, name = call.removesuffix("()").rpartition(".")
                where = {"gateway": Gateway, "gateway.rpc": AsyncMethods, "axis": Axis}[holder]
                self.assertTrue(hasattr(where, name), call)

    def test_an_error_without_data_has_an_unknown_outcome(self):
        self.greet()
        number, _ = self.call()
        (failure,) = self.engine.receive(line({"id": number, "error": {"message": "no"}}))
        self.assertEqual(failure.error.outcome, "unknown")

    def test_a_lost_lease_is_an_exception_of_its_own(self):
        self.greet()
        number, _ = self.call()
        data = {"name": "stale_epoch", "outcome": "not_sent"}
        error = {"code": -32003, "message": "no", "data": data}
        (failure,) = self.engine.receive(line({"id": number, "error": error}))
        self.assertIsInstance(failure.error, LeaseLost)

    def test_garbage_ends_the_connection_after_what_came_before_it(self):
        for garbage in (b"good morning\n", b"[1]\n", b"7\n", b"{}\n", b'{"id":99,"result":{}}\n',
                        b'{"id":"a","result":{}}\n', b'{"id":1}\n', b"\xff\xfe\n",
                        b"[" * 100_000 + b"\n", b'{"id":true,"result":{}}\n'):
            with self.subTest(garbage=garbage[:30]):
                engine = Engine(Lines())
                messages = []
                with self.assertRaises(ProtocolError):
                    for message in engine.receive(line(HELLO) + garbage):
                        messages.append(message)
                self.assertEqual(len(messages), 1)

    def test_a_second_answer_is_garbage(self):
        self.greet()
        number, _ = self.call()
        answer = line({"jsonrpc": "2.0", "id": number, "result": {}})
        list(self.engine.receive(answer))
        with self.assertRaisesRegex(ProtocolError, "second answer"):
            list(self.engine.receive(answer))

    def test_a_line_has_a_longest_length(self):
        self.greet()
        list(self.engine.receive(b"x" * MOST_BYTES))
        with self.assertRaisesRegex(ProtocolError, "longer than"):
            list(self.engine.receive(b"x"))

    def test_what_cannot_be_sent_is_not_sent(self):
        for params, name in (
            ({"text": "x" * MOST_BYTES_TO_DAEMON}, "line_too_long"),
            ({"position": float("nan")}, "bad_argument"),
            ({"position": object()}, "bad_argument"),
        ):
            with self.assertRaises(Error) as raised:
                self.engine.call("path.plan", params)
            self.assertEqual((raised.exception.name, raised.exception.outcome), (name, "not_sent"))
        self.assertFalse(self.engine.is_waiting)

    def test_only_so_many_calls_wait(self):
        for _ in range(MOST_CALLS):
            self.call()
        with self.assertRaises(Error) as raised:
            self.call()
        self.assertEqual(raised.exception.outcome, "not_sent")

    def test_tells_each_call_that_has_no_answer_what_became_of_it(self):
        self.greet()
        first, _ = self.call("axis.move_to")
        second, _ = self.call("axis.list")
        list(self.engine.receive(line({"id": second, "result": {}})))
        lost = self.engine.lose("the cable was cut")
        self.assertEqual(list(lost), [first])
        self.assertIsInstance(lost[first], ConnectionLost)
        self.assertEqual(lost[first].outcome, "unknown")
        self.assertIn("axis.move_to: the cable was cut", str(lost[first]))
        self.assertEqual(self.engine.lose("again"), {})


if __name__ == "__main__":
    unittest.main()
