"""The example for EPICS, said to a real tmcld: there is no StreamDevice in Debian, so the few of its
formats that the example uses are read here.
"""

import pathlib
import re
import socket
import unittest

from tmcl.testing import Bench

FOLDER = pathlib.Path(__file__).parents[2] / "tools/python/examples/epics"
FORMAT = re.compile(r'%\*/(?P<skip>[^/]*)/|%(?P<drop>\*?)f|%\{(?P<words>[^}]*)\}')
NUMBER = r"\s*[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?"


def protocols():
    text = (FOLDER / "tmcl.proto").read_text()
    text = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    found = re.findall(r"(\w+) \{\s*out '(.*)';\s*in '(.*)';\s*\}", text)
    return {name: (out, wanted) for name, out, wanted in found}


def read(wanted, line):
    """What StreamDevice would store, or an error where it would set an alarm."""
    value, rest, position = None, line, 0
    for found in FORMAT.finditer(wanted):
        assert wanted[position:found.start()] == "", "text between formats"
        position = found.end()
        if found["skip"] is not None:
            pattern = ".*?" + found["skip"]
        elif found["words"] is not None:
            pattern = f"(?P<value>{found['words']})"
        else:
            pattern = NUMBER if found["drop"] else f"(?P<value>{NUMBER})"
        match = re.match(pattern, rest)
        if match is None:
            raise ValueError(f"{line!r} does not match {wanted!r}")
        value = match.groupdict().get("value", value)
        rest = rest[match.end():]
    assert position == len(wanted), "text behind the formats"
    return value


class EpicsTest(unittest.TestCase):
    def setUp(self):
        bench = self.enterContext(Bench("TMCM-3110", unit="mm", units_per_revolution=8.0))
        self.connection = socket.socket(socket.AF_UNIX)
        self.addCleanup(self.connection.close)
        self.connection.settimeout(10)
        self.connection.connect(str(bench.socket))
        self.lines = self.connection.makefile("r")
        self.addCleanup(self.lines.close)
        self.lines.readline()

    def process(self, name, axis="x", value=None):
        out, wanted = protocols()[name]
        said = out.replace(r"\$1", axis)
        if value is not None:
            said = said.replace("%f", f"{value:f}")
        self.connection.sendall(said.encode() + b"\n")
        return read(wanted, self.lines.readline().rstrip("\n"))

    def test_every_record_has_its_protocol_and_the_other_way_round(self):
        used = re.findall(r"@tmcl\.proto (\w+)\(", (FOLDER / "tmcl.db").read_text())
        self.assertEqual(sorted(used), sorted(protocols()))

    def test_moves_and_tells_where_it_is(self):
        self.process("move", value=-3)
        while self.process("moving") == "true":
            pass
        self.assertEqual(float(self.process("position")), -3)

    def test_stops(self):
        self.process("move", value=1000)
        self.process("stop")
        while self.process("moving") == "true":
            pass
        self.assertLess(float(self.process("position")), 1000)

    def test_an_error_matches_nothing(self):
        for name, value in (("position", None), ("moving", None), ("move", 1), ("stop", None)):
            with self.subTest(name), self.assertRaises(ValueError):
                self.process(name, axis="nobody", value=value)


if __name__ == "__main__":
    unittest.main()
