"""tmcl_secop in Frappy's own server, whose sources $FRAPPY names, beside a second client of the same tmcld."""

import json
import os
import pathlib
import signal
import socket
import sys
import unittest
from importlib.util import find_spec

from bridge_bench import FAR, LONGEST_S, ROOT, BridgeTest, Faults, free_port, freeze, until

FRAPPY = pathlib.Path(os.environ["FRAPPY"])
IDLE, WARN, BUSY, ERROR = 100, 200, 300, 400


class SecopTest(BridgeTest):
    def setUp(self):
        super().setUp()
        self.configuration = self.bench.folder / "bench_cfg.py"
        self.port = free_port()
        self.configuration.write_text(f"""
Node('bench.tmcl', 'axes of a tmcld', 'tcp://{self.port}')
Mod('x', 'tmcl_secop.Axis', 'a stage', axis='x', gateway='{self.bench.socket}',
    value=Param(unit='mm'), target=50)
""")
        self.start_server()

    def start_server(self):
        path = [ROOT / "tools/bridges/secop", ROOT / "tools/python", FRAPPY]
        if find_spec("mlzlog") is None:
            path.append(ROOT / "tests/bridges/without_mlzlog")
        os.environ["PYTHONPATH"] = ":".join(map(str, path))
        os.environ["FRAPPY_PIDDIR"] = os.environ["FRAPPY_LOGDIR"] = str(self.bench.folder)
        os.environ["FRAPPY_CONFDIR"] = str(self.bench.folder)
        self.server = self.start(
            sys.executable, FRAPPY / "bin/frappy-server", "bench", "-c", self.configuration
        )
        self.connection = until(self.connect, "the server answers")
        self.wait_for(IDLE, WARN)

    def connect(self):
        made = socket.create_connection(("127.0.0.1", self.port), LONGEST_S)
        self.addCleanup(made.close)
        self.lines = made.makefile("r")
        self.addCleanup(self.lines.close)
        return made

    def call(self, *words):
        """What is answered; events of subscriptions are not asked for here."""
        self.connection.sendall((" ".join(words) + "\n").encode())
        action, _, said = self.lines.readline().rstrip().split(" ", 2)
        if action.startswith("error"):
            raise RuntimeError(said)
        return json.loads(said)[0]

    def status(self):
        return self.call("read", "x:status")[0]

    def wait_for(self, *states):
        until(lambda: self.status() in states, f"a status of {states}")

    def move(self, to):
        until(lambda: self.call("change", "x:target", str(to)) == to, f"it takes {to}")


class Told(SecopTest):
    def test_moves_where_it_is_told_and_no_target_of_its_configuration_does(self):
        self.assert_stays(0)
        self.move(2.5)
        self.wait_for(IDLE)
        self.assertEqual(self.call("read", "x:value"), 2.5)
        with self.assertRaisesRegex(RuntimeError, "soft limit"):
            self.call("change", "x:target", "1301")

    def test_stops_and_is_stopped(self):
        self.move(FAR)
        self.assertEqual(self.status(), BUSY)
        self.call("do", "x:stop")
        self.assert_stays(self.stands())
        self.move(FAR)
        self.second.x.stop()
        self.wait_for(IDLE, WARN)
        self.assert_stays(self.stands())

    def test_a_lost_gateway_is_an_error(self):
        self.bench.stop_daemon(kill=True)
        self.wait_for(ERROR)
        with self.assertRaisesRegex(RuntimeError, "CommunicationFailed"):
            self.call("read", "x:value")
        self.bench.start_daemon()
        self.wait_for(IDLE)
        self.assert_stays(self.stands())

    def test_a_server_that_dies_or_hangs_stops_what_it_has_moved(self):
        self.move(FAR)
        freeze(self.server.pid)
        where = self.stands()
        self.server.send_signal(signal.SIGCONT)
        self.wait_for(IDLE, WARN)
        self.assert_stays(where)
        self.move(FAR)
        self.end(self.server)
        self.assert_stays(self.stands())


class Rounds(SecopTest, Faults):
    start_bridge = SecopTest.start_server
    set_off = SecopTest.move

    @property
    def bridge(self):
        return self.server

    def wait_for_loss(self):
        self.wait_for(ERROR)

    def wait_until_back(self):
        self.wait_for(IDLE, WARN, BUSY)

    def stop(self):
        self.call("do", "x:stop")

    def wait_until_well(self):
        self.wait_for(IDLE, WARN)


if __name__ == "__main__":
    unittest.main()
