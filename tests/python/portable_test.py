"""The package on a Python from which is taken what Windows does not have, as a client over HTTPS.

What only `mypy --platform win32` sees, such as AF_UNIX, is seen by `types`.
"""

import asyncio
import os
import pathlib
import pkgutil
import signal
import sys
import tempfile
import unittest
from unittest import mock

from fake_daemon import STATE, FakeWebDaemon, tls_context

MODULES = ("crypt", "fcntl", "grp", "nis", "ossaudiodev", "pty", "pwd", "resource", "spwd", "syslog",
           "termios", "tty")
NAMES = {
    asyncio: ("open_unix_connection", "start_unix_server"),
    os: ("chown", "fork", "forkpty", "getegid", "geteuid", "getgid", "getgroups", "getpgid", "getsid",
         "getuid", "killpg", "mkfifo", "openpty", "pipe2", "register_at_fork", "setsid", "uname",
         "wait"),
    pathlib.Path: ("group", "owner"),
    signal: ("SIGALRM", "SIGHUP", "SIGKILL", "SIGUSR1", "alarm", "pthread_kill", "sigwait"),
}


def take_away():
    for module in MODULES:
        sys.modules[module] = None  # its import fails
    for place, names in NAMES.items():
        for name in names:
            delattr(place, name)
    sys.platform = "win32"


class PortableTest(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(FakeWebDaemon(context))
        self.daemon.answers |= {
            "axis.get_state": STATE,
            "lease.acquire": {"lease": 7, "epoch": 9, "axes": ["x"], "ttl_ms": 2000},
            "subscribe": {"subscription": 3, "failed": [], "states": [STATE]},
        }

    def test_every_module_can_be_imported(self):
        names = {module.name for module in pkgutil.iter_modules(tmcl.__path__)}
        self.assertIn("systems", names)
        for name in names - {"pytest_plugin"}:  # which needs pytest
            __import__(f"tmcl.{name}")

    def test_moves_leases_and_records_over_https(self):
        d = self.enterContext(tmcl.connect(
            self.daemon.url, token="secret", ca=pathlib.Path(folder) / "cert.pem"))
        with d.lease("x"), d.record("x") as recording:
            d.x.move(12.5)
            self.assertEqual(d.x.position, 1.5)
            while not recording:
                pass
        recording.write_csv(pathlib.Path(folder) / "x.csv")

    def test_a_socket_in_a_folder_is_refused_with_what_there_is_instead(self):
        with mock.patch("tmcl.aio.PATIENCE_TO_CONNECT_S", 0):
            with self.assertRaises(tmcl.NotConnected) as raised:
                tmcl.connect()
        self.assertIn('tmcl.connect("https://gateway:4143"', raised.exception.hint)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        context = tls_context(folder)
        take_away()
        import tmcl

        unittest.main()
