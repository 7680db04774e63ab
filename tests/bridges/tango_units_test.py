"""tmcl-tango tells units while a client's call goes on, with axes of the test's own."""

import importlib.machinery
import importlib.util
import os
import threading
import time
import unittest
from types import SimpleNamespace

from bridge_bench import LONGEST_S, ROOT, free_port, until

import tango
from tmcl.methods import Units

NAME = "lab/tmcl/x"
#: Until the thread that tells units waits for the client's call: if it is later, the test sees less.
TAKES_S = 0.3


def module_of(path):
    loader = importlib.machinery.SourceFileLoader("tmcl_tango", str(path))
    made = importlib.util.module_from_spec(importlib.util.spec_from_loader("tmcl_tango", loader))
    loader.exec_module(made)
    return made


class SlowAxis:
    """Says what its state is when `may_go_on` is set."""

    name = "x"
    trouble = "not connected"
    units = Units(unit="mm", soft_limit_minimum=-5.0)

    def __init__(self):
        self.is_asked, self.may_go_on = threading.Event(), threading.Event()

    @property
    def state(self):
        self.is_asked.set()
        self.may_go_on.wait(LONGEST_S)


class TangoUnits(unittest.TestCase):
    def setUp(self):
        self.axis = SlowAxis()
        self.server = module_of(ROOT / "tools/bridges/tango/tmcl-tango")
        self.server.bridge = SimpleNamespace(axes={"x": self.axis})
        self.server.device_names[NAME] = "x"
        port = free_port()
        self.server.own_name = f"tango://127.0.0.1:{port}/{{}}#dbase=no"
        threading.Thread(target=self.serve, args=(port,), daemon=True).start()
        until(lambda: self.client().ping() or True, "the server answers")

    def serve(self, port):
        end_point = f"giop:tcp:127.0.0.1:{port}"
        words = ["tmcl-tango", "test", "-nodb", "-dlist", NAME, "-ORBendPoint", end_point]
        with tango.EnsureOmniThread():
            tango.server.run([self.server.TmclAxis], args=words)

    def client(self):
        made = tango.DeviceProxy(self.server.own_name.format(NAME))
        made.set_timeout_millis(int(LONGEST_S * 1000))
        return made

    def test_units_wait_for_a_call_without_stopping_the_server(self):
        client = self.client()
        threading.Thread(target=client.status, daemon=True).start()
        self.assertTrue(self.axis.is_asked.wait(LONGEST_S))
        threading.Timer(TAKES_S, self.axis.may_go_on.set).start()
        with tango.EnsureOmniThread():
            self.server.devices[0].tell()
        config = client.get_attribute_config("Position")
        self.assertEqual((config.unit, config.min_value), ("mm", "-5.0"))


if __name__ == "__main__":
    # A server of Tango cannot be ended from within.
    os._exit(not unittest.main(exit=False).result.wasSuccessful())
